/// @file
/// A tactile sensor model: taxels on patches, the skin above them, the electronics that read them. The state of a sensor belongs to the
/// Simulator.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "taxelsim/pose.h"
#include "taxelsim/three_axis_readout.h"

namespace taxelsim {

/// @name Limits
/// Largest values unless stated otherwise.
/// @{
inline constexpr int kMaxSamplesPerTaxel = 16;           ///< Sensor::samples_per_taxel.
inline constexpr int kMaxTaxelsPerSide = 128;            ///< Rows or columns of a grid patch.
inline constexpr int kMaxTaxels = 1 << 18;               ///< Taxels of all patches of a sensor.
inline constexpr int kMaxKernelSize = 9;                 ///< Psf::size.
inline constexpr int kMaxSpreadTaxels = 128;             ///< Taxels that one taxel reaches by distance along the skin.
inline constexpr int kMaxCurveDegree = 5;                ///< Terms of Readout::curve.
inline constexpr int kMaxCurvePoints = 16;               ///< Points of Readout::curve_points.
inline constexpr int kMaxAdcBits = 16;                   ///< Readout::adc_bits.
inline constexpr int kMaxHysteresisElements = 4;         ///< Elements of Readout::hysteresis_strength.
inline constexpr int kMaxCreepTerms = 4;                 ///< Terms of Readout::creep.
inline constexpr int kMaxRelaxationTerms = 4;            ///< Terms of Skin::relaxation.
inline constexpr int kMaxDelaySteps = 32;                ///< Simulation steps within Readout::delay.
inline constexpr double kMaxCreepFraction = 1e6;         ///< CreepTerm::fraction.
inline constexpr double kMaxOffsetCounts = 1e9;          ///< Readout::bias and Readout::random_walk.
inline constexpr double kMaxGainSpread = 2;              ///< Readout::gain_spread and Readout::press_gain_spread.
inline constexpr double kMaxFrictionCoefficient = 1000;  ///< Every friction coefficient.
inline constexpr double kMinLuGreFriction = 1e-9;        ///< Smallest friction coefficient of LuGre.
inline constexpr double kMaxBristle = 1e12;              ///< Stiffness, damping and viscous friction of LuGre.
inline constexpr double kMaxTangentialStiffness = 1e30;  ///< N/m^3, bounded by float32 on the device, with room for a displacement.
inline constexpr int kMaxLayerNodes = 65536;             ///< Nodes of an elastic layer: samples of its patch and margin.
inline constexpr int kMaxLayerIterations = 1000;         ///< ElasticLayer::iterations.
inline constexpr double kMaxLayerThickness = 0.1;  ///< m, Skin::thickness under ElasticLayer: heights count from the base, in float32.
inline constexpr double kMaxPressureError = 4e3;   ///< Pa, maxDepthErrorOf(): 0.046 N on a taxel of 3.4 mm.
/// @}

/// A planar grid of taxels.
///
/// Its frame P lies in the middle of the grid on the undeformed outer skin surface, z out of the skin towards the object; row i runs along
/// x, column j along y. Taxel (i, j) has index first_taxel_of_the_patch + i num_cols + j and its centre in P at
///
///     ((i - (num_rows - 1) / 2) pitch[0], (j - (num_cols - 1) / 2) pitch[1], 0)
struct GridPatch {
  std::string name;                   ///< Name in messages and data sets.
  int num_rows = 1;                   ///< 1 to kMaxTaxelsPerSide.
  int num_cols = 1;                   ///< 1 to kMaxTaxelsPerSide.
  std::array<double, 2> pitch{0, 0};  ///< m, > 0, along x and along y.
  Pose X_SP;                          ///< Pose of the patch in the sensor frame.
};

/// A 1 x 1 patch for one taxel of a curved or irregular skin.
///
/// The taxel is the rectangle of `size` (m, > 0, along x and y of P) in the plane tangent to the skin at `position` (m, in S), with the
/// outward `normal` (in S, of any length but 0). x of P is `x_axis` (in S, not along the normal) projected into that plane; without it, x
/// of S after the shortest rotation that takes z of S to the normal. Throws Error(kInput) for a direction that is 0, not finite, or along
/// the normal.
GridPatch taxelPatch(std::string name, const Vector3& position, const Vector3& normal, const std::array<double, 2>& size,
                     const std::optional<Vector3>& x_axis = {});

/// Contact law: elastic foundation, the paper's penalty contact per area, so that forces do not depend on the number of samples.
///
/// Where the penetration d > 0: pressure = max(0, normal_contact_stiffness d^normal_exponent + normal_damping d').
struct Winkler {
  double normal_contact_stiffness = 0;  ///< Pa / m^normal_exponent (N/m^3 for exponent 1), > 0.
  double normal_exponent = 1;           ///< 1 to 3. Default 1.
  double normal_damping = 0;            ///< Pa s / m, >= 0. Acts between steps; the load search is static. Default 0.

  bool operator==(const Winkler&) const = default;  ///< Exact comparison.
};

/// Contact law of SkinSim: every taxel is a mass on a spring and a damper, driven by the contact force F of an elastic foundation.
///
/// m x'' + damping x' + stiffness x = F; the taxel reads stiffness x, which tends to F. The defaults of mass, stiffness and damping are
/// those of SkinSim's generator (model_params.yaml).
struct MassSpringDamper {
  double normal_contact_stiffness = 0;  ///< N/m^3, > 0, of the elastic foundation.
  double mass = 1e-3;                   ///< kg, > 0.
  double stiffness = 16.37;             ///< N/m, > 0.
  double damping = 0.130;               ///< N s/m, >= 0.

  bool operator==(const MassSpringDamper&) const = default;  ///< Exact comparison.
};

/// Contact law of RobWorkSim: forces of an elastic foundation deform the surface around each contact by a mask that decays with distance;
/// cells saturate; the result is rescaled to the contact force.
///
/// The mask is that of RobWorkSim's TactileArraySensor, integrated over taxels: centre .52464, edge .10387, corner .01497. At a border the
/// part on the patch is normalised. On a list of taxels the distance runs along the skin (skinDistance()), over the mean size of both
/// taxels (square root of the area), and the sum that is kept is that of the taxels' normal forces.
struct DeformationMask {
  double normal_contact_stiffness = 3.5e8;  ///< N/m^3, > 0. Default: RobWorkSim's 700 kPa over 2 mm.
  double saturation_pressure = 250e3;       ///< Pa, > 0. Default: RobWorkSim's.

  bool operator==(const DeformationMask&) const = default;  ///< Exact comparison.
};

/// Contact law of Pezzementi et al.: depth without force. A taxel reads sensitivity x mean depth x area.
///
/// The reading passes through the readout as newtons. Cannot be driven by a load; the contact wrench is 0.
struct Proximity {
  double sensitivity = 0;  ///< N/m^3, > 0.

  bool operator==(const Proximity&) const = default;  ///< Exact comparison.
};

/// Contact law of OpenGrasp: elastic foundation with LuGre friction.
///
/// C. Canudas de Wit, H. Olsson, K. J. Astrom, P. Lischinsky, "A new model for control of systems with friction", IEEE Trans. Automatic
/// Control 40(3), 1995. Bristles of deflection z (m) at every sample move over the object at the slip velocity v. Per newton of force,
///
///     z' = v - bristle_stiffness |v| z / g
///     g = coulomb_friction + (static_friction - coulomb_friction) exp(-(|v| / stribeck_velocity)^2)
///     shear = bristle_stiffness z + bristle_damping z' + viscous_friction v
///
/// v is constant within a step; the shear is that at its end, clipped to static_friction. The clipping is not part of LuGre: after a jump
/// of v the damping term would exceed Coulomb's bound. Unlike Friction, the shear depends on speed. The defaults are those of the cited
/// paper for a Coulomb friction of 1 N, taken per newton.
struct LuGre {
  double normal_contact_stiffness = 0;  ///< N/m^3, > 0.
  double bristle_stiffness = 1e5;       ///< sigma_0, 1/m, > 0, at most kMaxBristle.
  double bristle_damping = 316.2;       ///< sigma_1, s/m, 0 to kMaxBristle. Default sqrt(1e5), as in the cited paper.
  double viscous_friction = 0.4;        ///< sigma_2, s/m, 0 to kMaxBristle.
  double static_friction = 1.5;         ///< mu_s, coulomb_friction to kMaxFrictionCoefficient.
  double coulomb_friction = 1;          ///< mu_c, kMinLuGreFriction to kMaxFrictionCoefficient.
  double stribeck_velocity = 1e-3;      ///< m/s, > 0.

  bool operator==(const LuGre&) const = default;  ///< Exact comparison.
};

/// Contact law: the skin as an elastic layer.
///
/// Pressures p >= 0 and normal displacements w (m, into the skin) satisfy
///
///     w = d where p > 0,   w >= d where p = 0,   w = A p
///
/// with the influence matrix A and the signed overlap d of object and undeformed skin. Gaps matter, because a layer that is squeezed out
/// bulges into them. Normal and tangential problems are uncoupled. Solved on the samples of one grid patch and the margin around it; a
/// sensor of several patches is refused.
struct ElasticLayer {
  /// Support of the layer.
  enum class Base {
    kHalfSpace,  ///< Infinitely deep; `Skin::thickness` only bounds the penetration.
    kBonded,     ///< As thick as the skin, bonded to a rigid base; the sample spacing is at most 8 thicknesses.
  };

  double elastic_modulus = 0;   ///< Pa, > 0.
  double poisson_ratio = 0.49;  ///< 0 to 0.5. Default 0.49.
  Base base = Base::kBonded;    ///< Support. Default kBonded.
  int iterations = 10;          ///< Largest number of solver iterations per frame, 1 to kMaxLayerIterations. Default 10.
  double tolerance = 1e-3;      ///< The solver stops when `contact_residual` is at most this value; 1e-5 to 0.1. Default 1e-3.

  bool operator==(const ElasticLayer&) const = default;  ///< Exact comparison.
};

/// Any contact law.
using ContactLaw = std::variant<Winkler, MassSpringDamper, DeformationMask, Proximity, ElasticLayer, LuGre>;

/// Stick-slip friction with memory: a tangential spring at every sample, attached to the object where it touched, that slips at Coulomb's
/// cone `|traction| <= friction_coefficient * pressure`.
///
/// Depends on the path of the object, not on its speed. Only with Winkler, MassSpringDamper and ElasticLayer; the margin of an ElasticLayer
/// shears, too. With MassSpringDamper the shear of a taxel is clipped to friction_coefficient times the force that it reads; contact_wrench
/// is that of contact, in shear as in normal force, without the lag of the masses.
struct Friction {
  double tangential_stiffness = 0;  ///< N/m^3, > 0 with friction, at most kMaxTangentialStiffness. Of a bonded layer: G / thickness.
  double friction_coefficient = 0;  ///< 0 to kMaxFrictionCoefficient. Default 0: no shear.

  bool operator==(const Friction&) const = default;  ///< Exact comparison.
};

/// One term of the skin's viscoelastic relaxation: a Maxwell element in parallel with the elastic spring (standard linear solid; Prony
/// series).
///
/// At constant depth the pressure falls: k(t) = k(0) [1 - sum fraction (1 - e^(-t / time))]. Under a load the depth grows while the force
/// stays the load. Other histories follow by Boltzmann superposition, with d^normal_exponent as strain; for ElasticLayer with the
/// displacements of the whole surface, with the same k(t) for all moduli. Skin that an object leaves recovers with a free surface, and a
/// new contact meets the remaining dent. Different from the readout's creep, which acts on counts at constant force.
struct RelaxationTerm {
  double fraction = 0;  ///< Of the instantaneous stiffness (normal_contact_stiffness, elastic_modulus), 0 to 1; sum of all terms < 1.
  double time = 1;      ///< s, > 0, relaxation time.

  bool operator==(const RelaxationTerm&) const = default;  ///< Exact comparison.
};

/// The skin.
struct Skin {
  double thickness = 0;        ///< m, > 0; the deepest penetration.
  ContactLaw law = Winkler{};  ///< Contact law. Default Winkler.
  Friction friction{};         ///< Stick-slip friction. Default none.
  double margin = 0;           ///< m, >= 0, skin beyond the taxels, rounded to whole samples; 0 (default) unless the law is ElasticLayer.
  /// 0 to kMaxRelaxationTerms terms; none with normal_damping or Proximity. Before the first step after a reset the skin is fully relaxed;
  /// that step loads it instantaneously. Default none.
  std::vector<RelaxationTerm> relaxation{};
};

/// Elastic foundation of the skin: its own for Winkler, an undamped linear one for the other laws. For an elastic layer, approximately its
/// stiffness under a contact as wide as the skin is thick.
Winkler foundationOf(const Skin& skin);

/// MeshOptions::max_depth_error (m) that suits the skin: an error in depth of this size changes the pressure of the foundation by
/// kMaxPressureError at most, at any depth up to the thickness. At most the default of MeshOptions, 10 um.
double maxDepthErrorOf(const Skin& skin);

/// Whether the skin has shear, by `friction` or by a law with friction of its own.
bool hasFriction(const Skin& skin);

/// Point spread function (paper, equation (1)): a kernel over the taxels of each patch, or a Gaussian of the distance along the skin over
/// all taxels of the sensor.
struct Psf {
  /// Normalisation of the spread image.
  enum class Normalization {
    kPerSource,  ///< I_i = sum_j F_j g_ij / sum_k g_kj: keeps the sum of forces, at borders too.
    kNone,       ///< The kernel as it is. The paper's sampled Gaussian sums to 1.0279 away from borders.
  };

  int size = 1;  ///< Taxels per side of the kernel, odd, 1 to kMaxKernelSize. Default 1: with weight 1, no spread.
  /// (size x size), row-major, >= 0, sum > 0: spread(i, j) = sum over a, b of F(i - a, j - b) g(a, b), with a and b from the middle.
  std::vector<double> kernel{1};
  Normalization normalization = Normalization::kPerSource;  ///< Default kPerSource.

  /// m. If > 0, replaces the kernel, which must be the default: weight exp(-s^2 / (2 sigma^2)) for all taxels, of any patch, at a distance
  /// s <= reach (see skinDistance()), and 1 for the taxel itself. A taxel reaches at most kMaxSpreadTaxels. Default 0.
  double sigma = 0;
  double reach = 0;  ///< m, > 0; 0 (default): 3 sigma.
};

/// Distance (m) along the skin between two points p and q with unit normals n and m, assuming constant curvature between them.
///
/// The component of p - q perpendicular to the axis n x m is lengthened to the arc of the angle theta between the normals, by the factor
/// (theta / 2) / sin(theta / 2); the component along the axis is kept. Exact on planes, cylinders and spheres.
double skinDistance(const Vector3& p, const Vector3& n, const Vector3& q, const Vector3& m);

/// The paper's kernel: a Gaussian of `sigma` (taxels, > 0) sampled at taxel centres with density 1 / (2 pi sigma^2).
Psf gaussianPsf(double sigma, int size, Psf::Normalization normalization = Psf::Normalization::kPerSource);

/// One term of the readout's creep: under a force F applied at t = 0 the sensor reads F [1 + sum fraction (1 - e^(-t / time))]. The skin's
/// own viscoelasticity is Skin::relaxation.
struct CreepTerm {
  double fraction = 0;  ///< Of the force, 0 to kMaxCreepFraction.
  double time = 1;      ///< s, > 0.

  bool operator==(const CreepTerm&) const = default;  ///< Exact comparison.
};

/// A point of a piecewise linear readout curve.
struct CurvePoint {
  double force = 0;   ///< N, gain F - trigger.
  double counts = 0;  ///< Counts before output_scale.

  bool operator==(const CurvePoint&) const = default;  ///< Exact comparison.
};

/// Electronics: force after the spread -> counts, per taxel.
///
///     x = gain F - trigger
///     y = sum_m curve[m] x^(m+1)
///     counts = clip(round(output_scale y / (1 + y / curve_limit) + noise), 0, saturation)
///
/// Below x = 0 the curve continues as a straight line, so that noise passes the trigger as in the electronics
/// (docs/notes/decisions/0005-noise-before-the-trigger.md).
///
/// F follows the spread force over time: hysteresis, then creep, low-pass and delay. A reset leaves the sensor as if it had been unloaded
/// for long. Time advances at every step, with the spread force constant within the step.
struct Readout {
  std::vector<double> curve{1};  ///< counts / N^(m+1), 1 to kMaxCurveDegree terms; rises over the range used, and stays saturated beyond.
  /// Piecewise linear curve from (0, 0) through up to kMaxCurvePoints points with positive, strictly increasing coordinates. The first
  /// segment continues below 0 and the last one beyond the last point. If not empty, `curve` and `curve_limit` must be the defaults.
  std::vector<CurvePoint> curve_points{};
  /// Asymptote in counts, > saturation / output_scale, for a taxel whose conductance follows `curve` in a voltage divider. 0 (default):
  /// none.
  double curve_limit = 0;
  double output_scale = 1;            ///< > 0; the paper's k_scale. Default 1.
  double trigger = 0;                 ///< N, smallest force that is visible. Below 0: the taxel reads without a load. See noiseTrigger().
  int adc_bits = 12;                  ///< 1 to kMaxAdcBits. Default 12.
  int saturation = 4095;              ///< Counts, 1 to 2^adc_bits - 1. Default 4095.
  double noise = 0;                   ///< Counts, >= 0, standard deviation of white Gaussian noise per frame and taxel. Default 0.
  std::vector<double> taxel_gain;     ///< (num_taxels), >= 0; empty (default): 1.
  std::vector<double> taxel_trigger;  ///< (num_taxels), N; empty (default): `trigger`.
  /// (num_taxels), >= 0; empty (default): 1. Gains that a calibration found, by which ContactFeatureView::ridge_edge_angle divides. No
  /// output depends on them otherwise. 0: the taxel is left out.
  std::vector<double> calibrated_gain{};
  std::optional<ThreeAxisReadout> three_axis{};  ///< Electronics for shear, FrameView::taxel_counts; needs a skin with friction.

  /// (num_elements), Prandtl-Ishlinskii hysteresis, 0 to kMaxHysteresisElements weights, each >= 0, sum < 1. The output is
  /// (1 - sum of strengths) x + sum of strength play(x), with play operators of half-width `hysteresis_width`. Default none.
  std::vector<double> hysteresis_strength{};
  std::vector<double> hysteresis_width{};  ///< (num_elements), N, >= 0.
  std::vector<CreepTerm> creep{};          ///< 0 to kMaxCreepTerms terms. Default none.
  double low_pass_time = 0;                ///< s, >= 0, time constant of a first-order low-pass. Default 0.
  double delay = 0;                        ///< s, 0 to kMaxDelaySteps steps: a frame shows the newest step at least this old. Default 0.
  double jitter = 0;                       ///< s, 0 to 1 / frame_rate, standard deviation of a frame's delivery time. Default 0.

  /// @name Imperfections
  /// Functions of seed, episode and taxel. Offsets in counts are added at the same stage as the noise. All defaults are 0.
  /// @{
  double bias = 0;                    ///< Counts, 0 to kMaxOffsetCounts, standard deviation over taxels and episodes.
  double random_walk = 0;             ///< Counts / sqrt(s), 0 to kMaxOffsetCounts, of an offset per taxel that drifts from 0.
  double gain_spread = 0;             ///< 0 to kMaxGainSpread, standard deviation of log gain per taxel and episode.
  double press_gain_spread = 0;       ///< 0 to kMaxGainSpread, the same of a gain common to all taxels of an episode: repeatability.
  double dead_taxel_probability = 0;  ///< 0 to 1, probability that a taxel reads 0 in an episode.
  /// @}
};

/// What the depth of a sample is.
enum class DepthSampling {
  /// The depth at the middle of its cell, the pitch / samples_per_taxel rectangle around the sample.
  kPoint,
  /// The mean over its cell of min(max(-z, 0), thickness), z (m, in P) the lowest surface of the object, 0 where there is none. Forces then
  /// change continuously with the pose, and objects narrower than a cell press with all their area. A mesh that is not closed has the depth
  /// of kPoint; of several objects the one with the largest mean counts. With exponents other than 1, and for friction, two points
  /// represent the part of a cell that the object covers; they have the mean and the variance of its depth. On an ElasticLayer an edge cuts
  /// cells, whose covered part then has this mean; smooth surfaces are met as with kPoint.
  kArea,
};

/// A sensor model.
struct Sensor {
  std::string name;                                      ///< Name in messages and data sets.
  std::vector<GridPatch> patches;                        ///< Patches, at least one, with at most kMaxTaxels taxels.
  int samples_per_taxel = 4;                             ///< Samples per side of a taxel, 1 to kMaxSamplesPerTaxel. Default 4.
  DepthSampling depth_sampling = DepthSampling::kPoint;  ///< Depth of a sample. Default kPoint.
  Skin skin;                                             ///< Skin.
  Psf psf;                                               ///< Point spread function.
  Readout readout;                                       ///< Electronics.
  double frame_rate = 0;                                 ///< Hz, > 0; 0 (default): a frame at every step.
};

/// Number of taxels of all patches.
int numTaxels(const Sensor& sensor);

/// Whether the sensor is a list of taxels with individual poses: several patches of one taxel each.
bool isTaxelList(const Sensor& sensor);

/// Centres of all taxels in S, (num_taxels), m, in storage order.
std::vector<Vector3> taxelPositions(const Sensor& sensor);

/// Mean of all taxel centres in S, m.
Vector3 arrayMiddle(const Sensor& sensor);

/// Unit normals of all taxels in S, (num_taxels), in storage order.
std::vector<Vector3> taxelNormals(const Sensor& sensor);

/// Force (N) that reads `counts` on the nominal curve (gain 1, no noise): 0 for 0 counts, else the inverse of the curve plus the trigger.
double nominalForce(const Readout& readout, double counts);

/// Throws Error(kInput) with the field, its value and what is allowed.
void checkSensor(const Sensor& sensor);

/// Reads a sensor file (docs/reference/sensor_file.md). Throws Error(kInput) with file, line, column and key.
Sensor loadSensor(const std::filesystem::path& file);

/// Text of a sensor file, all settings in SI units; loadSensor() reads it as the same sensor.
///
/// `notes`: comments by key ("readout.trigger"), one line each without control characters; "" is the head of the file.
std::string sensorText(const Sensor& sensor, const std::map<std::string, std::string>& notes = {});

}  // namespace taxelsim
