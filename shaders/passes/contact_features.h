// Features of the sensor, its patches and regions, contact_features.comp.

VALUE(kMostSums, 27)  // sums of any scan

CONSTANT(11, uint, TEAM)        // invocations that share a part
CONSTANT(12, uint, REGIONS)     // rows of regions
CONSTANT(13, uint, PATCHES)     // rows of patches
CONSTANT(14, uint, LAST_PLANE)  // that of S
CONSTANT(15, uint, PARTIALS)    // kMostSums x LANES for every team of more than one invocation
CONSTANT(16, float, NOISE)      // counts
CONSTANT(17, float, SLOPE)      // counts/N
CONSTANT(18, float, STIFFNESS)  // d pressure / d depth = STIFFNESS pressure^(1 - 1 / EXPONENT), N, m
CONSTANT(19, float, EXPONENT)

TEXELS(0, Instances)
UNIFORM(1, Step)
TEXELS(2, Taxels)
TEXELS(3, Planes)
TEXELS(4, Forces)
TEXELS(5, TaxelRegions)
BUFFER(6, readonly, Regions)
BUFFER(7, writeonly, ContactFeatures)
BUFFER(8, writeonly, Problems)
BUFFER(9, readonly, FeatureSource)
TEXELS(10, Triggers)
