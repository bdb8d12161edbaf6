// Tactile Jacobian of the taxels' forces after the point spread function, spread_jacobian.comp.

CONSTANT(11, uint, NUM_ENTRIES)  // entries of a taxel's list of sources, where the sensor is not one grid patch

UNIFORM(0, Step)
TEXELS(1, Instances)
BUFFER(2, readonly, SpreadRows)
TEXELS(3, TaxelJacobian)
BUFFER(4, writeonly, SpreadJacobian)
