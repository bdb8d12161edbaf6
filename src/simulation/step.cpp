// Simulator::step(): writes what a frame needs to the device and submits it.
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "base/length_check.h"
#include "shared/batch.h"
#include "shared/features.h"
#include "simulation/passes/load_search.h"
#include "simulation/simulator_impl.h"
#include "taxelsim/error.h"

namespace taxelsim {

std::size_t Simulator::Impl::numSelected(const Selection& selection) const {
  if (selection.isAll()) return clocks.size();
  return clocks.size() - static_cast<std::size_t>(std::count(selection.flags.begin(), selection.flags.end(), 0));
}

void Simulator::Impl::startFrame(std::size_t instance, double dt, const FrameTiming& frame_timing, std::size_t num_near) {
  layout::InstanceRecord& record = buffers.input<block::Instances>(half)[instance];
  Clock& clock = clocks[instance];
  const std::uint64_t episode = episodes[instance];
  const std::uint32_t frame = clock.frames;
  flags[instance] = 0;
  if (clock.steps == 0) flags[instance] |= layout::kFlagFirstStep;
  if (!std::isnan(loads[instance])) flags[instance] |= layout::kFlagLoadDriven;
  if (clock.frameDue(frame_timing.rate)) {
    flags[instance] |= layout::kFlagNewFrame;
    clock.deliver(frame_timing, episode);
  }
  const std::uint32_t back = options.vary_skin ? history.stepsBack(model.sensor().readout.delay * delays[instance]) : 0;
  record.keys = {static_cast<std::uint32_t>(episode), static_cast<std::uint32_t>(episode >> 32), frame, flags[instance]};
  record.clock = {clock.steps++, back, 0u, 0u};
  clock.time += dt;
  if (!motions || places) return;
  const float load_offset = buffers.output<block::Features>()[layout::kFeatureLoadOffset * clocks.size() + instance];
  motions->pack(instance, load_offset, near.of(instance), buffers.input<block::Motions>().subspan(instance * num_near, num_near));
}

FrameKind::Candidates Simulator::Impl::candidatesOf(const Selection& selection, bool any_load, bool one_near) {
  using Candidates = FrameKind::Candidates;
  const bool keeps = selection.isAll() && keeps_candidates && one_near && !any_load && candidate_schedule.keeps();
  running[half].keeping = keeps;
  // The host does not know yet whether a running frame has found any.
  if (keeps) return any_candidates || isRunning() ? Candidates::kUsed : Candidates::kKept;
  return (selection.isAll() && one_near) || !keeps_candidates || any_load ? Candidates::kSkipped : Candidates::kLeft;
}

bool Simulator::Impl::startFrames(double dt, const Selection& selection, std::size_t num_near) {
  const Sensor& sensor = model.sensor();
  const FrameTiming frame_timing{.rate = sensor.frame_rate, .jitter = sensor.readout.jitter, .seed = options.seed};
  team.run(static_cast<int>(clocks.size()), [&](int first, int last) {
    for (auto i = static_cast<std::size_t>(first); i < static_cast<std::size_t>(last); ++i) {
      if (selection.has(i)) {
        startFrame(i, dt, frame_timing, num_near);
      } else {
        flags[i] = layout::kFlagHeld;
        buffers.input<block::Instances>(half)[i].keys.w = flags[i];
      }
    }
  });
  // The rest of a record changes with reset() and setLoad() only.
  const std::size_t num_selected = numSelected(selection);
  traffic.bytes_to_device += num_selected * (sizeof(layout::InstanceRecord::keys) + sizeof(layout::InstanceRecord::clock)) +
                             (clocks.size() - num_selected) * sizeof(std::uint32_t);
  if (motions && !places) traffic.bytes_to_device += num_selected * num_near * sizeof(layout::MotionRecord);
  return std::any_of(flags.begin(), flags.end(), [](std::uint32_t flag) { return (flag & layout::kFlagLoadDriven) != 0; });
}

std::size_t Simulator::Impl::packPoses() {
  if (takesContacts()) return 0;
  const std::span<layout::PoseRecord> poses = buffers.input<block::Poses>();
  if (options.loop) {
    for (const std::size_t instance : placed) poses[instance] = near.packOnly(instance, loads[instance]);
    traffic.bytes_to_device += placed.size() * sizeof(layout::PoseRecord);
    placed.clear();
    return 1;
  }
  const std::size_t num_near = near.pack(loads, poses, team);
  traffic.bytes_to_device += clocks.size() * num_near * sizeof(layout::PoseRecord);
  return num_near;
}

void Simulator::Impl::step(double dt, const Selection& selection) {
  if (places) half ^= 1u;
  finish(half);
  if (!places) finish();
  layout::StepRecord step_record = stepRecord(dt, selection);
  const std::size_t num_near = places ? static_cast<std::size_t>(options.num_slots) : packPoses();
  if (!takesContacts()) step_record.batch.y = static_cast<std::uint32_t>(num_near);
  const bool any_load = startFrames(dt, selection, num_near) || (places && takes_loads);
  if (any_load && !places && !data().layer && !data().packed.searches_in_tile) {
    startLoadSearch(data(), flags, buffers.input<block::Poses>().first(clocks.size() * num_near), buffers.input<block::Loads>());
    traffic.bytes_to_device += numSelected(selection) * sizeof(layout::LoadRecord);
  }
  const FrameKind::Candidates candidates = candidatesOf(selection, any_load, num_near == 1);
  step_record.candidates.x = candidates == FrameKind::Candidates::kUsed;
  buffers.input<block::Step>(half)[0] = step_record;
  traffic.bytes_to_device += sizeof(step_record);
  gpu::Commands& frame =
      commands({.loads = any_load, .random = anyRandom(), .many_near = num_near > 1, .places = places, .candidates = candidates});
  submit(frame, kAfterFrame);
  running[half].commands = &frame;
}

void Simulator::Impl::submit(gpu::Commands& list, ReadAfter after) {
  list.submit(timeline ? &*timeline : nullptr, {points.after, points.end + 2});
  points = {points.end + 2, points.end + 2};
  ++traffic.num_submits;
  traffic.bytes_from_device += buffers.bytesRead(options, after);
}

void Simulator::Impl::checkCanStep(double dt) const {
  if (!(dt > 0) || std::isinf(dt)) throw Error(ErrorKind::kInput, "dt: " + std::to_string(dt) + " is not allowed: s, > 0");
  if (isRunning() && !options.export_memory) throw std::logic_error("a step was taken before read() of the last one");
}

void Simulator::step(double dt) {
  impl_->checkCanStep(dt);
  impl_->step(dt, {});
}

void Simulator::step(double dt, std::span<const std::uint8_t> instances) {
  impl_->checkCanStep(dt);
  checkLength("instances", instances.size(), impl_->clocks.size());
  bool any = false;
  for (std::size_t i = 0; i < instances.size(); ++i) {
    if (instances[i] == 0) continue;
    any = true;
    if (impl_->clocks[i].steps > 0) {
      throw std::logic_error("instance " + std::to_string(i) + " was not reset before a step of some instances");
    }
  }
  if (any) impl_->step(dt, {instances});
}

}  // namespace taxelsim
