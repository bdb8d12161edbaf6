// Packs the slot that a surface belongs to into the lowest bits of a float: of a height in the tile, so that atomicMin still finds the
// lowest surface, and of the state of friction. Only for sensors with friction in batches of several slots; otherwise a word holds the
// float unchanged.
//
// The float keeps 20 of its 23 bits, rounded to nearest: a height within the skin is off by at most 2^-21 of the skin's thickness, 1 nm of
// 2 mm.
#ifndef DEPTH_SLOTS_GLSL
#define DEPTH_SLOTS_GLSL
const bool kKeepsSlots = KEEPS_SLOTS;
const uint kSlotMask = (1u << kSlotBits) - 1u;

uint withSlot(float value, uint slot) {
  uint bits = floatBitsToUint(value);
  return kKeepsSlots ? ((bits + (kSlotMask + 1u) / 2u) & ~kSlotMask) | slot : bits;
}

float withoutSlot(uint word) { return uintBitsToFloat(kKeepsSlots ? word & ~kSlotMask : word); }
uint slotOf(uint word) { return kKeepsSlots ? word & kSlotMask : 0u; }
#endif
