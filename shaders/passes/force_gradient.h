// Gradient of a loss by the sensor's twist and the gains of taxels, force_gradient.comp.

VALUE(kMostSums, 6)  // sums of any scan

CONSTANT(11, uint, TEAM)         // invocations that share an instance
CONSTANT(12, uint, PARTIALS)     // kMostSums x LANES for every team of more than one invocation
CONSTANT(13, uint, NUM_ENTRIES)  // entries of a taxel's list of sources, where the sensor is not one grid patch
CONSTANT(14, bool, SYMMETRIC)    // a taxel gives its sources what it takes from them

UNIFORM(0, Step)
BUFFER(1, readonly, SpreadRows)
BUFFER(2, readonly, SpreadNormal)
TEXELS(3, TaxelJacobian)
BUFFER(4, readonly, Cotangents)
BUFFER(5, readonly, ForceCotangents)
BUFFER(6, writeonly, TwistGradient)
BUFFER(7, writeonly, GainGradient)
BUFFER(8, writeonly, Problems)
