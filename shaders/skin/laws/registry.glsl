// The contact law that this variant of the contact pass is compiled with. Each law defines lawPressure(), lawSlope() and kGlobalSolve (a
// later pass solves for the pressures of all samples at once).
#if defined(LAW_WINKLER)
#include "skin/laws/winkler.glsl"
#elif defined(LAW_ELASTIC_LAYER)
#include "skin/laws/elastic_layer.glsl"
#endif
