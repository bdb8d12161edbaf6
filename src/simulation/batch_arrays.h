// Every array of a batch in one table: its block, its size per instance, where it lives and whether it is read back.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

#include "gpu/buffer.h"
#include "simulation/batch_options.h"
#include "simulation/model_data.h"
#include "taxelsim/simulator.h"

namespace taxelsim {

// The first of the outputs that needs derivatives of forces, or the end of kOutputs.
inline auto derivativeIn(const OutputOptions& outputs) {
  return std::find_if(std::begin(kOutputs), std::end(kOutputs),
                      [&](const OutputEntry& entry) { return entry.is_derivative && outputs.*entry.member; });
}

// What the sizes depend on.
struct BatchShape {
  const ModelData& model;
  const BatchOptions& options;
  bool keeps_candidates = false;  // between steps

  bool takesContacts() const { return options.max_contacts > 0; }
  bool takesObjects() const { return options.export_memory && !takesContacts(); }  // from another interface
  std::uint64_t contactInputs() const { return options.export_memory ? static_cast<std::uint64_t>(options.max_contacts) : 0; }
  bool hasFriction() const { return model.hasFriction() && !takesContacts(); }
  bool hasLayer() const { return model.layer.has_value() && !takesContacts(); }
  bool outputsShear() const { return hasFriction() && (options.outputs.tactile_shear_force || options.outputs.taxel_counts); }
  bool outputsContactFeatures() const { return options.outputs.contact_features || options.outputs.clean_contact_features; }
  bool outputsJacobian() const { return derivativeIn(options.outputs) != std::end(kOutputs); }
};

// After what the host reads an array.
enum ReadAfter : unsigned { kAfterFrame = 1, kAfterGradient = 2 };

// Whether SimulatorOptions::export_memory exports an array: of frames, which are then not read by the host or are read too; or of inputs.
enum class Export { kNever, kOnly, kToo, kInput };

struct BatchArray {
  std::size_t block_index;  // block::...::kIndex
  const char* name;         // in messages and debuggers
  std::size_t element_bytes;
  std::uint64_t (*count)(const BatchShape&);  // elements per instance, or in all
  gpu::Domain domain;
  bool (*is_read)(const BatchOptions&) = nullptr;  // whether the host reads it; nullptr: it stays on the device
  bool per_instance = true;
  unsigned read_after = kAfterFrame;  // bits of ReadAfter
  Export exports = Export::kNever;
  bool is_double = false;  // has a second half where the host begins a frame while the one before runs: BatchBuffers

  std::uint64_t bytes(const BatchShape& shape) const { return count(shape) * element_bytes; }
  bool isReadable() const { return is_read != nullptr; }
  bool isExported(const BatchOptions& options) const {
    return options.export_memory && exports != Export::kNever && (!isReadable() || is_read(options));
  }
  bool isForHost(const BatchOptions& options) const { return isReadable() && !(isExported(options) && exports == Export::kOnly); }
  bool isRead(const BatchOptions& options, ReadAfter after) const {
    return isForHost(options) && (read_after & after) != 0 && is_read(options);
  }
};

std::span<const BatchArray> batchArrays();

}  // namespace taxelsim
