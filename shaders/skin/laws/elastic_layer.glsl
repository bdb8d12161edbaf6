// The skin as an elastic solid: include/taxelsim/sensor.h, ElasticLayer. Its pressures depend on all heights at once: the contact pass
// outputs heights, and elastic_layer.comp solves for the pressures.

const bool kGlobalSolve = true;

float lawPressure(float d, float d_rate) { return 0.0; }
float lawSlope(float d) { return 0.0; }
