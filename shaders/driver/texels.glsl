// Four words of a buffer that no kernel writes, fetched together.
//
// With LOCKSTEP as texels: a software driver checks bounds and loads word by word and lane by lane where it reads a storage buffer, but a lane's texel
// of 128 bits with one check and one load. A GPU fetches a uvec4 in one go.
#ifdef LOCKSTEP
#define FOURS(number, Name) layout(set = 0, binding = number) uniform usamplerBuffer Name
#define fourOf(Name, index) texelFetch(Name, int(index))
#else
#define FOURS(number, Name) layout(std430, set = 0, binding = number) readonly buffer Name { uvec4 fours_of_##Name[]; }
#define fourOf(Name, index) fours_of_##Name[index]
#endif
#define floatsOfFour(Name, index) uintBitsToFloat(fourOf(Name, index))
