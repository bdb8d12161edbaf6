// A two-parameter foundation: include/taxelsim/sensor.h, Pasternak. As for an elastic layer the contact pass outputs heights, and pasternak.comp solves for the
// pressures. That pass reads heights inside the windows of tiles only, unless they have cells.

const bool kGlobalSolve = true, kClearsHeights = false;

float lawPressure(float d, float d_rate) { return 0.0; }
float lawSlope(float d) { return 0.0; }
