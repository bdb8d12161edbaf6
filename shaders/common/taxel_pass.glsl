// What the passes share that some laws run over the taxels, between contact and image. An invocation owns a taxel, an instance or a tile of an instance.

#include "shared/batch.h"
#include "shared/sensor.h"
#include "common/specialization.glsl"
layout(constant_id = 11) const bool SCALED = true;  // as in contact.comp, which leaves the scale to these passes
layout(constant_id = 12) const float LAW_0 = 0.0;   // parameters of the law
layout(constant_id = 13) const float LAW_1 = 0.0;
layout(constant_id = 14) const bool SHEAR = false;  // contact_shear is wanted
layout(constant_id = 15) const float FRICTION_COEFFICIENT = 0.0;

layout(std430, set = 0, binding = 0) readonly buffer Instances { InstanceRecord instances[]; };
layout(std430, set = 0, binding = 1) readonly buffer Step { StepRecord step_record; };
layout(std430, set = 0, binding = 2) readonly buffer SpreadScale { float spread_scale[]; };
layout(std430, set = 0, binding = 3) readonly buffer Neighbours { vec2 neighbours[]; };  // (9 x num_taxels): taxel (as bits), weight
layout(std430, set = 0, binding = 4) buffer ContactNormal { float contact_normal[]; };
layout(std430, set = 0, binding = 5) buffer LawState { vec2 law_state[]; };  // (num_instances x num_taxels)
layout(std430, set = 0, binding = 6) buffer TileResults { TileResult tile_results[]; };
layout(std430, set = 0, binding = 7) readonly buffer Taxels { TaxelRecord taxels[]; };
layout(std430, set = 0, binding = 8) writeonly buffer Problems { uint problems[]; };
layout(std430, set = 0, binding = 9) buffer ContactShear { float contact_shear[]; };  // (num_instances x num_taxels x 2)

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
