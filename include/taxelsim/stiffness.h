/// @file
/// Parameters of the contact laws from what is known about a skin: its material, or one measurement of its stiffness. Linear elasticity.
/// characterize() fits whole measured curves instead (characterize.h).
///
/// Three stiffnesses differ in unit and in meaning:
/// - area stiffness, N/m^3: pressure per depth of independent springs, `normal_contact_stiffness` of the laws;
/// - taxel stiffness, N/m: force per depth of one whole taxel;
/// - pin stiffness, N/m: force per depth of a flat pin of a given diameter.
#pragma once

#include <array>
#include <optional>
#include <variant>
#include <vector>

#include "taxelsim/sensor.h"

namespace taxelsim {

/// @name Limits of skins with known stiffness
/// @{
inline constexpr double kMinShoreA = 20;             ///< Smallest Shore A hardness of shoreAModulus().
inline constexpr double kMaxShoreA = 90;             ///< Largest Shore A hardness of shoreAModulus().
inline constexpr double kMinLayerThickness = 1e-4;   ///< m, smallest SkinData::thickness.
inline constexpr double kMaxPinDiameterRatio = 128;  ///< Largest diameter of a pin, in thicknesses of the layer.
/// @}

/// An isotropic linear-elastic material.
struct Material {
  double elastic_modulus = 0;   ///< Young's modulus, Pa, > 0.
  double poisson_ratio = 0.49;  ///< 0 to below 0.5. Default 0.49.

  bool operator==(const Material&) const = default;  ///< Exact comparison.
};

/// Young's modulus (Pa) of rubber with the Shore A hardness `shore_a`, kMinShoreA to kMaxShoreA; else throws Error(kInput).
///
/// A. N. Gent, "On the relation between indentation hardness and Young's modulus", Rubber Chemistry and Technology 31(4), 1958:
/// E = 0.0981 (56 + 7.62336 S) / (0.137505 (254 - 2.54 S)) MPa. A type A durometer is not reliable outside of the range.
double shoreAModulus(double shore_a);

/// Shear modulus (Pa): E / (2 (1 + nu)). Throws Error(kInput) for a material out of range.
double shearModulus(const Material& material);

/// Confined (oedometric) modulus (Pa), of a layer that cannot expand sideways: E (1 - nu) / ((1 + nu) (1 - 2 nu)). Throws Error(kInput) for
/// a material out of range.
double confinedModulus(const Material& material);

/// Force per depth (N/m) of a rigid flat circular pin on a layer of `thickness` (m, > 0) bonded to a rigid base, without friction under the
/// pin: the continuum solution of the law ElasticLayer. Relative error below 1e-4.
///
/// `pin_diameter`: m, > 0, at most kMaxPinDiameterRatio thicknesses. Throws Error(kInput) for arguments out of range.
double layerPinStiffness(const Material& material, double thickness, double pin_diameter);

/// Young's modulus is known, by a data sheet or by shoreAModulus().
///
/// Springs: area stiffness = confined modulus / thickness, that of a contact much wider than the skin is thick. With `match_pin_diameter`
/// instead the area stiffness at which springs carry the force of the layer under a flat pin of this diameter.
struct KnownModulus {
  double elastic_modulus = 0;                  ///< Pa, > 0.
  std::optional<double> match_pin_diameter{};  ///< m, > 0, at most kMaxPinDiameterRatio thicknesses. Default none.
};

/// A flat circular pin was pressed in.
///
/// Springs: area stiffness = force / (area depth). Layer: the modulus at which layerPinStiffness() is force / depth.
struct PinPress {
  double pin_force = 0;     ///< N, > 0.
  double pin_depth = 0;     ///< m, > 0, at most the thickness.
  double pin_diameter = 0;  ///< m, > 0, at most kMaxPinDiameterRatio thicknesses.
};

/// Force per depth of one whole taxel was measured, with all taxels around it pressed equally deep.
///
/// Springs: area stiffness = taxel stiffness / area of the taxel. Layer: as for AreaStiffness.
struct TaxelStiffness {
  double taxel_stiffness = 0;         ///< N/m, > 0.
  std::array<double, 2> pitch{0, 0};  ///< m, > 0, along x and along y.
};

/// Pressure per depth was measured under a stamp much wider than the skin is thick.
///
/// Layer: the modulus at which confined modulus / thickness is the area stiffness.
struct AreaStiffness {
  double area_stiffness = 0;  ///< N/m^3, > 0.
};

/// What is known about a skin.
struct SkinData {
  double thickness = 0;                                                             ///< m, kMinLayerThickness to kMaxLayerThickness.
  double poisson_ratio = 0.49;                                                      ///< 0 to below 0.5. Default 0.49.
  std::variant<KnownModulus, PinPress, TaxelStiffness, AreaStiffness> stiffness{};  ///< The material or the measurement.
};

/// Stiffness of a skin, as springs and as a bonded layer.
struct SkinStiffness {
  double thickness = 0;             ///< m.
  Material material{};              ///< Of the layer.
  double area_stiffness = 0;        ///< N/m^3, of springs.
  double tangential_stiffness = 0;  ///< N/m^3, shear modulus / thickness: the layer in simple shear; for Friction::tangential_stiffness.

  bool operator==(const SkinStiffness&) const = default;  ///< Exact comparison.
};

/// Stiffness that follows from `data`. Throws Error(kInput) with the field, its value and what is allowed.
SkinStiffness skinStiffness(const SkinData& data);

/// A skin of this stiffness under each contact law, in the order of ContactLaw; parameters that do not follow from the stiffness are the
/// defaults.
///
/// ElasticLayer is bonded and has a margin of two thicknesses. `friction_coefficient`: 0 to kMaxFrictionCoefficient, for the laws with
/// Friction. Throws Error(kInput) for values out of range.
std::vector<Skin> skinsOf(const SkinStiffness& stiffness, double friction_coefficient = 0);

/// Force (N) under a flat circular pin at `depth` (m, 0 to the thickness), at rest; what the taxels read for Proximity.
///
/// Foundation: pressure times area. ElasticLayer: layerPinStiffness() times depth, or a half-space. Relaxation and friction do not act. A
/// simulated array differs by the resolution of its samples. `pin_diameter`: m, > 0. Throws Error(kInput) for arguments out of range.
double pinForce(const Skin& skin, double pin_diameter, double depth);

/// Depth (m) at which pinForce() is `force` (N, >= 0); may exceed the thickness. Throws Error(kInput) for arguments out of range.
double pinDepth(const Skin& skin, double pin_diameter, double force);

}  // namespace taxelsim
