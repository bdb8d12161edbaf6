// Turns the lists of this folder into GLSL. Included before the list of a pass.
//
// A list declares what a pass takes from the host, once for both languages:
//
//   CONSTANT(id, type, NAME)         specialization constant; the host gives every one a value, so there are no defaults
//   VALUE(kName, value)              uint that both languages need
//   BUFFER(binding, access, Block)   storage buffer of set 0 with the array of this block, blocks.h; access: readonly, writeonly, ...
//   UNIFORM(binding, Block)          uniform buffer of one record, which all invocations read at the same index
//   TEXELS(binding, Block)           read-only array that is fetched four words at a time by fourOf(), driver/texels.glsl
//   COHERENT_TEXELS(binding, Block)  array that the same pass writes as a BUFFER of another block; loadFour() reads four words at a time
//
// src/simulation/passes/interfaces.h reads the same lists.

#include "driver/texels.glsl"
#include "shared/batch.h"
#include "shared/model.h"
#include "passes/blocks.h"

#define BLOCK(Name, Element, declarator) Element declarator;
#define CONSTANT(id, type, NAME) layout(constant_id = id) const type NAME = type(1);
#define VALUE(name, value) const uint name = value;
#define readwrite
#define BUFFER(number, access, Name) layout(std430, set = 0, binding = number) access buffer Name{BLOCK_##Name};
#define UNIFORM(number, Name) layout(std140, set = 0, binding = number) uniform Name{BLOCK_##Name};
#define TEXELS(number, Name) FOURS(number, Name);
#define COHERENT_TEXELS(number, Name) COHERENT_FOURS(number, Name);

#include "passes/common.h"
layout(local_size_x_id = 0) in;

// Number of this workgroup: Commands::dispatch() folds large numbers of workgroups into two dimensions.
uint workgroupNumber() { return gl_WorkGroupID.x + gl_WorkGroupID.y * gl_NumWorkGroups.x; }

// Records of arrays that passes read as TEXELS. Macros, because not every pass declares every array; compilers drop the rows that are not
// used.
#define instanceRecord(i)                                                                                          \
  InstanceRecord(floatsOfFour(Instances, 5 * (i)), fourOf(Instances, 5 * (i) + 1), fourOf(Instances, 5 * (i) + 2), \
                 floatsOfFour(Instances, 5 * (i) + 3), floatsOfFour(Instances, 5 * (i) + 4))
#define patchRecord(i)                                                                                                \
  PatchRecord(floatsOfFour(Patches, 5 * (i)), floatsOfFour(Patches, 5 * (i) + 1), floatsOfFour(Patches, 5 * (i) + 2), \
              fourOf(Patches, 5 * (i) + 3), floatsOfFour(Patches, 5 * (i) + 4))
#define planeRecord(i)                                                                                             \
  PlaneRecord(floatsOfFour(Planes, 7 * (i)), floatsOfFour(Planes, 7 * (i) + 1), floatsOfFour(Planes, 7 * (i) + 2), \
              fourOf(Planes, 7 * (i) + 3), floatsOfFour(Planes, 7 * (i) + 4), floatsOfFour(Planes, 7 * (i) + 5),   \
              floatsOfFour(Planes, 7 * (i) + 6))
#define tileResult(i) \
  TileResult(floatsOfFour(TileResults, 3 * (i)), floatsOfFour(TileResults, 3 * (i) + 1), fourOf(TileResults, 3 * (i) + 2))
