// The contact law that this variant of the contact pass is compiled with. Each law defines lawPressure(), lawSlope(), kGlobalSolve (a later pass solves for
// the pressures of all samples at once) and kClearsHeights (the outputs of that solve are read outside of the windows of tiles).
#if defined(LAW_WINKLER)
#include "skin/laws/winkler.glsl"
#elif defined(LAW_ELASTIC_LAYER)
#include "skin/laws/elastic_layer.glsl"
#elif defined(LAW_PASTERNAK)
#include "skin/laws/pasternak.glsl"
#endif
