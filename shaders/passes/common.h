// Constants of every pass: the sizes that its work is divided into, and the sensor's numbers that the driver may fold into the code.
CONSTANT(0, uint, WORKGROUP)
CONSTANT(1, uint, LANES)  // partial sums of a reduction
CONSTANT(2, uint, NUM_TAXELS)
CONSTANT(3, uint, NUM_TILES)
CONSTANT(4, uint, SAMPLES)   // along each side of a taxel
CONSTANT(5, uint, NUM_ROWS)  // taxels of the one patch; 0 for several patches, or where the spread is no kernel
CONSTANT(6, uint, NUM_COLS)
CONSTANT(7, uint, REPEAT)    // units of work that a workgroup processes in sequence
CONSTANT(8, uint, KERNEL)    // size of the spread, taxels per side
CONSTANT(9, float, PITCH_X)  // pitch of the first patch, m
CONSTANT(10, float, PITCH_Y)
