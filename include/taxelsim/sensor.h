// A tactile sensor: taxels on patches, the skin over them, and the electronics that read them.
// Not the state of any sensor: that is the Simulator's.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "taxelsim/pose.h"

namespace taxelsim {

inline constexpr int kMaxSamplesPerTaxel = 8;  // per side
inline constexpr int kMaxTaxelsPerSide = 128;  // of a grid patch
inline constexpr int kMaxKernelSize = 9;       // taxels per side
inline constexpr int kMaxSpreadTaxels = 128;   // that one taxel may reach by distance along the skin
inline constexpr int kMaxCurveDegree = 5;
inline constexpr int kMaxCurvePoints = 16;
inline constexpr int kMaxAdcBits = 16;
inline constexpr int kMaxHysteresisElements = 4;
inline constexpr int kMaxCreepTerms = 4;
inline constexpr int kMaxRelaxationTerms = 4;
inline constexpr int kMaxDelaySteps = 32;  // simulation steps that a readout's delay may span
inline constexpr double kMaxCreepFraction = 1e6;
inline constexpr double kMaxOffsetCounts = 1e9;  // of bias and random walk
inline constexpr double kMaxGainSpread = 2;
inline constexpr double kMaxFrictionCoefficient = 1000;
inline constexpr double kMinLuGreFriction = 1e-9;        // of the coefficients of LuGre
inline constexpr double kMaxBristle = 1e12;              // of the stiffness, damping and viscous friction of LuGre
inline constexpr double kMaxTangentialStiffness = 1e30;  // N/m^3: what the device's float32 holds with room for a displacement
inline constexpr int kMaxLayerNodes = 65536;             // of an elastic layer: samples of its patch and margin
inline constexpr int kMaxLayerIterations = 1000;         // per frame

// A planar grid of taxels. Its frame P lies in the grid's middle on the undeformed outer skin surface, z out of the skin
// towards the object; row i runs along x, column j along y. Taxel (i, j) is centred on
//   ((i - (num_rows - 1) / 2) pitch[0], (j - (num_cols - 1) / 2) pitch[1], 0) in P
// and has index first_taxel_of_the_patch + i num_cols + j.
struct GridPatch {
  std::string name;
  int num_rows = 1;                   // 1 to 128
  int num_cols = 1;                   // 1 to 128
  std::array<double, 2> pitch{0, 0};  // m, > 0: along x, along y
  Pose X_SP;                          // pose of the patch in the sensor frame
};

// A taxel with a place of its own, on a curved or irregular skin: a patch of 1 x 1, the square or rectangle of `size` (m, > 0, along x and
// y of P) in the plane that touches the skin at `position` (m, in S), looking along `normal` (in S, of any length but 0). The shortest turn
// that takes z of S to the normal takes x of S to x of P; `x_axis` (in S, not along the normal), if given, is projected into the plane
// instead. Throws Error(kInput) for a direction that is 0, not finite, or along the normal.
GridPatch taxelPatch(std::string name, const Vector3& position, const Vector3& normal, const std::array<double, 2>& size,
                     const std::optional<Vector3>& x_axis = {});

// pressure = normal_contact_stiffness d^normal_exponent + normal_damping d', never negative, where d > 0 (the paper's
// penalty contact, as an elastic foundation so that forces do not depend on the number of samples).
struct Winkler {
  double normal_contact_stiffness = 0;  // Pa / m^normal_exponent (N/m^3 for exponent 1), > 0
  double normal_exponent = 1;           // 1 to 3
  double normal_damping = 0;            // Pa s / m, >= 0; acts between steps, not in the load search (which is at rest)

  bool operator==(const Winkler&) const = default;
};

// SkinSim: every taxel is a mass on a spring and a damper, pushed by what contact presses on it (an elastic foundation, as Winkler with
// exponent 1). It reads the force in its spring, which after a while is that of contact: m x" + damping x' + stiffness x = F, reads
// stiffness x.
struct MassSpringDamper {
  double normal_contact_stiffness = 0;  // N/m^3, > 0
  double mass = 1e-3;                   // kg, > 0; with the next two the defaults of SkinSim's generator (model_params.yaml)
  double stiffness = 16.37;             // N/m, > 0
  double damping = 0.130;               // N s/m, >= 0

  bool operator==(const MassSpringDamper&) const = default;
};

// RobWorkSim: an elastic foundation whose forces deform the surface around each contact by a mask that falls with distance, cells that
// saturate, all rescaled to the force of contact. The mask is RobWorkSim's (TactileArraySensor), integrated over taxels: middle .52464,
// edge .10387, corner .01497; at borders what stays on the patch is normalised.
struct DeformationMask {
  double normal_contact_stiffness = 3.5e8;  // N/m^3, > 0; the default is RobWorkSim's 700 kPa over 2 mm
  double saturation_pressure = 250e3;       // Pa, > 0; RobWorkSim's

  bool operator==(const DeformationMask&) const = default;
};

// Pezzementi et al.: depth alone, no force; a taxel reads sensitivity x mean depth x area, in newtons as the readout's curve takes them.
// Cannot be driven by load; the contact wrench is 0.
struct Proximity {
  double sensitivity = 0;  // N/m^3, > 0

  bool operator==(const Proximity&) const = default;
};

// OpenGrasp: an elastic foundation (as Winkler with exponent 1) whose shear is that of LuGre (C. Canudas de Wit, H. Olsson, K. J. Astrom,
// P. Lischinsky, "A new model for control of systems with friction", IEEE Trans. Automatic Control 40(3), 1995): at every sample bristles
// that the object bends by z (m), moving over them at the velocity v. Per newton of normal force,
//   z' = v - bristle_stiffness |v| z / g,  g = coulomb_friction + (static_friction - coulomb_friction) exp(-(|v| / stribeck_velocity)^2)
//   shear = bristle_stiffness z + bristle_damping z' + viscous_friction v,  shortened to static_friction where it is longer,
// v being the same throughout a step and shear that at its end. Unlike Friction it depends on speed. The shortening is not LuGre's: at a
// jump of v it would overstep Coulomb's bound by the damping. The defaults are the paper's for a Coulomb friction of 1 N, taken per newton.
struct LuGre {
  double normal_contact_stiffness = 0;  // N/m^3, > 0
  double bristle_stiffness = 1e5;       // sigma_0, 1/m, > 0, at most 1e12
  double bristle_damping = 316.2;       // sigma_1, s/m, 0 to 1e12; the paper's sqrt(1e5)
  double viscous_friction = 0.4;        // sigma_2, s/m, 0 to 1e12
  double static_friction = 1.5;         // mu_s, coulomb_friction to 1000
  double coulomb_friction = 1;          // mu_c, 1e-9 to 1000
  double stribeck_velocity = 1e-3;      // m/s, > 0

  bool operator==(const LuGre&) const = default;
};

// The skin as an elastic solid. Its pressures p >= 0 and normal displacements w (m, into the skin) obey
//   w = d where p > 0,   w >= d where p = 0,   w = A p,
// d being the signed overlap of object and undeformed skin: gaps count, since a layer that is squeezed out bulges into them. Shear does not
// move the surface along its normal, nor pressure along the surface. Solved on the samples of one grid patch and of the margin around it; a
// sensor of several patches is refused.
struct ElasticLayer {
  enum class Base {
    kHalfSpace,  // so deep that no base is felt; `thickness` only ends the penetration
    kBonded,     // as thick as the skin, stuck to a rigid board; samples may lie up to 8 thicknesses apart
  };

  double elastic_modulus = 0;   // Pa, > 0
  double poisson_ratio = 0.49;  // 0 to 0.5
  Base base = Base::kBonded;
  int iterations = 10;      // of the solver, at most, per frame; 1 to 1000
  double tolerance = 1e-3;  // the solver ends when `contact_residual` is no larger; 1e-5 to 0.1

  bool operator==(const ElasticLayer&) const = default;
};

using ContactLaw = std::variant<Winkler, MassSpringDamper, DeformationMask, Proximity, ElasticLayer, LuGre>;

// Stick and slip with memory: at every sample a tangential spring that holds on to the object where it touched and gives way at Coulomb's
// cone, |traction| <= friction_coefficient * pressure. Depends on the path of the object, not on its speed. Beside Winkler,
// MassSpringDamper and ElasticLayer only; of the last its margin shears, too. A taxel whose mass lags shows no more shear than
// friction_coefficient times the force that it reads; contact_wrench is that of contact, in shear as in normal force, which no mass delays.
struct Friction {
  double tangential_stiffness = 0;  // N/m^3, > 0 where there is friction, at most 1e30; a layer bonded to its base has G / thickness
  double friction_coefficient = 0;  // 0 to 1000; 0: no shear

  bool operator==(const Friction&) const = default;
};

// A term of the skin's relaxation: a spring and a dashpot in series, beside the spring that stays and the other terms (the standard linear
// solid; a Prony series). At constant depth the pressure falls, k(t) = k(0) [1 - sum fraction (1 - e^(-t / time))]; under a load the depth
// grows while the sum of the forces stays the load. Other histories by Boltzmann's superposition, with d^normal_exponent as strain, of
// ElasticLayer with the displacements of the whole surface, all moduli following one k(t); skin that an object leaves recovers with a free
// surface, and a new press meets the dent that is left. Not the readout's creep, which is of counts at constant force.
struct RelaxationTerm {
  double fraction = 0;  // of the instantaneous stiffness: normal_contact_stiffness, elastic_modulus; 0 to 1, the sum of all terms < 1
  double time = 1;      // s, > 0

  bool operator==(const RelaxationTerm&) const = default;
};

struct Skin {
  double thickness = 0;  // m, > 0; the deepest penetration
  ContactLaw law = Winkler{};
  Friction friction{};
  double margin = 0;  // m, >= 0: how far the skin goes on past the taxels, rounded to whole samples; 0 unless the law is ElasticLayer
  // 0 to 4 terms; none beside normal_damping or under Proximity. The first step after a reset presses at once, on skin long unloaded.
  std::vector<RelaxationTerm> relaxation{};
};

// The elastic foundation that the skin presses with: Winkler's own, for other laws linear springs without damping; of an elastic layer
// about what it resists under a contact as wide as the skin is thick.
Winkler foundationOf(const Skin& skin);

// Whether the skin shears: by `friction`, or by a law with friction of its own.
bool hasFriction(const Skin& skin);

// The point spread function; paper eq. (1): over the taxels of one patch by a kernel, or over all taxels of the sensor by their distance
// along the skin.
struct Psf {
  enum class Normalization {
    kPerSource,  // I_i = sum_j F_j g_ij / sum_k g_kj: the sum of forces is kept, at borders too
    kNone,       // the kernel as given: the paper's own sampled Gaussian sums to 1.0279 inside
  };

  int size = 1;                   // taxels per side, odd, 1 to 9; 1 with weight 1 is no spread
  std::vector<double> kernel{1};  // (size x size), row-major, >= 0, sum > 0; [a][b] weighs the source at (i - a, j - b) from
                                  // the middle: spread(i, j) = sum F(i - a, j - b) g(a, b)
  Normalization normalization = Normalization::kPerSource;

  // > 0: no kernel (which must be the default then) but the weight exp(-s^2 / (2 sigma^2)) for all taxels, of this patch and others, at a
  // distance s <= reach along the skin, see skinDistance(); 1 for the taxel itself. No taxel may reach more than 128.
  double sigma = 0;  // m
  double reach = 0;  // m, > 0; 0 is 3 sigma
};

// Distance (m) along the skin between two of its points p and q with unit normals n and m, as if the skin between them turned evenly. The
// part of the chord p - q across the axis n x m about which the normals turn, by an angle theta, is an arc of that angle, longer than the
// chord by (theta / 2) / sin(theta / 2); the part along the axis is straight. Exact on planes, cylinders and spheres.
double skinDistance(const Vector3& p, const Vector3& n, const Vector3& q, const Vector3& m);

// The paper's kernel: a Gaussian of `sigma` (taxels, > 0) sampled at taxel centres with density 1 / (2 pi sigma^2).
Psf gaussianPsf(double sigma, int size, Psf::Normalization normalization = Psf::Normalization::kPerSource);

// Readout creep: at a force F that begins at t = 0 the sensor reads F [1 + sum fraction (1 - e^(-t / time))]. What the skin itself does
// over time, at constant depth or under a load, is its relaxation.
struct CreepTerm {
  double fraction = 0;  // of the force, 0 to 1e6
  double time = 1;      // s, > 0

  bool operator==(const CreepTerm&) const = default;
};

// A corner of a readout's curve of straight pieces.
struct CurvePoint {
  double force = 0;   // N, of gain F - trigger
  double counts = 0;  // before output_scale

  bool operator==(const CurvePoint&) const = default;
};

// Force after the spread -> counts, per taxel:
//   x = gain F - trigger;  y = sum_m curve[m] x^(m+1);  counts = clip(round(output_scale y / (1 + y / curve_limit) + noise), 0, saturation)
// where the curve goes on below x = 0 as a straight line, so that noise meets the trigger as it does in the electronics.
struct Readout {
  std::vector<double> curve{1};  // counts / N^(m+1), m = 0 .. degree - 1, 1 to 5 terms; must rise over the range used
  // Or straight pieces from (0, 0) through up to 16 points, both of whose numbers are > 0 and rise strictly; the first piece goes on below
  // 0 and the last one past the last point. Empty: `curve`. Beside points `curve` and `curve_limit` must be the defaults.
  std::vector<CurvePoint> curve_points{};
  // Counts that the output tends to, > saturation / output_scale, or 0 for none: the curve of a taxel whose conductance grows as `curve`
  // and which is one arm of a voltage divider.
  double curve_limit = 0;
  double output_scale = 1;            // > 0; the paper's k_scale
  double trigger = 0;                 // N, >= 0; smallest force that shows
  int adc_bits = 12;                  // 1 to 16
  int saturation = 4095;              // counts, 1 to 2^adc_bits - 1
  double noise = 0;                   // counts, >= 0; standard deviation of white Gaussian noise per frame and taxel
  std::vector<double> taxel_gain;     // (num_taxels) or empty for 1; >= 0
  std::vector<double> taxel_trigger;  // (num_taxels), N, or empty for `trigger`

  // How the force F of the formula follows the spread force x over time, in this order; a reset leaves the sensor as if long unloaded. Time
  // runs at every step, with x held over it.
  // Hysteresis (Prandtl and Ishlinskii): (1 - sum strength) x + sum strength play(x), play being what an element with that much slack on
  // either side is pushed to.
  std::vector<double> hysteresis_strength{};  // (elements), 0 to 4 of them, each >= 0, their sum < 1
  std::vector<double> hysteresis_width{};     // (elements), N, >= 0
  std::vector<CreepTerm> creep{};             // 0 to 4 terms
  double low_pass_time = 0;                   // s, >= 0; first order
  double delay = 0;                           // s, 0 to kMaxDelaySteps steps: a frame shows the newest step that is at least so old
  double jitter = 0;                          // s, 0 to 1 / frame_rate; standard deviation of the instant at which a frame is delivered

  // Imperfections, each a function of seed, episode and taxel. Counts are added where noise is.
  double bias = 0;                    // counts, 0 to 1e9; standard deviation over taxels and episodes
  double random_walk = 0;             // counts / sqrt(s), 0 to 1e9; of an offset that drifts from 0 on, per taxel
  double gain_spread = 0;             // 0 to 2; standard deviation of the logarithm of a gain per taxel and episode
  double press_gain_spread = 0;       // 0 to 2; the same of a gain per episode, common to all taxels: repeatability
  double dead_taxel_probability = 0;  // 0 to 1; of a taxel to read 0 for an episode
};

struct Sensor {
  std::string name;
  std::vector<GridPatch> patches;
  int samples_per_taxel = 4;  // per side, 1 to 8
  Skin skin;
  Psf psf;
  Readout readout;
  double frame_rate = 0;  // Hz, > 0, or 0 for a frame at every step
};

// Number of taxels over all patches.
int numTaxels(const Sensor& sensor);

// Whether the sensor is a list of taxels with places of their own: several patches, of one taxel each.
bool isTaxelList(const Sensor& sensor);

// Centres of all taxels in S, (num_taxels), m, in storage order.
std::vector<Vector3> taxelPositions(const Sensor& sensor);

// Mean of all taxel centres in S, m.
Vector3 arrayMiddle(const Sensor& sensor);

// Unit normals of all taxels in S, (num_taxels), in storage order.
std::vector<Vector3> taxelNormals(const Sensor& sensor);

// Force (N) that reads `counts` by the nominal curve (gain 1, no noise): 0 for 0 counts, else the root x of the curve, of points too, plus
// trigger.
double nominalForce(const Readout& readout, double counts);

// Throws Error(kInput) naming the field, its value and what is allowed.
void checkSensor(const Sensor& sensor);

// Reads a sensor file (docs/file_formats.md). Throws Error(kInput) with file, line, column and key.
Sensor loadSensor(const std::filesystem::path& file);

// The text of a sensor file that loadSensor() reads as the same sensor, all settings in SI units. `notes`: what to say beside a key
// ("readout.trigger"), one line without control characters each; "" at the head of the file.
std::string sensorText(const Sensor& sensor, const std::map<std::string, std::string>& notes = {});

}  // namespace taxelsim
