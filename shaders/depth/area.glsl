// Area sampling, AREA: the depth of a sample is the mean over its cell of the depth of the lowest surface, clamped to the skin.
//
//   closed mesh, box                  facets.glsl                 edge_sums.glsl, cell_sums.glsl
//   torus                             a mesh of its own           as a closed mesh
//   half-space, cone, upright cylinder  round_facets.glsl         facets.glsl
//   sphere, capsule, lying cylinder   solid_cells.glsl            chords.glsl, cell_sums.glsl
//   mesh that is not closed           as with point sampling, depth/raster.glsl
#include "depth/area/edge_sums.glsl"
#include "depth/area/facets.glsl"
#include "depth/area/chords.glsl"
#include "depth/area/round_facets.glsl"
#include "depth/area/solid_cells.glsl"
