// Four words of a buffer, loaded together, or one of them (wordOfFours). FOURS: an earlier dispatch has written them. COHERENT_FOURS: the
// same dispatch writes them, through a storage buffer, with workgroupBarrierWithBuffers() between stores and loads.
//
// With ONE_VECTOR or TEXEL_BUFFERS, which only software drivers run, the buffer is a texel buffer: these drivers check bounds and load per
// word and lane for a storage buffer, but once per lane for a texel of 128 bits, so that even one word is better fetched as one of four. A
// GPU loads a uvec4 at once. Loads of a storage texel buffer cost as much as those of a uniform one, but see stores of the same dispatch.
// Stores to it cost more than those of pairs of words.
#if defined(ONE_VECTOR) || defined(TEXEL_BUFFERS)
#define FOURS(number, Name) layout(set = 0, binding = number) uniform usamplerBuffer Name
#define fourOf(Name, index) texelFetch(Name, int(index))
#define COHERENT_FOURS(number, Name) layout(rgba32ui, set = 0, binding = number) coherent readonly uniform uimageBuffer Name
#define loadFour(Name, index) imageLoad(Name, int(index))
#define wordOfFours(Name, index) component(fourOf(Name, (index) / 4u), (index) % 4u)
#else
#define FOURS(number, Name) \
  layout(std430, set = 0, binding = number) readonly buffer Name { uvec4 fours_of_##Name[]; }
#define fourOf(Name, index) fours_of_##Name[index]
#define COHERENT_FOURS(number, Name) \
  layout(std430, set = 0, binding = number) coherent readonly buffer Name { uvec4 fours_of_##Name[]; }
#define loadFour(Name, index) fours_of_##Name[index]
#define wordOfFours(Name, index) fours_of_##Name[(index) / 4u][(index) % 4u]
#endif
#define floatsOfFour(Name, index) uintBitsToFloat(fourOf(Name, index))

// Component `i`. By selection, because compilers keep in memory what has an index that is not constant.
uint component(uvec4 four, uint i) { return mix(mix(four.x, four.y, i == 1u), mix(four.z, four.w, i == 3u), i > 1u); }
#define floatOfFours(Name, index) uintBitsToFloat(wordOfFours(Name, index))
