/// @file
/// A batch of sensor instances over one Model: poses or contact points in, tactile images and features out.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <span>

#include "taxelsim/contact_point.h"
#include "taxelsim/features.h"
#include "taxelsim/model.h"
#include "taxelsim/output_table.h"
#include "taxelsim/pose.h"
#include "taxelsim/skin_variation.h"

namespace taxelsim {

inline constexpr int kMaxSlots = 8;        ///< Most objects that one instance can touch at a time.
inline constexpr int kNoObject = -1;       ///< Id of an empty slot.
inline constexpr int kMaxContacts = 4096;  ///< Most contact points of one instance.
inline constexpr int kMaxRegions = 8;      ///< Most contact regions with features of their own.
/// Load of an instance that is driven by its pose.
inline constexpr float kPoseDriven = std::numeric_limits<float>::quiet_NaN();

/// Optional outputs, the rows of taxelsim/output_table.h. Features and FrameView::tactile_image are always computed.
struct OutputOptions {
/// Declares the member of an output.
#define TAXELSIM_OUTPUT(name, is_default, is_derivative, where, text) bool name = is_default;
  TAXELSIM_OUTPUTS(TAXELSIM_OUTPUT)
#undef TAXELSIM_OUTPUT
};

/// A member of OutputOptions.
struct OutputEntry {
  const char* name;             ///< Its name.
  bool OutputOptions::*member;  ///< The member.
  bool is_derivative;           ///< Needs the derivatives of forces by a twist of the sensor.
  const char* where;            ///< Where a caller finds the output, in Python's words.
  const char* text;             ///< Content and cost.
};

/// All members of OutputOptions.
inline constexpr OutputEntry kOutputs[] = {
/// The entry of an output.
#define TAXELSIM_OUTPUT(name, is_default, is_derivative, where, text) {#name, &OutputOptions::name, is_derivative, where, text},
    TAXELSIM_OUTPUTS(TAXELSIM_OUTPUT)
#undef TAXELSIM_OUTPUT
};

/// No optional outputs.
inline constexpr OutputOptions kNoOutputs = [] {
  OutputOptions none;
  for (const OutputEntry& output : kOutputs) none.*output.member = false;
  return none;
}();

/// Outputs of `a`, of `b`, or of both.
constexpr OutputOptions operator|(OutputOptions a, const OutputOptions& b) {
  for (const OutputEntry& output : kOutputs) a.*output.member |= b.*output.member;
  return a;
}

/// Options of a Simulator.
struct SimulatorOptions {
  int num_instances = 1;    ///< N, 1 to what device memory holds.
  int num_slots = 1;        ///< Objects per instance, 1 to kMaxSlots.
  std::uint64_t seed = 0;   ///< Key of all random numbers.
  OutputOptions outputs{};  ///< Optional outputs.
  /// Capacity for contact points of one instance, 0 to kMaxContacts. Above 0 all instances take contact points (setContacts()) and no
  /// objects or loads; `outputs.penetration_depth` is then refused, because forces at points do not determine it.
  int max_contacts = 0;
  int max_regions = 0;         ///< Rows of contact features for regions, 0 to kMaxRegions; 0 without such features.
  double contact_band = 1e-4;  ///< m, 0 to 1: contact points up to this height above the undeformed skin count; the skin's thickness below.
  /// Whether reset() takes a SkinVariation. The kernels then read factors per instance. Refused with contact points and tactile Jacobians.
  bool vary_skin = false;
  /// Whether other interfaces of the device import outputs and inputs, exportOutputs() and exportInputs(). The host then gets features only
  /// where it cannot read memory of the device. Refused by drivers that export no memory.
  bool export_memory = false;
  /// Whether timing() reports seconds. Software Vulkan wakes its threads for every time stamp, about 0.2 ms per step.
  bool device_clock = false;
};

/// Deviation of one instance's readout from the sensor's nominal one.
struct ReadoutVariation {
  float gain = 1;         ///< Factor on the gain of every taxel.
  float gain_spread = 0;  ///< Standard deviation of the logarithm of a further gain per taxel, drawn once per episode.
  float noise = 0;        ///< Counts, added in quadrature to the sensor's own noise.
};

/// Declares the field of an output per taxel.
#define TAXELSIM_TAXELS(name, block, type, leading, components, unit, text) std::span<const type> name;

/// Values that no sensor could measure: before time behaviour, readout and noise. Arrays are instance-major; N = num_instances.
struct GroundTruthView : TruthFeatureView {
  TAXELSIM_TRUE_TAXELS(TAXELSIM_TAXELS)  ///< (N x leading x num_taxels x components); empty unless requested.
  ContactFeatureView contact;            ///< From tactile_normal_force; empty unless requested.
  CleanTactileJacobianView jacobian;     ///< Of the features above; empty unless requested.
};

/// One frame of the whole batch. The spans stay valid until the next step() of the same simulator.
///
/// Measured features come from `tactile_image`, converted to newtons by the nominal curve.
struct FrameView : ReadoutFeatureView {
  std::span<const std::uint32_t> tactile_image;  ///< (N x num_taxels), counts.
  TAXELSIM_MEASURED_TAXELS(TAXELSIM_TAXELS)      ///< (N x num_taxels x components), -saturation to saturation; empty unless requested.
  ContactFeatureView contact;                    ///< From `tactile_image`; empty unless requested.
  /// Of the readout of the clean forces, without noise, bias, time behaviour and rounding. The derivative of a taxel is its gain, or 0 for
  /// a taxel that is below its trigger, saturated or dead. Empty unless requested.
  TactileJacobianView jacobian;
  GroundTruthView ground_truth;  ///< Values that no sensor could measure.
};

#undef TAXELSIM_TAXELS

/// Gradient of a loss, Simulator::vjp(). Arrays are instance-major; N = num_instances.
struct GradientView {
  /// (N x 6), per m and per rad: by a small twist of the sensor, v of the origin of S, then w, in S, while the objects stay.
  std::span<const float> twist;
  std::span<const float> gain;  ///< (N x num_taxels): by the gain of each taxel.
};

/// Device memory of a simulator, for planning.
struct MemoryPlan {
  /// Bytes per instance in a batch of the given size. A batch with one instance more may take less, if it has no room for the buffers that
  /// make slow contacts faster.
  std::uint64_t bytes_per_instance = 0;
  std::uint64_t bytes_fixed = 0;    ///< Bytes independent of the number of instances.
  std::uint64_t max_instances = 0;  ///< Most instances that fit this device's memory and buffer limits.
};

/// Times of the last frame, s, from the device's clock; NaN without such a clock or without SimulatorOptions::device_clock.
struct StepTiming {
  double contact = 0;    ///< Contact pass.
  double image = 0;      ///< Image pass, contact features and tactile Jacobian.
  double total = 0;      ///< All passes.
  int num_coherent = 0;  ///< Instances whose contact pass tested only the triangles that an earlier step found near.
};

/// Imports memory of the device into another interface: a descriptor that the callee owns, and the bytes of the memory. Returns its address
/// there.
using ImportMemory = std::function<void*(int descriptor, std::uint64_t bytes)>;

/// Inputs in the memory of another interface, which writes to them: objects, or contact points with SimulatorOptions::max_contacts.
struct ExportedInputs {
  std::span<std::int32_t> ids;           ///< (N x num_slots): indices into the model's objects, or kNoObject, the first value.
  std::span<double> poses;               ///< (N x num_slots x 7): position, m, and rotation w, x, y, z of the object in S.
  std::span<float> loads;                ///< (N): N, >= 0, or NaN, the first value, for instances that are driven by pose.
  std::span<double> positions;           ///< (N x max_contacts x 3): of contact points in S, m.
  std::span<double> normal_forces;       ///< (N x max_contacts), N.
  std::span<std::int32_t> num_contacts;  ///< (N): contact points of each instance, 0 to max_contacts; 0, the first value.
};

/// What a simulator has exchanged with its device since its construction. Kernels and constants of the model are left out.
struct DeviceTraffic {
  std::uint64_t num_submits = 0;  ///< Submissions to the device's queue (`vkQueueSubmit`): one per step() and per vjp().
  /// Bytes that the host has written to the memory of the device: poses, motions and records of instances at every step(), contact points
  /// and variations when they are set, cotangents at every vjp().
  std::uint64_t bytes_to_device = 0;
  /// Bytes of the outputs of every step() and vjp(), an array of less than 16 bytes as 16. A device whose memory the host cannot read
  /// copies them, whether the host reads them or not; software Vulkan does not.
  std::uint64_t bytes_from_device = 0;

  bool operator==(const DeviceTraffic&) const = default;  ///< Comparison of all counts.
};

/// A batch of sensor instances.
///
/// A step: setObjects() or setContacts(), step(), read(); then vjp() if wanted. Threads: one thread at a time per simulator; simulators of
/// one Model may run in different threads.
class Simulator {
 public:
  /// Allocates all device memory. Throws Error(kInput), with the largest size that fits, if the batch does not fit.
  Simulator(const Model& model, const SimulatorOptions& options);
  ~Simulator();
  Simulator(Simulator&&) noexcept;             ///< Moves the batch.
  Simulator& operator=(Simulator&&) noexcept;  ///< Moves the batch.

  /// Device memory that Simulator(model, options) would take. Allocates nothing.
  static MemoryPlan plan(const Model& model, const SimulatorOptions& options);

  int numInstances() const;    ///< N.
  const Model& model() const;  ///< The model.

  /// Objects that each instance touches from the next step() on.
  ///
  /// `ids` (N x num_slots): indices into the model's objects, or kNoObject. `X_SO` (N x num_slots): poses in S, ignored for empty slots.
  /// An object whose bounding box is wholly deeper than the skin of a sensor of one patch is behind it and presses on nothing.
  /// On a skin with friction, an object that stays in its slot has slid or rolled from its last pose; call reset() after a jump. Throws
  /// Error(kInput) for a wrong length, an unknown id, a pose that is not finite, a quaternion whose length is not 1 within 1e-3, or if
  /// max_contacts is not 0. Must not be called between step() and read().
  void setObjects(std::span<const int> ids, std::span<const Pose> X_SO);
  /// The same for one instance: `ids` and `X_SO` (num_slots).
  void setObjects(int instance, std::span<const int> ids, std::span<const Pose> X_SO);

  /// Force with which the objects of each instance must press along -z of S, (N), N; kPoseDriven leaves their poses unchanged.
  ///
  /// The device moves all objects of the instance together along z of S to where the taxels' normal forces, summed as vectors along the
  /// undeformed normals, have that component, between first touch and a deepest sample at the skin's thickness; friction takes no part. On
  /// a curved skin total_force, the plain sum over the taxels, is larger. Throws Error(kInput) for a wrong length, a negative or infinite
  /// load, or if max_contacts is not 0.
  void setLoads(std::span<const float> loads);
  /// The same for one instance.
  void setLoad(int instance, float load);

  /// Contact points of every instance, until they are set again.
  ///
  /// Those of instance i are contacts[offsets[i]] to contacts[offsets[i + 1] - 1]; `offsets` (N + 1) ascends from 0 to the number of
  /// contacts. Forces are summed in the given order. Throws Error(kInput) and changes nothing for other offsets, more than max_contacts of
  /// an instance, a position or force that is not finite or out of range (contact_point.h), or if max_contacts is 0. Must not be called
  /// between step() and read().
  void setContacts(std::span<const ContactPoint> contacts, std::span<const int> offsets);
  /// The same for one instance.
  void setContacts(int instance, std::span<const ContactPoint> contacts);

  /// Starts an episode of one instance: clears its clock, the skin's state and the held frame. `episode` keys its noise.
  ///
  /// Throws Error(kInput) and changes nothing for variations out of range, and for a `skin` other than the default without
  /// SimulatorOptions::vary_skin.
  void reset(int instance, std::uint64_t episode, const ReadoutVariation& variation = {}, const SkinVariation& skin = {});

  /// Compiles all kernels that steps need, so that no step waits for the driver. `loads`: also those of load-driven instances.
  ///
  /// With OutputOptions::vjp also that of vjp(). Call after reset(), because random gains and noise need further kernels. Without this call
  /// a step compiles what it needs, and so does a step of some instances: with meshes one kernel more. Waits. Throws Error(kDevice) if the
  /// driver refuses.
  void prepare(bool loads = false);

  /// Advances every instance by `dt` (s, > 0) and computes its frame. Submits, does not wait.
  ///
  /// An instance whose sensor has no new frame due keeps its measured values; ground truth is always new. Throws std::logic_error if the
  /// last step has not been read.
  void step(double dt);
  /// Computes the first frame of new episodes while all other instances hold.
  ///
  /// `instances` (N): not 0 for the instances that are computed. The frame, outputs, state and clock of all others stay as they are, bit
  /// for bit, and their next step(dt) continues as if this one had not happened; objects, loads and contacts that were set for them wait
  /// for it. Computed instances get the frame that a step of all instances would give. With no instance selected nothing happens. Submits,
  /// does not wait. Throws Error(kInput) for a wrong length, std::logic_error if the last step has not been read or if a selected instance
  /// has taken a step since its last reset(); nothing changes then.
  void step(double dt, std::span<const std::uint8_t> instances);

  /// Waits for the last step() and returns its frame. Throws Error(kDevice) if the device was lost.
  FrameView read();

  /// Pulls the gradient of a loss by the forces of taxels back to the sensor's pose and to the gains (vector-Jacobian product).
  ///
  /// The forces are gain x tactile_normal_force of the last frame that was read (GroundTruthView, also where it is not an output).
  /// `cotangent` (N x num_taxels): the loss's gradient by them, per N. `gain` (N x num_taxels): of each taxel; empty: 1. By twist the
  /// result is the sum over taxels of cotangent x gain x the row of GroundTruthView::taxel_jacobian, by gain cotangent x
  /// tactile_normal_force. Forces are smooth in the pose with DepthSampling::kArea.
  ///
  /// Submits a dispatch over the derivatives that lie on the device, and waits. Frames, states and clocks stay as they are. The spans stay
  /// valid until the next vjp() of the same simulator. Sums are in float32 in a fixed order: the batch changes no bit. Throws Error(kInput)
  /// without OutputOptions::vjp, for a wrong length, and for a number or a product of cotangent and gain that is not finite; Error(kDevice)
  /// if the device was lost; std::logic_error between step() and read(), and before the first frame.
  GradientView vjp(std::span<const float> cotangent, std::span<const float> gain = {});

  /// The frame in the memory of another interface, such as CUDA: exports each array of outputs once and gives it to `import`.
  ///
  /// The spans hold addresses of that interface, which the host must not read. They stay the same and show each frame that has ended; the
  /// imported memory must be released before the simulator. Integers and flags are arrays of the device too. Call it once, before the first
  /// step(). Throws std::logic_error without SimulatorOptions::export_memory, Error(kDevice) if the driver refuses, and what `import`
  /// throws.
  FrameView exportOutputs(const ImportMemory& import);
  /// Inputs that every step() takes from now on, as they are when the device begins it, in place of setObjects() and setLoads(), which
  /// throw.
  ///
  /// Loads need prepare(true) before. A step whose inputs are not allowed computes its instance without object, and the call that waits for
  /// it throws Error(kInput), which names the instance. As exportOutputs(); throws Error(kInput) for contact points, and Error(kDevice)
  /// where the device lacks numbers of 64 bits.
  ExportedInputs exportInputs(const ImportMemory& import);
  /// A descriptor of the timeline semaphore that orders steps and consumers, which the caller owns; -1 if the driver exports none.
  ///
  /// With export_memory a step() may follow another without read(). It waits on the host until the one before has ended; after
  /// exportInputs() until the one before that has.
  int exportTimeline() const;
  /// Value of the timeline at the end of the last step(), an even number.
  std::uint64_t endOfStep() const;
  /// The next step() begins on the device when the timeline has reached endOfStep() + 1, which a consumer of the last frame signals.
  void beginAfterConsumer();

  StepTiming timing() const;      ///< Times of the last frame read.
  DeviceTraffic traffic() const;  ///< Counts since construction. A step() counts at once, before its read().

  /// @cond
  struct Impl;
  /// @endcond

 private:
  friend struct SimulatorAccess;
  explicit Simulator(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace taxelsim
