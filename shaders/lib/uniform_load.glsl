// Rows that all invocations of a workgroup need alike. A software driver fetches lane by lane, so a row that all lanes read costs four fetches of as
// many words as there are lanes; with subgroup operations each lane fetches one word of the row and hands it round. To be used where all
// invocations are active.
#if defined(SUBGROUPS)
#extension GL_KHR_shader_subgroup_ballot : require
#define UNIFORM_ROW(row) shareRow((row)[gl_SubgroupInvocationID & 3u])
vec4 shareRow(float word) {
  return vec4(subgroupBroadcast(word, 0), subgroupBroadcast(word, 1), subgroupBroadcast(word, 2), subgroupBroadcast(word, 3));
}
uvec4 shareRow(uint word) {
  return uvec4(subgroupBroadcast(word, 0), subgroupBroadcast(word, 1), subgroupBroadcast(word, 2), subgroupBroadcast(word, 3));
}
#else
#define UNIFORM_ROW(row) (row)
#endif
