// Sizes of workgroups that bench/sweep varies. Not part of the public API.
#pragma once

namespace taxelsim {

// Benchmarking only. 0 selects the value measured best for the kind of device. Results do not depend on it, bit for bit.
struct Tuning {
  int contact_repeat = 0;    // tiles that one workgroup of the contact pass processes in sequence, 1 to 64
  int image_team = 0;        // invocations that share an instance in the image pass: a power of two, 1 to the workgroup size
  int image_repeat = 0;      // instances that one such team processes in sequence, 1 to 64
  int groups_per_batch = 0;  // groups of a mesh's clusters that the contact pass culls between two barriers: a power of two, 16 to 128
};

}  // namespace taxelsim
