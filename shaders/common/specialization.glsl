// Everything about the sensor that is one number, known when the pipelines are made: the driver folds it into the code.
// Model::Impl::constants() has the same list.
layout(local_size_x_id = 0) in;
layout(constant_id = 0) const uint WORKGROUP = 8;
layout(constant_id = 1) const uint LANES = 8;            // partial sums of a reduction
layout(constant_id = 2) const uint NUM_TAXELS = 84;
layout(constant_id = 3) const uint NUM_TILES = 1;
layout(constant_id = 4) const uint SAMPLES = 4;          // per taxel and side
layout(constant_id = 5) const uint NUM_ROWS = 6;         // of the sensor's one patch; 0 where there are several, or no kernel spreads
layout(constant_id = 6) const uint NUM_COLS = 14;
layout(constant_id = 7) const uint REPEAT = 1;           // units of work that a workgroup does one after another
layout(constant_id = 8) const uint KERNEL = 3;           // of the spread, taxels per side
layout(constant_id = 9) const float PITCH_X = 0.0034;    // m, of the sensor's one patch
layout(constant_id = 10) const float PITCH_Y = 0.0034;
