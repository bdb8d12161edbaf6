// Implementation of Simulator: inputs, the steps taken so far, and the commands of a frame.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/thread_team.h"
#include "gpu/commands.h"
#include "gpu/timeline.h"
#include "simulation/batch_buffers.h"
#include "simulation/batch_options.h"
#include "simulation/candidate_schedule.h"
#include "simulation/clock.h"
#include "simulation/frame_graph.h"
#include "simulation/frame_view.h"
#include "simulation/model_access.h"
#include "simulation/motions.h"
#include "simulation/near_slots.h"
#include "taxelsim/simulator.h"

namespace taxelsim {

// Instances that a step computes; it holds the others.
struct Selection {
  std::span<const std::uint8_t> flags = {};  // (num_instances), not 0: computed; empty: all are

  bool isAll() const { return flags.empty(); }
  bool has(std::size_t instance) const { return flags.empty() || flags[instance] != 0; }
};

struct Simulator::Impl {
  // Throws Error(kInput) for options out of range and for a batch that does not fit.
  Impl(const Model& shared_model, const BatchOptions& batch_options);

  // Throws Error(kInput), or std::logic_error before read() of the last step.
  void checkCanStep(double dt) const;
  // Each throws Error(kInput).
  void checkInstance(int instance) const;
  void checkTakesCalls() const;
  void checkTakesObjects() const;
  void checkTakesContacts() const;

  bool takesContacts() const { return options.max_contacts > 0; }
  const ModelData& data() const { return implOf(model).data; }
  void takeContacts(std::size_t instance, std::span<const ContactPoint> contacts);
  // Sets a slot of an instance. Step() sends those that are near to the device.
  void place(std::size_t instance, std::size_t slot, int id, const Pose& X_SO);

  // Whether some instance draws noise or gains.
  bool anyRandom() const;
  // Sets the episode of an instance and what it varies, and writes its record to the device. Draws what all taxels have in common; the
  // device draws the rest from what the record holds.
  void vary(std::size_t instance, std::uint64_t episode, const ReadoutVariation& variation, const SkinVariation& skin);
  // Largest factor on the delay that an instance has.
  float longestDelay() const;
  // The record of a step of dt. Throws Error(kInput) when the delay is longer than the device keeps.
  layout::StepRecord stepRecord(double dt, const Selection& selection);
  // Advances the clock of an instance by dt and writes its record, and the motions of its near objects, of which an instance has up to
  // num_near.
  void startFrame(std::size_t instance, double dt, const FrameTiming& frame_timing, std::size_t num_near);
  // startFrame() of the selected instances; holds the others. Writes the records of all. Returns whether one is driven by load.
  bool startFrames(double dt, const Selection& selection, std::size_t num_near);
  std::size_t numSelected(const Selection& selection) const;
  // Which candidate passes the frame runs; `one_near`: no instance has several near objects.
  FrameKind::Candidates candidatesOf(const Selection& selection, bool any_load, bool one_near);
  // Writes the poses that the host knows; returns how many an instance has. With closed loops the device has written the others.
  std::size_t packPoses();
  // Both overloads of Simulator::step(). The selection must be valid.
  void step(double dt, const Selection& selection);

  // The frames that steps may need; `with_loads`: those of load-driven instances too.
  std::vector<FrameKind> kinds(bool with_loads) const;
  // Recorded when first needed; not finished.
  gpu::Commands& commands(const FrameKind& kind);
  gpu::Commands& gradientCommands(bool with_gains);
  // Submits a list whose outputs the host reads.
  void submit(gpu::Commands& list, ReadAfter after);
  bool isRunning() const { return running[0].commands != nullptr || running[1].commands != nullptr; }
  // Waits for a running frame, if any; for all of them, in their order.
  void finish(std::size_t frame_half);
  void finish() {
    finish(half ^ 1u);
    finish(half);
  }
  // Throws Error(kInput) if inputs of another interface were not allowed.
  void checkInputs(std::size_t frame_half) const;
  // Call it before the host writes inputs that a running frame reads. With exported outputs the host may not have waited for that frame.
  void ownInputs() {
    if (options.export_memory) finish();
  }
  // Throws Error(kDevice) if the driver has cut a loop of the last commands short.
  void checkLoops() const;

  Model model;
  BatchOptions options;
  BatchBuffers buffers;
  // (num_instances): what the host reads of the records, because reading memory of a GPU that the host writes to is slow.
  std::vector<float> loads;  // N, or kPoseDriven
  std::vector<std::uint64_t> episodes;
  std::vector<std::uint32_t> flags;      // of the last step
  std::vector<float> delays;             // factors on the delay
  std::vector<std::uint8_t> are_random;  // 1: draws noise or gains
  std::size_t num_random = 0;            // sum of are_random
  IntegerFeatures integer_features;
  std::vector<Clock> clocks;
  StepHistory history;
  std::uint32_t num_steps = 0;  // of the batch so far
  bool keeps_candidates;        // while no instance is driven by load
  bool any_candidates = false;  // after the last frame
  CandidateSchedule candidate_schedule;
  NearSlots near;
  std::vector<std::size_t> placed;  // with closed loops: instances whose object was set since the last step
  std::optional<Motions> motions;   // of a sensor with friction
  ThreadTeam team;                  // shares loops over the instances; the results do not depend on their number
  std::array<std::optional<gpu::Commands>, 128> recorded;
  std::array<std::optional<gpu::Commands>, 4> recorded_gradients;  // without and with gains, by half
  // A frame that the device computes.
  struct Running {
    gpu::Commands* commands = nullptr;
    bool keeping = false;  // it runs the candidate passes
  };
  std::array<Running, 2> running;         // by half of the arrays that are double
  std::size_t half = 0;                   // half that the last frame uses; the halves take turns while the host places no objects
  bool places = false;                    // another interface writes objects, poses and loads
  bool takes_loads = false;               // the interface may write loads
  std::optional<gpu::Timeline> timeline;  // orders steps and consumers of exported outputs, where the driver exports one
  gpu::TimelinePoints points;             // `end` of the last step, `after` of the next one
  bool has_frame = false;                 // some step has been read
  StepTiming timing;
  DeviceTraffic traffic;
};

}  // namespace taxelsim
