// What stands behind a Simulator: simulator.cpp takes inputs and steps, record_passes.cpp puts the device's passes in order.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "gpu/commands.h"
#include "shared/batch.h"
#include "simulation/batch_buffers.h"
#include "simulation/candidate_schedule.h"
#include "simulation/clock.h"
#include "simulation/model_access.h"
#include "simulation/motions.h"
#include "taxelsim/simulator.h"

namespace taxelsim {

struct Simulator::Impl {
  Impl(const Model& of, const SimulatorOptions& with);

  // Each throws Error(kInput).
  void checkInstance(int instance) const;
  void checkTakesObjects() const;
  void checkTakesContacts() const;

  bool takesContacts() const { return options.max_contacts > 0; }
  bool withShear() const { return implOf(model).hasFriction() && !takesContacts() && options.outputs.tactile_shear_force; }
  void takeContacts(std::size_t instance, std::span<const ContactPoint> contacts) const;
  // What a slot (of num_instances x num_slots) holds from now on.
  void place(std::size_t slot_index, int id, const Pose& X_SO);

  std::span<layout::InstanceRecord> records() const { return buffers.instances.mappedAs<layout::InstanceRecord>(); }

  // Whether some instance draws noise or gains.
  bool anyRandom() const;
  // Draws what is common to all taxels, and hands the device what it needs to draw the rest.
  void setVariation(layout::InstanceRecord& record, std::uint64_t episode, const ReadoutVariation& variation) const;
  // The record of a step of dt. Throws Error(kInput) when the delay is longer than the device keeps.
  layout::StepRecord stepRecord(double dt);

  // What becomes of candidates in a frame.
  enum class Candidates {
    kLeft,  // nothing: no instance has any, and lists of work stand as the frame that found this out has left them
    kKept,  // they are kept and found
    kUsed,  // the same, and some instance may have some before
  };
  // What the commands of a frame differ in.
  struct FrameKind {
    bool loads = false;   // some instance is driven by load
    bool random = false;  // some instance draws noise or gains
    Candidates candidates = Candidates::kLeft;
  };
  // Recorded when first wanted; not finished.
  gpu::Commands& commands(const FrameKind& kind);
  gpu::Commands record(const FrameKind& kind);
  void recordObjects(gpu::Commands& commands, const FrameKind& kind) const;
  void recordCandidates(gpu::Commands& commands, bool with_jacobian) const;
  void recordTaxels(gpu::Commands& commands) const;
  void recordContacts(gpu::Commands& commands) const;
  void recordContactFeatures(gpu::Commands& commands, bool clean) const;
  void recordJacobian(gpu::Commands& commands, bool random) const;
  void startSearch();

  Model model;
  SimulatorOptions options;
  BatchBuffers buffers;
  std::vector<Clock> clocks;
  StepHistory history;
  std::uint32_t num_steps = 0;  // taken so far, by all instances together
  bool keeps_candidates;        // of instances that no load drives
  bool any_candidates = false;  // after the last frame
  bool keeping = false;         // the frame that is running keeps them
  CandidateSchedule candidate_schedule;
  std::optional<Motions> motions;  // of a sensor with friction
  std::array<std::optional<gpu::Commands>, 12> recorded;
  gpu::Commands* running = nullptr;
  StepTiming timing;
};

}  // namespace taxelsim
