// The contact law that this variant of the contact pass is compiled with; one line a law. Each defines lawPressure() and lawSlope(), kLawSolvedApart, and
// lawReach(): up to which height over the skin (m) surfaces matter to it.
#if defined(LAW_WINKLER)
#include "lib/laws/winkler.glsl"
#elif defined(LAW_ELASTIC_LAYER)
#include "lib/laws/elastic_layer.glsl"
#endif
