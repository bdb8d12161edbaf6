// Every assumption about drivers and kinds of device that Vulkan does not report. Passes ask questions by name; nothing else looks at the
// type of a device or the name of a driver to decide how to compute.
#pragma once

#include <cstdint>
#include <span>

#include "gpu/context.h"
#include "taxelsim/device.h"

namespace taxelsim::gpu {

// Fast paths: the same results in less time. Each has a plain path; tests compare the results of both.
struct FastPaths {
  bool polyhedra = true;   // convex meshes of few faces as half-spaces: the same surface, other roundings
  bool kinds = true;       // the contact pass runs once for each kind of object
  bool untouched = true;   // early exit where no object is near; values that are 0 are not cleared again
  bool candidates = true;  // triangles of a slow mesh are culled once in several steps
  bool lockstep = true;    // no barriers in workgroups that are one vector of a software driver, and loads through texel buffers
  bool alone = true;       // one invocation per item of work instead of a team
  bool servo = true;       // closed loops of free-flying servos on the device
  bool threads = true;     // each thread of a software driver keeps to a processor; from the opening of a device on
  bool sequences = true;   // long sequences of tiles under fine meshes, of which a workgroup may leave some to a second dispatch
};

// All of them, except those that the environment variable TAXELSIM_PLAIN names: names separated by commas, or "all". Throws Error(kInput)
// for an unknown name.
FastPaths fastPaths();

// A kernel, and the same kernel compiled for workgroups in lockstep: shaders/driver/workgroup.glsl.
struct ShaderVariants {
  std::span<const std::uint32_t> any, lockstep;
};

// Loop iterations per invocation that work may be planned for. Mesa's software driver ends all loops of an invocation after 65,535
// iterations together, silently; the rest is a margin for what estimates miss. Kernels report when a loop was ended early.
inline constexpr std::uint64_t kMaxIterations = 20000;

class DriverProfile {
 public:
  DriverProfile(const DeviceInfo& info, const WideNumbers& wide_numbers, const FastPaths& paths);

  const FastPaths& paths() const { return paths_; }

  // Invocations per workgroup for work that one invocation alone would do in `iterations`.
  std::uint32_t workgroupFor(std::uint64_t iterations) const;
  // Invocations per workgroup where no invocation waits for another.
  static constexpr std::uint32_t kIndependentWorkgroup = 64;

  // Whether an item of so many iterations is done by one invocation rather than by a team: a software driver then computes as many items at
  // a time as a vector has lanes, without barriers.
  bool prefersOneInvocationPerItem(std::uint64_t iterations) const;

  // Items of so many iterations that an invocation does in sequence, 1 to `most`: starting a workgroup costs a software driver 1 to 3 us.
  std::uint32_t itemsInSequence(std::uint64_t iterations, std::uint32_t most) const;

  // Whether itemsInSequence() depends on the iterations of an item.
  bool limitsIterations() const { return is_software_; }

  // Partial sums of a reduction that every invocation of a workgroup reads.
  std::uint32_t partialSumsFor(std::uint64_t iterations) const;

  // Whether shared memory is better spent on fewer barriers, which cost a software driver some microseconds each, than on more workgroups
  // at a time.
  bool prefersFewBarriers() const { return is_software_; }

  // Whether the device can close the loops of servos, with the host's bits.
  bool canRunServos() const { return wide_numbers_.floats; }
  // Whether it should. A software device would compute on the processors what the host computes there anyway.
  bool prefersServosOnDevice() const { return paths_.servo && canRunServos() && !is_software_; }

  // Whether the driver's threads are bound to processors: gpu/driver_threads.h.
  bool bindsThreads() const { return paths_.threads && vector_size_ > 0; }

  // The variant for workgroups of this size. A workgroup that is one vector of Mesa's software driver runs in lockstep, if the driver has
  // atomic operations of 64 bits (shaders/depth/area/cell_sums.glsl). kNoneWaits: invocations do not wait for each other, whatever the
  // size.
  static constexpr std::uint32_t kNoneWaits = 1;
  std::span<const std::uint32_t> select(const ShaderVariants& variants, std::uint32_t workgroup) const;

  // Whether workgroups of several vectors, too, load texels in passes that have such a variant: shaders/driver/texels.glsl.
  bool prefersTexels() const { return paths_.lockstep && vector_size_ > 0; }

  // Whether device memory is not mapped, so that results need a second buffer that they are copied to.
  bool copiesResults() const { return has_own_memory_; }

 private:
  FastPaths paths_;
  std::uint32_t vector_size_ = 0;  // lanes that run in lockstep; 0: unknown, not Mesa's software driver
  bool is_software_ = false;
  WideNumbers wide_numbers_;
  bool has_own_memory_ = false;
};

}  // namespace taxelsim::gpu
