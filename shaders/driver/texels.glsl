// Four words of a read-only buffer, fetched together.
//
// With LOCKSTEP the buffer is a texel buffer: software drivers check bounds and load per word and lane for a storage buffer, but once per lane for a texel of
// 128 bits. A GPU loads a uvec4 at once.
#ifdef LOCKSTEP
#define FOURS(number, Name) layout(set = 0, binding = number) uniform usamplerBuffer Name
#define fourOf(Name, index) texelFetch(Name, int(index))
#else
#define FOURS(number, Name) layout(std430, set = 0, binding = number) readonly buffer Name { uvec4 fours_of_##Name[]; }
#define fourOf(Name, index) fours_of_##Name[index]
#endif
#define floatsOfFour(Name, index) uintBitsToFloat(fourOf(Name, index))
