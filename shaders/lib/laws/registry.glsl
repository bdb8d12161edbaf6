// The contact law that this variant of the contact pass is compiled with; one line a law. Each defines lawPressure() and lawSlope().
#if defined(LAW_WINKLER)
#include "lib/laws/winkler.glsl"
#endif
