// A batch of sensor instances over one Model: poses or contact points in, tactile images and features out.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <span>

#include "taxelsim/contact_point.h"
#include "taxelsim/contact_type.h"
#include "taxelsim/model.h"
#include "taxelsim/pose.h"

namespace taxelsim {

inline constexpr int kMaxSlots = 8;        // objects that one instance can touch
inline constexpr int kNoObject = -1;       // id of an empty slot
inline constexpr int kMaxContacts = 4096;  // that one instance can be given
inline constexpr int kMaxRegions = 8;      // that have features of their own
// Load of an instance that is driven by its pose.
inline constexpr float kPoseDriven = std::numeric_limits<float>::quiet_NaN();

// What comes back beside features and `tactile_image`, which always do.
struct OutputOptions {
  bool tactile_normal_force = true;
  bool tactile_shear_force = true;
  bool penetration_depth = true;
  bool contact_features = false;        // FrameView::contact, two more passes of the device
  bool clean_contact_features = false;  // GroundTruthView::contact, as many
  // FrameView::jacobian and GroundTruthView::jacobian: two more passes for either, four under DeformationMask; under ElasticLayer one, and
  // six more solves. Refused where contacts come from outside.
  bool tactile_jacobian = false;
  bool clean_tactile_jacobian = false;
};

struct SimulatorOptions {
  int num_instances = 1;   // 1 to what memory holds
  int num_slots = 1;       // objects per instance, 1 to 8
  std::uint64_t seed = 0;  // key of all noise
  OutputOptions outputs{};
  // Contact points that one instance may be given, 0 to kMaxContacts. Above 0, all instances take contacts (setContacts()) and none takes
  // objects or a load. `outputs.penetration_depth` is then refused: forces at points tell nothing about it, and zeros would be made up.
  int max_contacts = 0;
  int max_regions = 0;         // rows of contact features for connected taxels, 0 to 8; 0 where no such features are asked for
  double contact_band = 1e-4;  // m, 0 to 1: how far over the undeformed skin a contact still counts; below, it is the skin's thickness
  // Whether timing() tells seconds. Software Vulkan wakes its threads for every time stamp, some 0.2 ms a step.
  bool device_clock = false;
};

// How one instance's readout differs from the sensor's nominal one.
struct ReadoutVariation {
  float gain = 1;         // multiplies every taxel's gain
  float gain_spread = 0;  // standard deviation of the logarithm of a further gain per taxel, drawn once per episode
  float noise = 0;        // counts, added in quadrature to the sensor's own noise
};

// Moments of an image of forces. All arrays are instance-major; N = num_instances.
struct FeatureView {
  std::span<const float> total_force;         // (N), N
  std::span<const float> peak_force;          // (N), N: largest taxel
  std::span<const float> center_of_pressure;  // (N x 3), m, in S; 0 without contact
  std::span<const float> second_moments;      // (N x 3), m^2: xx, xy, yy about the centre of pressure, in the patch plane (of
                                              // several patches: the xy plane of S)
  std::span<const float> eigenvalues;         // (N x 2), m^2, larger first
  std::span<const float> edge_angle;          // (N), rad in (-pi/2, pi/2]: 1/2 atan2(2 xy, xx - yy), paper eq. (3); 0 where undefined
  std::span<const float> edge_confidence;     // (N), 0 to 1: (l1 - l2) / (l1 + l2)
  std::span<const float> contact_area;        // (N), m^2: taxels above the trigger times their area
};

// Features of what is in contact, of parts of a sensor. Rows of an instance: the sensor; each of its patches (of a list of taxels none);
// then the largest regions by total force. A region is a set of connected taxels that report anything, or carry more than their trigger
// where forces are clean: on a grid patch each taxel is connected with the eight around it, on a list with those no farther along the skin
// than 1.5 times the mean size of the two; not across patches. Of two regions with one force the one with the lowest taxel is first. Rows
// without a region are 0, `patch` too where there is but one, else -1. Moments are taken in the plane of `patch`, as are its angles. A
// region of a list lies in the plane of its taxel with the largest force, taxels beside it projected. In FeatureView's shapes N stands for
// num_instances x num_rows here.
struct ContactFeatureView : FeatureView {
  int num_rows = 0;     // 1 + num_patches + max_regions; 0 unless asked for
  int num_patches = 0;  // rows of patches
  // The angle of an edge that the array cuts off: axes of the forces under a Gaussian window, whose standard deviation is 1.15 times the
  // larger pitch, around a middle that four rounds move to the centre of the forces under it. 0 where less than a thousandth of the force
  // is under it.
  std::span<const float> windowed_edge_angle;       // (N), rad in (-pi/2, pi/2]; 0 where undefined
  std::span<const float> windowed_edge_confidence;  // (N), 0 to 1
  // How a flat face is turned against the patch, about x and y of `patch`, right-handed: a face turned by a about x presses less at +y
  // where a > 0, one turned by b about y more at +x where b > 0. From the pressure's slope over the core, the taxels inside patch and
  // contact that the spread gives as much as it takes from them, over the stiffness of foundationOf(skin) at their mean pressure. Saturated
  // taxels are left out. Curved objects have none. 0 with confidence 0 where the core has fewer than four taxels or these on a line, and in
  // the plane of S and on lists.
  std::span<const float> tilt;             // (N x 2), rad
  std::span<const float> tilt_confidence;  // (N), 0 to 1: 1 - what a plane misses of the core's forces, root mean square, over their mean
  std::span<const float> contact_type;     // (N), a ContactType as a number
  std::span<const float> patch;        // (N), number of the patch (of a list: the taxel) in whose plane moments are; -1: the xy plane of S
  std::span<const float> num_regions;  // (num_instances): regions that there are, of which the largest have rows; 0 if max_regions is
};

// How features change as the sensor moves by a small twist and the objects stay: 6 columns, by the velocity v (per m) along x, y, z of S of
// S's origin and by the angular velocity w (per rad) about x, y, z of S. By the same twist of the objects, with the sensor at rest, it is
// minus that: a sensor that moves along +x has d center_of_pressure x / d v_x = -1. Rows of an instance: the sensor, then each of its
// patches (of a list of taxels none), as in ContactFeatureView; N stands for num_instances x num_rows. What is undefined is 0: without
// contact all, of an edge angle whose confidence is 0 its row; never NaN.
//
// From the samples of this frame by the balance of force over each taxel (Reynolds' transport theorem; shaders/skin/cell_fluxes.glsl): what
// moves sideways flows through the taxel's sides, what moves up or down gives by the law's stiffness. So they are derivatives of the
// feature over this array: where a wall passes a taxel they are those of that taxel, not of an array without taxels. They hold for a sensor
// at rest: a taxel of MassSpringDamper gives the force of contact at once; of a skin that relaxes every sample keeps its present share of
// its stiffness, as it does under motions slower than relaxation; friction has no part in them. An ElasticLayer answers by its own
// equations over the samples in contact, one that relaxes at once. Of an instance that is driven by its load they are at the pose where the
// load put the objects, which then stay.
struct TactileJacobianView {
  int num_rows = 0;                           // 1 + num_patches; 0 unless asked for
  int num_patches = 0;                        // rows of patches
  std::span<const float> center_of_pressure;  // (N x 3 x 6), m/m and m/rad, in S
  std::span<const float> total_force;         // (N x 6), N/m and N/rad
  std::span<const float> edge_angle;          // (N x 6), rad/m and rad/rad
};

// The same from the clean forces, and of the wrench.
struct CleanTactileJacobianView : TactileJacobianView {
  std::span<const float> contact_wrench;  // (num_instances x 6 x 6), N/m, N/rad, then N m/m, N m/rad; of the normal forces
};

// Values nobody could measure: before time, readout and noise.
struct GroundTruthView : FeatureView {
  std::span<const float> tactile_normal_force;  // (N x num_taxels), N, after the PSF; empty unless asked for
  std::span<const float> tactile_shear_force;   // (N x num_taxels x 2), N, on the skin, along x and y of the taxel; empty unless asked for
  std::span<const float> penetration_depth;     // (N x num_taxels), m, mean over the taxel's samples; empty unless asked for
  std::span<const float> contact_wrench;        // (N x 6): force (N) and torque (N m) on the sensor at its origin, in S, before the PSF
  std::span<const float> over_penetration;      // (N), fraction of samples at least as deep as the skin is thick; of contacts 0
  std::span<const float> load_offset;           // (N), m: by how much the load search moved the objects along z; 0 when pose-driven
  std::span<const float> load_reached;          // (N), 1 when pose-driven or the load is carried, 0 when it is out of reach
  // Contacts: the normal forces of those that lie on no taxel, in no other output, contact_wrench included: a force without a patch has no
  // direction. Objects: what the margin of an elastic layer carries, contact_wrench included; 0 of other laws.
  std::span<const float> off_array_load;      // (N), N
  std::span<const float> off_array_contacts;  // (N): how many contacts lie on no taxel
  // Of the law ElasticLayer, else empty.
  std::span<const float> contact_residual;    // (N), >= 0: root mean square, over the samples in contact, of what the displacements miss,
                                              // relative to the deepest one
  std::span<const float> contact_iterations;  // (N), of the solver
  ContactFeatureView contact;                 // from tactile_normal_force; empty unless asked for
  CleanTactileJacobianView jacobian;          // of the features above; empty unless asked for
};

// One frame of the whole batch. Measured features come from `tactile_image`, turned back into newtons by the nominal curve. The spans stay
// valid until the next step() of the same simulator.
struct FrameView : FeatureView {
  std::span<const std::uint32_t> tactile_image;  // (N x num_taxels), counts
  std::span<const float> saturated;              // (N), fraction of taxels at the upper end
  ContactFeatureView contact;                    // empty unless asked for
  // Of what the readout makes of the clean forces before noise, bias, time and rounding: a taxel below its trigger, saturated or dead has
  // no derivative, any other its gain. Empty unless asked for.
  TactileJacobianView jacobian;
  GroundTruthView ground_truth;
};

// Bytes that a simulator takes on the device, for planning.
struct MemoryPlan {
  std::uint64_t bytes_per_instance = 0;  // of a batch of as many instances as were asked for; where one of more has no room for what makes
                                         // slow contacts faster, it takes less
  std::uint64_t bytes_fixed = 0;
  std::uint64_t max_instances = 0;  // that fit into this device's memory and buffer limits
};

// Of the last frame. Seconds from the device's own clock; NaN where it has none, or was not asked for (SimulatorOptions::device_clock).
struct StepTiming {
  double contact = 0;
  double image = 0;  // with the contact features and the tactile Jacobian
  double total = 0;
  // Instances that moved so little since a step before that only those triangles were looked at which had been near then.
  int num_coherent = 0;
};

class Simulator {
 public:
  // Allocates all device memory. Throws Error(kInput), with the largest size that fits, when the batch does not.
  Simulator(const Model& model, const SimulatorOptions& options);
  ~Simulator();
  Simulator(Simulator&&) noexcept;
  Simulator& operator=(Simulator&&) noexcept;

  static MemoryPlan plan(const Model& model, const SimulatorOptions& options);

  int numInstances() const;
  const Model& model() const;

  // What each instance touches, for the next step(): ids (N x num_slots), indices into the model's objects or kNoObject; poses X_SO
  // (N x num_slots), ignored for empty slots. Throws Error(kInput) for a wrong length, an unknown id, or a pose that is not
  // finite or whose quaternion is not of unit length within 1e-3, or when max_contacts is not 0. Must not be called between step() and
  // read().
  // To a skin with friction an object that stays in its slot has slid or rolled there since the step before; after a jump, reset().
  void setObjects(std::span<const int> ids, std::span<const Pose> X_SO);

  // One instance of the same.
  void setObjects(int instance, std::span<const int> ids, std::span<const Pose> X_SO);

  // Normal force that each instance's objects must carry, (N), N: the sum over all taxels, whatever way they look, so that its part along z
  // of S is smaller on a skin that slopes; kPoseDriven leaves their poses alone. The device then moves all objects of the instance together
  // along z of S to where they rest with that force on the skin, between first touch and the deepest sample at the skin's thickness. Throws
  // Error(kInput) for a wrong length, a negative or infinite load, or when max_contacts is not 0.
  void setLoads(std::span<const float> loads);
  void setLoad(int instance, float load);

  // The contacts of every instance for the next step(), until they are set again: those of instance i are contacts[offsets[i]] to
  // contacts[offsets[i + 1] - 1]; `offsets` (N + 1) rises from 0 to the number of contacts. Forces are added in the order given. Throws
  // Error(kInput), and changes nothing, for offsets that do not, more than max_contacts of an instance, a position or force that is
  // not finite or out of range (contact_point.h), or when max_contacts is 0. Must not be called between step() and read().
  void setContacts(std::span<const ContactPoint> contacts, std::span<const int> offsets);

  // One instance of the same.
  void setContacts(int instance, std::span<const ContactPoint> contacts);

  // Puts one instance at the start of an episode: clock at 0, state of the skin and held frame gone; `episode` keys its noise.
  void reset(int instance, std::uint64_t episode, const ReadoutVariation& variation = {});

  // Has the driver compile all that steps will need, so that none of them waits for it: with `loads`, also those in which some instance is
  // driven by load. Called after reset(), as noise and gains that are drawn need more. Without it a step compiles what is wanted first
  // there. Waits. Throws Error(kDevice) when the driver refuses.
  void prepare(bool loads = false);

  // Advances every instance by dt (s, > 0) and computes its frame. Submits, does not wait. An instance whose sensor has no new frame due
  // keeps its measured values; ground truth is always new. Throws std::logic_error before read() of the last one.
  void step(double dt);

  // Waits for the last step(). Throws Error(kDevice) when the device was lost.
  FrameView read();

  // Of the last frame read.
  StepTiming timing() const;

  struct Impl;

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace taxelsim
