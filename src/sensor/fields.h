// Tables of fields (base/field.h) of the settings of a sensor.
#pragma once

#include <array>
#include <string_view>
#include <variant>

#include "base/field.h"
#include "taxelsim/sensor.h"

namespace taxelsim {

inline constexpr std::array kSensorFields{
    Field<Sensor>{"samples_per_taxel", &Sensor::samples_per_taxel, Allowed::within(1, kMaxSamplesPerTaxel, ""), kOptional,
                  "Samples per side of a taxel"},
};
inline constexpr std::array<std::string_view, 2> kDepthSamplingNames{"point", "area"};  // in the order of DepthSampling
inline constexpr std::array kFrameRateFields{
    Field<Sensor>{"frame_rate", &Sensor::frame_rate, Allowed::atLeast(0, "Hz"), kOptional,
                  "Frames that the electronics report, 0 for one at every step"},
};
inline constexpr std::array kGridPatchFields{
    Field<GridPatch>{"num_rows", &GridPatch::num_rows, Allowed::within(1, kMaxTaxelsPerSide, ""), kRequired, "Taxels along x"},
    Field<GridPatch>{"num_cols", &GridPatch::num_cols, Allowed::within(1, kMaxTaxelsPerSide, ""), kRequired, "Taxels along y"},
};

inline constexpr std::array kSkinFields{
    Field<Skin>{"thickness[_mm]", &Skin::thickness, Allowed::above(0, "m"), kRequired, "Thickness, the deepest penetration"},
};
inline constexpr std::array kMarginFields{
    Field<Skin>{"margin[_mm]", &Skin::margin, Allowed::within(0, 1, "m"), kOptional,
                "Skin beyond the taxels, 0 unless the law is ElasticLayer"},
};
inline constexpr std::array kFrictionFields{
    Field<Friction>{"friction_coefficient", &Friction::friction_coefficient, Allowed::within(0, kMaxFrictionCoefficient, ""), kOptional,
                    "Share of the pressure at which the tangential springs slip; 0 for a skin without shear"},
    Field<Friction>{"tangential_stiffness", &Friction::tangential_stiffness, Allowed::above(0, "N/m^3"), kRequired,
                    "Stiffness of the tangential springs; G / thickness of a bonded layer with the shear modulus G"},
};
inline constexpr std::array kRelaxationFields{
    Field<RelaxationTerm>{"fraction", &RelaxationTerm::fraction, Allowed::within(0, 1, "of the stiffness"), kRequired,
                          "Share of the stiffness that relaxes; the sum of all terms is below 1"},
    Field<RelaxationTerm>{"time", &RelaxationTerm::time, Allowed::above(0, "s"), kRequired, "Time constant"},
};

inline constexpr std::array kWinklerFields{
    Field<Winkler>{"normal_contact_stiffness", &Winkler::normal_contact_stiffness, Allowed::above(0, "Pa/m^normal_exponent"), kRequired,
                   "Pressure per depth^normal_exponent"},
    Field<Winkler>{"normal_exponent", &Winkler::normal_exponent, Allowed::within(1, 3, ""), kOptional, "Exponent of the depth"},
    Field<Winkler>{"normal_damping", &Winkler::normal_damping, Allowed::atLeast(0, "Pa s/m"), kOptional, "Pressure per rate of the depth"},
};
inline constexpr std::array kMassSpringDamperFields{
    Field<MassSpringDamper>{"normal_contact_stiffness", &MassSpringDamper::normal_contact_stiffness, Allowed::above(0, "N/m^3"), kRequired,
                            "Pressure per depth of the elastic foundation"},
    Field<MassSpringDamper>{"mass", &MassSpringDamper::mass, Allowed::above(0, "kg"), kOptional, "Mass of a taxel"},
    Field<MassSpringDamper>{"stiffness", &MassSpringDamper::stiffness, Allowed::above(0, "N/m"), kOptional,
                            "Stiffness of the spring of a taxel"},
    Field<MassSpringDamper>{"damping", &MassSpringDamper::damping, Allowed::atLeast(0, "N s/m"), kOptional, "Damping of a taxel"},
};
inline constexpr std::array kDeformationMaskFields{
    Field<DeformationMask>{"normal_contact_stiffness", &DeformationMask::normal_contact_stiffness, Allowed::above(0, "N/m^3"), kOptional,
                           "Pressure per depth of the elastic foundation"},
    Field<DeformationMask>{"saturation_pressure", &DeformationMask::saturation_pressure, Allowed::above(0, "Pa"), kOptional,
                           "Pressure at which a cell saturates"},
};
inline constexpr std::array kProximityFields{
    Field<Proximity>{"sensitivity", &Proximity::sensitivity, Allowed::above(0, "N/m^3"), kRequired, "Output per depth and area"},
};
inline constexpr std::array kElasticLayerFields{
    Field<ElasticLayer>{"elastic_modulus", &ElasticLayer::elastic_modulus, Allowed::above(0, "Pa"), kRequired, "Young's modulus"},
    Field<ElasticLayer>{"poisson_ratio", &ElasticLayer::poisson_ratio, Allowed::within(0, 0.5, ""), kRequired, "Poisson's ratio"},
};
inline constexpr std::array<std::string_view, 2> kBaseNames{"half_space", "bonded"};  // in the order of ElasticLayer::Base
inline constexpr std::array kLayerSolverFields{
    Field<ElasticLayer>{"iterations", &ElasticLayer::iterations, Allowed::within(1, kMaxLayerIterations, ""), kOptional,
                        "Most iterations of the solver in a frame"},
    Field<ElasticLayer>{"tolerance", &ElasticLayer::tolerance, Allowed::within(1e-5, 0.1, ""), kOptional,
                        "contact_residual at which the solver stops"},
};
inline constexpr std::array kLuGreFields{
    Field<LuGre>{"normal_contact_stiffness", &LuGre::normal_contact_stiffness, Allowed::above(0, "N/m^3"), kRequired,
                 "Pressure per depth of the elastic foundation"},
    Field<LuGre>{"bristle_stiffness", &LuGre::bristle_stiffness, Allowed::aboveUpTo(0, kMaxBristle, "1/m"), kOptional,
                 "Stiffness of the bristles per normal force"},
    Field<LuGre>{"bristle_damping", &LuGre::bristle_damping, Allowed::within(0, kMaxBristle, "s/m"), kOptional,
                 "Damping of the bristles per normal force"},
    Field<LuGre>{"viscous_friction", &LuGre::viscous_friction, Allowed::within(0, kMaxBristle, "s/m"), kOptional,
                 "Viscous friction per normal force"},
    Field<LuGre>{"static_friction", &LuGre::static_friction, Allowed::within(kMinLuGreFriction, kMaxFrictionCoefficient, ""), kOptional,
                 "Coefficient at rest, at least coulomb_friction"},
    Field<LuGre>{"coulomb_friction", &LuGre::coulomb_friction, Allowed::within(kMinLuGreFriction, kMaxFrictionCoefficient, ""), kOptional,
                 "Coefficient while sliding"},
    Field<LuGre>{"stribeck_velocity", &LuGre::stribeck_velocity, Allowed::above(0, "m/s"), kOptional, "Velocity between rest and sliding"},
};

// Names of the laws in files, in the order of ContactLaw.
inline constexpr std::array<std::string_view, std::variant_size_v<ContactLaw>> kLawNames{
    "winkler", "mass_spring_damper", "deformation_mask", "proximity", "elastic_layer", "lugre"};

// Calls visit(table) for every table of a law's fields, in file order.
template <typename Visit>
void visitFields(const Winkler&, Visit visit) {
  visit(kWinklerFields);
}
template <typename Visit>
void visitFields(const MassSpringDamper&, Visit visit) {
  visit(kMassSpringDamperFields);
}
template <typename Visit>
void visitFields(const DeformationMask&, Visit visit) {
  visit(kDeformationMaskFields);
}
template <typename Visit>
void visitFields(const Proximity&, Visit visit) {
  visit(kProximityFields);
}
template <typename Visit>
void visitFields(const ElasticLayer&, Visit visit) {
  visit(kElasticLayerFields), visit(kLayerSolverFields);
}
template <typename Visit>
void visitFields(const LuGre&, Visit visit) {
  visit(kLuGreFields);
}

inline constexpr std::array kSkinGaussianFields{
    Field<Psf>{"sigma[_mm]", &Psf::sigma, Allowed::above(0, "m"), kRequired, "Width of the Gaussian of the distance along the skin"},
    Field<Psf>{"reach[_mm]", &Psf::reach, Allowed::above(0, "m"), kOptional, "Distance up to which a taxel spreads its force"},
};
inline constexpr std::array<std::string_view, 2> kNormalizationNames{"per_source", "none"};  // in the order of Psf::Normalization

inline constexpr std::array kCurveLimitFields{
    Field<Readout>{"limit", &Readout::curve_limit, Allowed::atLeast(0, "counts"), kOptional,
                   "Asymptote of the output: y becomes y / (1 + y / limit), as for a resistive taxel in a voltage divider; 0 for none, "
                   "else above saturation / output_scale"},
};
inline constexpr std::array kOutputFields{
    Field<Readout>{"output_scale", &Readout::output_scale, Allowed::above(0, ""), kOptional, "Factor on the counts"},
    Field<Readout>{"trigger", &Readout::trigger, Allowed::any("N"), kOptional, "Smallest visible force"},
    Field<Readout>{"adc_bits", &Readout::adc_bits, Allowed::within(1, kMaxAdcBits, ""), kOptional, "Bits of the converter"},
};
inline constexpr std::array kNoiseFields{
    Field<Readout>{"noise", &Readout::noise, Allowed::atLeast(0, "counts"), kOptional,
                   "Standard deviation of white noise per frame and taxel"},
};
// Of each axis of ThreeAxisReadout.
inline constexpr double kMaxAxisGain = 1e12;
inline constexpr std::array kThreeAxisFields{
    Field<ThreeAxisReadout>{"noise", &ThreeAxisReadout::noise, Allowed::within(0, kMaxAxisCounts, "counts"), kOptional,
                            "Standard deviation of each output"},
    Field<ThreeAxisReadout>{"hysteresis_strength",
                            &ThreeAxisReadout::hysteresis_strength,
                            {.min = 0, .max = 1, .below_max = true},
                            kOptional,
                            "Of each axis of force, (1 - w) x + w play_r(x), before the matrix: the strength w"},
    Field<ThreeAxisReadout>{"hysteresis_width", &ThreeAxisReadout::hysteresis_width, Allowed::atLeast(0, "N"), kOptional, "The width r"},
    Field<ThreeAxisReadout>{"saturation", &ThreeAxisReadout::saturation, Allowed::within(1, kMaxAxisCounts, ""), kOptional,
                            "Outputs are -saturation to saturation"},
};
inline constexpr std::array kCreepFields{
    Field<CreepTerm>{"fraction", &CreepTerm::fraction, Allowed::within(0, kMaxCreepFraction, "of the force"), kRequired,
                     "Share of the force that creeps"},
    Field<CreepTerm>{"time", &CreepTerm::time, Allowed::above(0, "s"), kRequired, "Time constant"},
};
inline constexpr std::array kTimeFields{
    Field<Readout>{"low_pass_time", &Readout::low_pass_time, Allowed::atLeast(0, "s"), kOptional, "Time constant of the low-pass filter"},
    Field<Readout>{"delay", &Readout::delay, Allowed::atLeast(0, "s"), kOptional, "Delay of the output, at most 32 steps"},
    Field<Readout>{"jitter", &Readout::jitter, Allowed::atLeast(0, "s"), kOptional,
                   "Standard deviation of the time of a frame, at most 1 / frame_rate"},
};
inline constexpr std::array kImperfectionFields{
    Field<Readout>{"bias", &Readout::bias, Allowed::within(0, kMaxOffsetCounts, "counts"), kOptional,
                   "Standard deviation of an offset over taxels and episodes"},
    Field<Readout>{"random_walk", &Readout::random_walk, Allowed::within(0, kMaxOffsetCounts, "counts/sqrt(s)"), kOptional,
                   "Rate of an offset per taxel that drifts from 0"},
    Field<Readout>{"gain_spread", &Readout::gain_spread, Allowed::within(0, kMaxGainSpread, ""), kOptional,
                   "Standard deviation of the logarithm of a gain per taxel and episode"},
    Field<Readout>{"press_gain_spread", &Readout::press_gain_spread, Allowed::within(0, kMaxGainSpread, ""), kOptional,
                   "Standard deviation of the logarithm of a gain per episode, common to all taxels"},
    Field<Readout>{"dead_taxel_probability", &Readout::dead_taxel_probability, Allowed::within(0, 1, ""), kOptional,
                   "Probability that a taxel reads 0 in an episode"},
};

}  // namespace taxelsim
