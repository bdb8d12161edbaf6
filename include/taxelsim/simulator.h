/// @file
/// A batch of sensor instances over one Model: poses or contact points in, tactile images and features out.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>

#include "taxelsim/contact_point.h"
#include "taxelsim/contact_type.h"
#include "taxelsim/model.h"
#include "taxelsim/pose.h"
#include "taxelsim/skin_variation.h"

namespace taxelsim {

inline constexpr int kMaxSlots = 8;        ///< Most objects that one instance can touch at a time.
inline constexpr int kNoObject = -1;       ///< Id of an empty slot.
inline constexpr int kMaxContacts = 4096;  ///< Most contact points of one instance.
inline constexpr int kMaxRegions = 8;      ///< Most contact regions with features of their own.
/// Load of an instance that is driven by its pose.
inline constexpr float kPoseDriven = std::numeric_limits<float>::quiet_NaN();

/// Optional outputs. Features and FrameView::tactile_image are always computed.
struct OutputOptions {
  bool tactile_normal_force = true;     ///< GroundTruthView::tactile_normal_force.
  bool tactile_shear_force = true;      ///< GroundTruthView::tactile_shear_force.
  bool penetration_depth = true;        ///< GroundTruthView::penetration_depth.
  bool taxel_counts = false;            ///< FrameView::taxel_counts; one more device pass. Needs Readout::three_axis.
  bool contact_features = false;        ///< FrameView::contact; two more device passes.
  bool clean_contact_features = false;  ///< GroundTruthView::contact; two more device passes.
  /// FrameView::jacobian.
  ///
  /// Cost of this one and the next together: two device passes each; four under DeformationMask; one and six more solves under
  /// ElasticLayer. Refused for contact points.
  bool tactile_jacobian = false;
  bool clean_tactile_jacobian = false;  ///< GroundTruthView::jacobian.
  bool taxel_jacobian = false;          ///< GroundTruthView::taxel_jacobian; one device pass, and one that the others share.
  bool vjp = false;                     ///< Simulator::vjp(); only the pass that the others share. No Jacobian is read back.
};

/// No optional outputs.
inline constexpr OutputOptions kNoOutputs{.tactile_normal_force = false, .tactile_shear_force = false, .penetration_depth = false};

/// A member of OutputOptions.
struct OutputEntry {
  const char* name;             ///< Its name.
  bool OutputOptions::*member;  ///< The member.
  const char* where;            ///< Where a caller finds the output, in Python's words.
  bool is_derivative = false;   ///< Needs the derivatives of forces by a twist of the sensor.
};

/// All members of OutputOptions. A new output is a member and a line here.
inline constexpr std::array<OutputEntry, 10> kOutputs{{
    {"tactile_normal_force", &OutputOptions::tactile_normal_force, "frame.ground_truth.tactile_normal_force"},
    {"tactile_shear_force", &OutputOptions::tactile_shear_force, "frame.ground_truth.tactile_shear_force"},
    {"penetration_depth", &OutputOptions::penetration_depth, "frame.ground_truth.penetration_depth"},
    {"taxel_counts", &OutputOptions::taxel_counts, "frame.taxel_counts"},
    {"contact_features", &OutputOptions::contact_features, "frame.contact"},
    {"clean_contact_features", &OutputOptions::clean_contact_features, "frame.ground_truth.contact"},
    {"tactile_jacobian", &OutputOptions::tactile_jacobian, "frame.jacobian", true},
    {"clean_tactile_jacobian", &OutputOptions::clean_tactile_jacobian, "frame.ground_truth.jacobian", true},
    {"taxel_jacobian", &OutputOptions::taxel_jacobian, "frame.ground_truth.taxel_jacobian", true},
    {"vjp", &OutputOptions::vjp, "Simulator.vjp()", true},
}};
static_assert(kOutputs.size() == sizeof(OutputOptions), "every output is a bool with a line in the table");

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
  /// Whether timing() reports seconds. Software Vulkan wakes its threads for every time stamp, about 0.2 ms per step.
  bool device_clock = false;
};

/// Deviation of one instance's readout from the sensor's nominal one.
struct ReadoutVariation {
  float gain = 1;         ///< Factor on the gain of every taxel.
  float gain_spread = 0;  ///< Standard deviation of the logarithm of a further gain per taxel, drawn once per episode.
  float noise = 0;        ///< Counts, added in quadrature to the sensor's own noise.
};

/// Moments of an image of forces. All arrays are instance-major; N = num_instances. Frames: S sensor, P patch.
struct FeatureView {
  std::span<const float> total_force;         ///< (N), N.
  std::span<const float> peak_force;          ///< (N), N: largest taxel.
  std::span<const float> center_of_pressure;  ///< (N x 3), m, in S; 0 without contact.
  /// (N x 3), m^2: xx, xy, yy about the centre of pressure, in P; in the xy plane of S for several patches.
  std::span<const float> second_moments;
  std::span<const float> eigenvalues;      ///< (N x 2), m^2, larger first.
  std::span<const float> edge_angle;       ///< (N), rad in (-pi/2, pi/2]: 1/2 atan2(2 xy, xx - yy), paper eq. (3); 0 where undefined.
  std::span<const float> edge_confidence;  ///< (N), 0 to 1: (l1 - l2) / (l1 + l2).
  std::span<const float> contact_area;     ///< (N), m^2: area of the taxels above the trigger.
};

/// Features of contacts on parts of a sensor. In the arrays of FeatureView, N stands for num_instances x num_rows here.
///
/// Rows of an instance: the sensor; each patch (none for a list of taxels); then the regions with the largest total force. A region is a
/// set of connected taxels that read more than 0, or for clean forces more than their trigger. On a grid patch a taxel is connected with
/// its eight neighbours; on a list with those within 1.5 times the mean size of the two along the skin. Regions do not cross patches. Of
/// two regions with equal force, the one with the lowest taxel comes first.
///
/// Rows without a region are 0; their `patch` is 0 for a sensor of one patch, else -1. Moments and angles are in the plane of `patch`. A
/// region of a list lies in the plane of its taxel with the largest force, onto which the other taxels are projected.
struct ContactFeatureView : FeatureView {
  int num_rows = 0;     ///< 1 + num_patches + max_regions; 0 unless requested.
  int num_patches = 0;  ///< Rows of patches.
  /// (N), rad in (-pi/2, pi/2]; 0 where undefined: angle of an edge that the array cuts off.
  ///
  /// Principal axis of the forces under a Gaussian window with a standard deviation of 1.15 times the larger pitch. Four iterations move
  /// the window to the centre of the forces under it. 0 if less than a thousandth of the force is under it.
  std::span<const float> windowed_edge_angle;
  std::span<const float> windowed_edge_confidence;  ///< (N), 0 to 1.
  /// (N), rad in (-pi/2, pi/2]; 0 where undefined: angle of an edge from taxels whose gains differ.
  ///
  /// Ridge of a Gaussian that is fitted to the forces on a logarithmic scale, so that a taxel counts by its relative error. A border
  /// of the array does not bias the angle. Forces are divided by Readout::calibrated_gain, which halves the error of scattered gains.
  std::span<const float> ridge_edge_angle;
  std::span<const float> ridge_edge_confidence;  ///< (N), 0 to 1: curvatures of the logarithm across and along the ridge.
  /// (N x 2), rad: rotation of a flat face against `patch`, about its x and y, right-handed.
  ///
  /// A face rotated by a > 0 about x presses less at +y; one rotated by b > 0 about y presses more at +x. From the slope of the pressure
  /// over the core, divided by the stiffness of foundationOf(skin) at the core's mean pressure. The core are the taxels inside patch and
  /// contact whose force the point spread does not change; saturated taxels are left out. Undefined for curved objects. 0 with confidence 0
  /// for a core of fewer than four taxels or of taxels on a line, in the plane of S, and on lists.
  std::span<const float> tilt;
  std::span<const float> tilt_confidence;     ///< (N), 0 to 1: 1 - RMS residual of a plane through the core's forces over their mean.
  std::span<const ContactType> contact_type;  ///< (N).
  std::span<const std::int32_t> patch;        ///< (N), patch, or taxel of a list, whose plane the moments are in; -1: xy plane of S.
  std::span<const std::int32_t> num_regions;  ///< (num_instances): all regions, of which the largest have rows; 0 if max_regions is 0.
};

/// Derivatives of features by a small twist of the sensor while the objects stay. N stands for num_instances x num_rows.
///
/// Six columns: velocity v of the origin of S along x, y, z of S (per m), then angular velocity w about x, y, z of S (per rad). For a twist
/// of the objects with the sensor at rest the sign is opposite: a sensor that moves along +x has d center_of_pressure x / d v_x = -1. Rows
/// of an instance: the sensor, then its patches (none for a list of taxels), as in ContactFeatureView. Undefined values are 0, never NaN:
/// all without contact, the row of an edge angle with confidence 0.
///
/// Computed from the samples of this frame by the force balance of each taxel (Reynolds' transport theorem; shaders/skin/cell_fluxes.glsl):
/// a sideways motion transports force through the taxel's sides, a vertical motion changes it by the law's stiffness. They are therefore
/// derivatives of the features of this array, not of a continuous skin. Assumptions: MassSpringDamper is at rest; a skin that relaxes keeps
/// its present stiffness at every sample; friction has no part; ElasticLayer responds by its own equations over the samples in contact, and
/// if it relaxes, with its instantaneous stiffness. For a load-driven instance, the derivatives are at the pose that the load search found,
/// and that pose stays.
struct TactileJacobianView {
  int num_rows = 0;                           ///< 1 + num_patches; 0 unless requested.
  int num_patches = 0;                        ///< Rows of patches.
  std::span<const float> center_of_pressure;  ///< (N x 3 x 6), m/m and m/rad, in S.
  std::span<const float> total_force;         ///< (N x 6), N/m and N/rad.
  std::span<const float> edge_angle;          ///< (N x 6), rad/m and rad/rad.
};

/// The same from clean forces, and the Jacobian of the contact wrench.
struct CleanTactileJacobianView : TactileJacobianView {
  std::span<const float> contact_wrench;  ///< (num_instances x 6 x 6), N/m, N/rad, then N m/m, N m/rad; of the normal forces.
};

/// Values that no sensor could measure: before time behaviour, readout and noise.
struct GroundTruthView : FeatureView {
  std::span<const float> tactile_normal_force;  ///< (N x num_taxels), N, after the PSF; empty unless requested.
  std::span<const float>
      tactile_shear_force;  ///< (N x num_taxels x 2), N, along x and y of the taxel, on the skin; empty unless requested.
  /// (N x 6 x num_taxels), N/m and N/rad: derivatives of tactile_normal_force by the sensor's twist, as TactileJacobianView says; empty
  /// unless requested. The product of a gradient by forces with it is the gradient by the pose.
  std::span<const float> taxel_jacobian;
  std::span<const float> penetration_depth;  ///< (N x num_taxels), m, mean over the taxel's samples; empty unless requested.
  std::span<const float> contact_wrench;     ///< (N x 6): force (N) and torque (N m) on the sensor at its origin, in S, before the PSF.
  std::span<const float> over_penetration;   ///< (N), fraction of samples at least as deep as the skin is thick; 0 for contact points.
  std::span<const float> load_offset;        ///< (N), m: displacement of the objects along z by the load search; 0 when pose-driven.
  std::span<const bool> load_reached;        ///< (N), true when pose-driven or when the load is carried.
  /// (N), N. Contact points: normal force of those that lie on no taxel; it is in no other output, contact_wrench included, because a force
  /// without a patch has no direction. Objects: force on the margin of an ElasticLayer, part of contact_wrench; 0 for other laws.
  std::span<const float> off_array_load;
  std::span<const std::int32_t> off_array_contacts;  ///< (N): contact points that lie on no taxel.
  /// (N), >= 0: RMS error of the surface displacement over the samples in contact, relative to the largest depth. Empty unless the law is
  /// ElasticLayer.
  std::span<const float> contact_residual;
  std::span<const std::int32_t> contact_iterations;  ///< (N), iterations of the contact solver. Empty unless the law is ElasticLayer.
  ContactFeatureView contact;                        ///< From tactile_normal_force; empty unless requested.
  CleanTactileJacobianView jacobian;                 ///< Of the features above; empty unless requested.
};

/// One frame of the whole batch. The spans stay valid until the next step() of the same simulator.
///
/// Measured features come from `tactile_image`, converted to newtons by the nominal curve.
struct FrameView : FeatureView {
  std::span<const std::uint32_t> tactile_image;  ///< (N x num_taxels), counts.
  std::span<const float> saturated;              ///< (N), fraction of taxels at the upper end of their range.
  /// (N x num_taxels x 3), counts of three-axis taxels along x, y and the normal of each, -saturation to saturation (ThreeAxisReadout).
  /// Shear has the sign of tactile_shear_force, a press is positive. Empty unless requested.
  std::span<const std::int32_t> taxel_counts;
  ContactFeatureView contact;  ///< From `tactile_image`; empty unless requested.
  /// Of the readout of the clean forces, without noise, bias, time behaviour and rounding. The derivative of a taxel is its gain, or 0 for
  /// a taxel that is below its trigger, saturated or dead. Empty unless requested.
  TactileJacobianView jacobian;
  GroundTruthView ground_truth;  ///< Values that no sensor could measure.
};

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
