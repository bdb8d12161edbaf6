// Connected regions of an image, contact_regions.comp.

CONSTANT(11, uint, TEAM)            // invocations that share an instance
CONSTANT(12, uint, REGIONS)         // rows of regions
CONSTANT(13, uint, NUM_NEIGHBOURS)  // in the list of each taxel; 0: patches are grids
CONSTANT(14, uint, FORCE_STEPS)     // steps of the largest force of an image: the sum over all taxels fits into 31 bits
CONSTANT(15, uint, FIRST_COUNT)     // features per instance before the number of regions
CONSTANT(16, uint, NUM_PATCHES)     // grids
CONSTANT(17, int, CURVE_DEGREE)     // this and the rest as in image.h
CONSTANT(18, float, CURVE_SLOPE)
CONSTANT(19, float, OUTPUT_SCALE)
CONSTANT(20, float, TRIGGER)
CONSTANT(21, float, SATURATION)
CONSTANT(22, float, CURVE_LIMIT)
CONSTANT(23, int, CURVE_PIECES)

TEXELS(0, Instances)
UNIFORM(1, Step)
UNIFORM(2, SensorBlock)
BUFFER(3, readonly, Taxels)
TEXELS(4, Planes)
BUFFER(5, readonly, Neighbours)
TEXELS(6, Image)  // or SpreadNormal, as bits
BUFFER(7, readwrite, Forces)
BUFFER(8, coherent, TaxelRegions)
BUFFER(9, coherent, RegionSums)
BUFFER(10, writeonly, Regions)
BUFFER(11, writeonly, ContactFeatures)
BUFFER(12, writeonly, Problems)
BUFFER(13, readonly, FeatureSource)
