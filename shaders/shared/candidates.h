// Mesh quads that the contact pass tests for an instance, kept from step to step (shaders/keep_candidates.comp), and the lists of
// instances and tiles that the passes use.
#ifndef TAXELSIM_SHADERS_SHARED_CANDIDATES_H
#define TAXELSIM_SHADERS_SHARED_CANDIDATES_H

#include "shared/types.h"

TAXELSIM_LAYOUT_BEGIN

TAXELSIM_CONSTANT kMaxCandidates = 640u;        // of an instance; the size of its part of the buffer of quad numbers
TAXELSIM_CONSTANT kNoCandidates = 0xFFFFFFFFu;  // instead of the number of candidates
TAXELSIM_CONSTANT kMinGroups = 2u;              // a mesh with fewer groups is culled in the contact pass

// Candidates of one instance. Frame P.
struct CandidateRecord {
  vec4 row0, row1, row2;  // X_PO when the candidates were found; without candidates, X_PO of the previous step
  vec4 center;            // centre of the part of the window inside the object's bounds, m; steps since, or without candidates the steps
                          // until the next search
  vec4 half_size;         // half sizes of that part, m; factor on the number of steps that candidates are found for, 0 for 1
  vec4 low, high;         // bounds of the displacement of the object's points along x, y, z, m; 0
  uvec4 list;             // object + 1, or 0 for none; number of candidates, or kNoCandidates; 0, 0
};

// Lists of instances. Each has a row: columns, rows and layers of workgroups (VkDispatchIndirectCommand), then the number of entries. The
// first word of row kNumLists counts the instances with candidates.
TAXELSIM_CONSTANT kListFindCandidates = 0u;  // instances whose candidates are to be found
TAXELSIM_CONSTANT kListWholeMesh = 1u;       // instances for which the contact pass culls the whole mesh
TAXELSIM_CONSTANT kListCandidates = 2u;      // instances for which the contact pass tests candidates
TAXELSIM_CONSTANT kNumLists = 3u;
TAXELSIM_CONSTANT kMaxColumns = 65535u;  // columns of workgroups, the smallest limit that Vulkan permits

// Further rows: the tiles that workgroups of the contact pass have left to a second dispatch (shaders/depth/tile_sequence.glsl), and in the
// first word of the last row, whether that dispatch runs. Their list follows those of instances.
TAXELSIM_CONSTANT kLeftTiles = 4u;
TAXELSIM_CONSTANT kSecondDispatch = 5u;
TAXELSIM_CONSTANT kNumWorkRows = 6u;

TAXELSIM_LAYOUT_END

#endif
