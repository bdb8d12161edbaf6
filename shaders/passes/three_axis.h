// Electronics of three-axis taxels, three_axis.comp. Axes: x, y, normal.

CONSTANT(11, bool, RANDOM)    // some instance draws noise or gains
CONSTANT(12, float, GAIN_XX)  // output of x by the force along x, y, the normal, counts/N
CONSTANT(13, float, GAIN_XY)
CONSTANT(14, float, GAIN_XZ)
CONSTANT(15, float, GAIN_YX)
CONSTANT(16, float, GAIN_YY)
CONSTANT(17, float, GAIN_YZ)
CONSTANT(18, float, GAIN_ZX)
CONSTANT(19, float, GAIN_ZY)
CONSTANT(20, float, GAIN_ZZ)
CONSTANT(21, float, NOISE_X)  // counts
CONSTANT(22, float, NOISE_Y)
CONSTANT(23, float, NOISE_Z)
CONSTANT(24, float, STRENGTH_X)  // strength of the hysteresis
CONSTANT(25, float, STRENGTH_Y)
CONSTANT(26, float, STRENGTH_Z)
CONSTANT(27, float, WIDTH_X)  // width of the hysteresis, N
CONSTANT(28, float, WIDTH_Y)
CONSTANT(29, float, WIDTH_Z)
CONSTANT(30, float, SATURATION)  // counts

TEXELS(0, Instances)
UNIFORM(1, Step)
BUFFER(2, readonly, Taxels)
BUFFER(3, readonly, SpreadNormal)
BUFFER(4, readonly, SpreadShear)
BUFFER(5, readwrite, AxisPlays)
BUFFER(6, writeonly, TaxelCounts)
