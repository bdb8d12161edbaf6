// Ways that take less time to the same frame, each of which the environment variable TAXELSIM_PLAIN can switch off.
#pragma once

namespace taxelsim {

struct FasterPaths {
  bool pairs = true;       // words of an elastic layer fetched two at a time
  bool polyhedra = true;   // convex meshes of few faces as planes instead of triangles: the same surface, not the same bits
  bool untouched = true;   // what nothing is near left early, what is 0 already not cleared again
  bool candidates = true;  // quads of a mesh that moves slowly are looked for once in some steps
  bool lockstep = true;    // workgroups that are one vector of a software driver go without barriers and read texels
  bool alone = true;       // an instance per invocation in the image pass
};

// All, but for those that TAXELSIM_PLAIN names: names with commas between them, or "all". Throws Error(kInput) for another name.
FasterPaths fasterPaths();

}  // namespace taxelsim
