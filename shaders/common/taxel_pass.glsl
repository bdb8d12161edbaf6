// Shared by the passes that some laws run over the taxels between the contact and the image pass: the forces that the contact pass has left
// (N), and the forces that the spread takes (N).

#include "passes/declare.glsl"
#include "passes/taxel_law.h"

#include "common/instances.glsl"
#include "driver/loops.glsl"

// Number of this invocation over the whole batch.
uint invocationNumber() { return workgroupNumber() * WORKGROUP + gl_LocalInvocationIndex; }

// Whether the contact pass has written a taxel's force. On a grid of one tile it writes only those inside the window of its result.
bool isWritten(uint instance, uint taxel) {
  if (NUM_TILES > 1 || NUM_ROWS == 0) return true;
  uvec4 window = fourOf(ResultFours, 3 * instance + 2);
  uvec2 at = uvec2(taxel / NUM_COLS, taxel % NUM_COLS);
  return at.x >= window.x && at.x < window.y && at.y >= window.z && at.y < window.w;
}

float contactForce(uint instance, uint taxel) {
  return isWritten(instance, taxel) ? floatOfFours(ForceFours, instance * NUM_TAXELS + taxel) : 0.0;
}

vec2 contactShear(uint instance, uint taxel) {
  uint first = 2 * (instance * NUM_TAXELS + taxel);
  return isWritten(instance, taxel) ? vec2(contact_shear[first], contact_shear[first + 1]) : vec2(0);
}

// Outputs for the spread, divided by the part of the kernel that stays on the sensor.
void writeForce(uint instance, uint taxel, float force) {
  contact_normal[instance * NUM_TAXELS + taxel] = SCALED ? force * spread_scale[taxel] : force;
}

void writeShear(uint instance, uint taxel, vec2 shear) {
  if (SCALED) shear *= spread_scale[taxel];
  uint first = 2 * (instance * NUM_TAXELS + taxel);
  contact_shear[first] = shear.x;
  contact_shear[first + 1] = shear.y;
}
