// Turns the lists of this folder into GLSL. Included before the list of a pass.
//
// A list declares what a pass takes from the host, once for both languages:
//   CONSTANT(id, type, NAME)         specialization constant; the host gives every one a value, so there are no defaults VALUE(kName,
//   value)              uint that both languages need BUFFER(binding, access, Block)   storage buffer of set 0 with the array of this
//   block, blocks.h; access: readonly, writeonly, readwrite, coherent UNIFORM(binding, Block)          uniform buffer of one record, which
//   all invocations read at the same index TEXELS(binding, Block)           read-only array that is fetched four words at a time by
//   fourOf(), driver/texels.glsl COHERENT_TEXELS(binding, Block)  array that the same pass writes as a BUFFER of another block, and
//   loadFour() reads four words at a time
// src/simulation/passes/interfaces.h reads the same lists.

#include "driver/texels.glsl"
#include "shared/batch.h"
#include "shared/candidates.h"
#include "shared/iterations.h"
#include "shared/objects.h"
#include "shared/sensor.h"
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
#include "common/records.glsl"
