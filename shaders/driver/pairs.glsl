// Two words of a buffer, fetched together. Mesa's older software driver fetches per lane and component, so that a word of 64 bits costs hardly more than one of
// 32; the newer one computes a lane's address once for all components.
#ifdef PAIRS_OF_64_BITS
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#define Pair uint64_t
#define wordsOf unpackUint2x32
#define pairOf packUint2x32
#else
#define Pair uvec2
#define wordsOf
#define pairOf
#endif
