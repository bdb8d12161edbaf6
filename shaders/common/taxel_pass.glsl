// What the passes share that some laws run over the taxels, between contact and image. An invocation owns a taxel, an instance or a tile of an instance.

#include "shared/batch.h"
#include "shared/sensor.h"
#include "passes/declare.glsl"
#include "passes/taxel_law.h"

#include "common/workgroup.glsl"

// Number of this invocation over the whole batch.
uint invocationNumber() { return workgroupNumber() * WORKGROUP + gl_LocalInvocationIndex; }

// Whether contact has left a force for a taxel. Of a grid of one tile those outside the window were not written.
bool isWritten(uint instance, uint taxel) {
  if (NUM_TILES > 1 || NUM_ROWS == 0) return true;
  uvec4 window = tile_results[instance].window;
  uvec2 at = uvec2(taxel / NUM_COLS, taxel % NUM_COLS);
  return at.x >= window.x && at.x < window.y && at.y >= window.z && at.y < window.w;
}

// Force that contact has left for a taxel, N.
float contactForce(uint instance, uint taxel) { return isWritten(instance, taxel) ? contact_normal[instance * NUM_TAXELS + taxel] : 0.0; }

vec2 contactShear(uint instance, uint taxel) {
  uint first = 2 * (instance * NUM_TAXELS + taxel);
  return isWritten(instance, taxel) ? vec2(contact_shear[first], contact_shear[first + 1]) : vec2(0);
}

// `force` (N) is what the taxel's law makes of it, for the spread.
void giveToSpread(uint instance, uint taxel, float force) {
  contact_normal[instance * NUM_TAXELS + taxel] = SCALED ? force * spread_scale[taxel] : force;
}

void giveShearToSpread(uint instance, uint taxel, vec2 shear) {
  if (SCALED) shear *= spread_scale[taxel];
  uint first = 2 * (instance * NUM_TAXELS + taxel);
  contact_shear[first] = shear.x;
  contact_shear[first + 1] = shear.y;
}
