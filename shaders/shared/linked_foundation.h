// Tables of a two-parameter foundation on several patches. Taxels are cut into blocks. Nodes are numbered by taxel, block of it, and color:
// nodes of one color have no links with each other.
#ifndef TAXELSIM_SHADERS_SHARED_LINKED_FOUNDATION_H
#define TAXELSIM_SHADERS_SHARED_LINKED_FOUNDATION_H

#include "shared/types.h"

TAXELSIM_LAYOUT_BEGIN

TAXELSIM_CONSTANT kMaxNodeColors = 8u;
// Of a link's first word: the other node below its block, below the sides of the two cells through which the line between the nodes leaves,
// kSideBits each: that of the node first. Sides 0 to 3 look along -x, x, -y and y of their patch.
TAXELSIM_CONSTANT kLinkBlockShift = 16u, kLinkSidesShift = 28u, kSideBits = 2u;
TAXELSIM_CONSTANT kNodeLinksShift = 24u;  // of a node's last word: tile below, fours of links above

// A node: index in the heights of an instance; row << 16 | column in its patch; spring, N/m, as bits; tile of the contact pass and number
// of its links in fours.
struct FoundationNodeRecord {
  uvec4 node;
};

// A link: node, block and sides; stiffness, N/m, and 1 / length, 1/m, as bits; stiffness towards skin at rest, N/m, as bits. Unused links
// have the stiffness 0.
struct FoundationLinkRecord {
  uvec4 link;
};

struct FoundationBlockRecord {
  uvec4 tiles;       // of the contact pass that have the corners of the block
  uvec4 nodes;       // in its patch: first row, end row, first column, end column
  uvec4 color_ends;  // first node after each color, from the first node of the block on: 16 bits each, from the lowest on
  uvec4 near;        // where its list in near_blocks[] begins and ends; its patch; 0
};

TAXELSIM_LAYOUT_END

#endif
