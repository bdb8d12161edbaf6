// The contact law that this variant of the contact pass is compiled with; one line a law. Each defines lawPressure(), lawSlope() and
// kLawSolvedApart.
#if defined(LAW_WINKLER)
#include "skin/laws/winkler.glsl"
#elif defined(LAW_ELASTIC_LAYER)
#include "skin/laws/elastic_layer.glsl"
#endif
