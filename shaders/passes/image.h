// Image pass, image.comp.

// Sums per image: force, first moments (3), second moments (3), area, peak; first the measured image's, then the clean one's, then the
// number of saturated taxels.
VALUE(kSumsPerImage, 9)
VALUE(kNumSums, 19)

CONSTANT(11, bool, SHEAR)          // spreads shear as well
CONSTANT(12, uint, NUM_ENTRIES)    // entries of a taxel's list of sources, where the sensor is not one grid patch
CONSTANT(13, bool, OUTPUT_NORMAL)  // writes spread_normal, outside contact too
CONSTANT(14, bool, TAXELS_ALIKE)   // gain 1 and the sensor's trigger everywhere
CONSTANT(15, int, CURVE_DEGREE)
CONSTANT(16, float, CURVE_SLOPE)  // at 0, counts/N
CONSTANT(17, float, OUTPUT_SCALE)
CONSTANT(18, float, TRIGGER)        // N
CONSTANT(19, float, SATURATION)     // counts
CONSTANT(20, float, NOISE)          // counts
CONSTANT(21, bool, RANDOM)          // some instance draws noise or gains
CONSTANT(22, uint, TEAM)            // invocations that share an instance
CONSTANT(23, uint, PARTIALS)        // kNumSums x LANES for every team of more than one invocation
CONSTANT(24, uint, NUM_HYSTERESIS)  // elements
CONSTANT(25, uint, NUM_CREEP)       // terms
CONSTANT(26, bool, LOW_PASS)
CONSTANT(27, bool, DELAY)
CONSTANT(28, bool, RANDOM_WALK)
CONSTANT(29, float, BIAS)                    // counts
CONSTANT(30, float, DEAD_TAXEL_PROBABILITY)  // probability
CONSTANT(31, bool, WHOLE_ARRAY)              // taxels that no object reaches may have a force
CONSTANT(32, bool, ROTATES_SHEAR)            // shear rotates along a curved skin, readout/spread.glsl
CONSTANT(33, float, CURVE_LIMIT)             // counts; 0: none
CONSTANT(34, int, CURVE_PIECES)              // 0: a polynomial
CONSTANT(35, bool, KEEPS_WINDOW)             // every step has a frame, so outside of the window of the step before all is 0
CONSTANT(36, bool, RANDOM_SKIN)              // every instance has a trigger, hysteresis, delay and width of the spread of its own
CONSTANT(37, bool, SCALED)                   // contact_normal holds forces divided by the part of the kernel that stays on the sensor
CONSTANT(38, bool, READS_AT_REST)            // a taxel has a trigger below 0
CONSTANT(39, uint, MARGIN)                   // halo in taxels around the contact window

TEXELS(0, Instances)
UNIFORM(1, Step)
UNIFORM(2, SensorBlock)
BUFFER(3, readonly, Taxels)
BUFFER(4, readonly, SpreadRows)
BUFFER(5, readonly, ContactNormal)
BUFFER(6, readonly, ContactShear)
TEXELS(7, TileResults)
BUFFER(8, readonly, Loads)
BUFFER(9, writeonly, Image)
BUFFER(10, writeonly, SpreadNormal)
BUFFER(11, writeonly, SpreadShear)
BUFFER(12, writeonly, Features)
BUFFER(13, writeonly, Problems)
BUFFER(14, writeonly, TaxelStates)
BUFFER(15, readwrite, ImageWindows)
BUFFER(16, readonly, SpreadScale)
TEXELS(17, ForceFours)       // ContactNormal
TEXELS(18, PastTaxelStates)  // TaxelStates
