// The skin as an elastic solid: include/taxelsim/sensor.h, ElasticLayer. Its pressures depend on all heights at once: the contact pass outputs heights, and
// elastic_layer.comp solves for the pressures.

const bool kGlobalSolve = true, kClearsHeights = true;  // reads the rectangle around the windows of all tiles

float lawPressure(float d, float d_rate) { return 0.0; }
float lawSlope(float d) { return 0.0; }
