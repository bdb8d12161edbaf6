// Records of arrays that passes read as TEXELS (passes/declare.glsl). Macros, because not every pass declares every array; compilers drop
// the rows that are not used.

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
