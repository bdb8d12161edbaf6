// Sensors: patches, skin with contact laws, point spread, readout.
#include "taxelsim/sensor.h"

#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include <algorithm>

#include "sensor/fields.h"
#include "structs.h"
#include "taxelsim/sensor_hints.h"
#include "without_gil.h"

namespace taxelsim::python {
namespace {

constexpr auto kAskForUnits = [](const auto& made) {
  warnOfUnits(made);
  deliverMessages();
};

double defaultTrigger(const Readout& made) {
  return made.taxel_trigger.empty() ? noiseTrigger(made) : 0;
}

void bindPatch(nb::module_& module) {
  nb::class_<GridPatch> patch(module, "GridPatch", R"(A planar grid of taxels.

Its frame P lies in the middle of the grid on the undeformed outer skin surface, z out of the skin towards the object. Row i runs along x,
column j along y.)");
  addCheckedTables(
      patch, kAskForUnits, std::tuple(field("name", &GridPatch::name, "Name in messages and data sets.")), fieldsOf<kGridPatchFields>(),
      std::tuple(field("pitch", &GridPatch::pitch, "(2), m, > 0, along x and along y; the constructor takes one number for both."),
                 field("X_SP", &GridPatch::X_SP, "Pose of the patch in the sensor frame S.")));
  module.def(
      "taxel_patch",
      [](const std::string& name, const Vector3& position, const Vector3& normal, const Argument<std::array<double, 2>>& size,
         const std::optional<Vector3>& x_axis) { return taxelPatch(name, position, normal, size.value, x_axis); },
      "name"_a, "position"_a, "normal"_a, "size"_a, "x_axis"_a = nb::none(),
      R"(A 1 x 1 patch for one taxel of a curved or irregular skin.

position: m, in S. normal: outward, in S, any length but 0. size: (2), m, along x and y of P, or one number for both. x_axis: direction in S whose projection is x.)");
}

void bindLaws(nb::module_& module) {
  nb::class_<Winkler> winkler(module, "Winkler", R"(Contact law: elastic foundation.

pressure = max(0, normal_contact_stiffness d^normal_exponent + normal_damping d') where the penetration d > 0.)");
  addTables(winkler, fieldsOf<kWinklerFields>());
  nb::class_<MassSpringDamper> msd(
      module, "MassSpringDamper",
      "Contact law of SkinSim: each taxel is a mass on a spring and a damper, m x'' + damping x' + stiffness x = F.");
  addTables(msd, fieldsOf<kMassSpringDamperFields>());
  nb::class_<DeformationMask> mask(module, "DeformationMask",
                                   "Contact law of RobWorkSim: a mask deforms the surface around each contact; cells saturate.");
  addTables(mask, fieldsOf<kDeformationMaskFields>());
  nb::class_<Proximity> proximity(module, "Proximity", "Contact law of Pezzementi et al.: a taxel reads sensitivity x mean depth x area.");
  addTables(proximity, fieldsOf<kProximityFields>());

  nb::class_<ElasticLayer> layer(module, "ElasticLayer", "Contact law: the skin as an elastic layer, solved on the device.");
  nb::enum_<ElasticLayer::Base>(layer, "Base", "Support of the layer.")
      .value("HALF_SPACE", ElasticLayer::Base::kHalfSpace, "Infinitely deep.")
      .value("BONDED", ElasticLayer::Base::kBonded, "As thick as the skin, bonded to a rigid base.");
  addTables(layer, fieldsOf<kElasticLayerFields>(), std::tuple(field("base", &ElasticLayer::base, "Support.")),
            fieldsOf<kLayerSolverFields>());
  nb::class_<LuGre> lugre(module, "LuGre", "Contact law of OpenGrasp: elastic foundation with LuGre friction.");
  addTables(lugre, fieldsOf<kLuGreFields>());
}

void bindSkin(nb::module_& module) {
  nb::class_<Friction> friction(module, "Friction", "Stick-slip friction with memory. The default is none.");
  addFields(friction, tableField<kFrictionFields, 1>(), tableField<kFrictionFields, 0>());
  nb::class_<RelaxationTerm> relaxation(
      module, "RelaxationTerm", "One term of the skin's viscoelastic relaxation: k(t) = k(0) [1 - sum fraction (1 - e^(-t / time))].");
  addTables(relaxation, fieldsOf<kRelaxationFields>());
  nb::class_<Skin> skin(module, "Skin", "The skin.");
  addCheckedTables(skin, kAskForUnits, fieldsOf<kSkinFields>(),
                   std::tuple(field("law", &Skin::law, "Contact law."), field("friction", &Skin::friction, "Stick-slip friction.")),
                   fieldsOf<kMarginFields>(), std::tuple(field("relaxation", &Skin::relaxation, "0 to 4 terms.")));
  module.def("max_depth_error_of", &maxDepthErrorOf, "skin"_a,
             "Bound of the simplification of meshes (m, max_depth_error of load_mesh()) at which pressures change by 4 kPa at most; at "
             "most 10 um.");
  module.def("foundation_of", &foundationOf, "skin"_a, "Elastic foundation of the skin: its own for Winkler, a linear one for other laws.");
}

void bindPsf(nb::module_& module) {
  nb::class_<Psf> psf(module, "Psf",
                      R"(Point spread function: a kernel over the taxels of each patch, or a Gaussian of the distance along the skin.

The default is no spread.)");
  nb::enum_<Psf::Normalization>(psf, "Normalization", "Normalisation of the spread image.")
      .value("PER_SOURCE", Psf::Normalization::kPerSource, "Keeps the sum of forces, at borders too.")
      .value("NONE", Psf::Normalization::kNone, "The kernel as it is.");
  addFields(psf, field("size", &Psf::size, "Taxels per side of the kernel, odd, 1 to 9."),
            field("kernel", &Psf::kernel, "(size x size), row-major, >= 0."), field("normalization", &Psf::normalization, "Normalisation."),
            field("sigma", &Psf::sigma, "m. If > 0, a Gaussian of the distance along the skin replaces the kernel."),
            field("reach", &Psf::reach, "m, > 0; 0: 3 sigma."));
  module.def(
      "gaussian_psf",
      [](double sigma, int size, const Argument<Psf::Normalization>& normalization) {
        return gaussianPsf(sigma, size, normalization.value);
      },
      "sigma"_a, "size"_a, "normalization"_a = Psf::Normalization::kPerSource,
      "A Gaussian kernel of `sigma` (taxels, > 0), sampled at taxel centres.");
}

void bindReadout(nb::module_& module) {
  nb::class_<CreepTerm> creep(module, "CreepTerm", "One term of the readout's creep: F [1 + sum fraction (1 - e^(-t / time))].");
  addTables(creep, fieldsOf<kCreepFields>());
  nb::class_<CurvePoint> point(module, "CurvePoint", "A point of a piecewise linear readout curve.");
  addFields(point, field("force", &CurvePoint::force, "N, gain F - trigger."),
            field("counts", &CurvePoint::counts, "Counts before output_scale."));
  nb::class_<ThreeAxisReadout> axes(module, "ThreeAxisReadout", R"(Electronics of three-axis taxels: force to signed counts.

counts[a] = clip(round(g sum_b gain[a][b] h_b(F[b]) + noise[a] n), -saturation, saturation), axes x, y, normal.)");
  addTables(
      axes,
      std::tuple(field("gain", &ThreeAxisReadout::gain, "(3, 3), counts/N: output axis x axis of force; cross-talk off the diagonal.")),
      fieldsOf<kThreeAxisFields>());
  nb::class_<Readout> readout(module, "Readout", R"(Electronics: force after the spread to counts, per taxel.

x = gain F - trigger; y = sum of curve[m] x^(m+1); counts = clip(round(output_scale y / (1 + y / curve_limit) + noise), 0, saturation).)");
  addTables(
      readout,
      std::tuple(field("curve", &Readout::curve, "counts / N^(m+1), 1 to 5 terms; increasing over the range used."),
                 field("curve_points", &Readout::curve_points, "Piecewise linear curve from (0, 0); replaces `curve`."),
                 field("curve_limit", &Readout::curve_limit, "Asymptote in counts; 0: none."), tableField<kOutputFields, 0>(),
                 derivedField("trigger", &Readout::trigger, &defaultTrigger, "N, smallest visible force; None: three deviations of noise."),
                 tableField<kOutputFields, 2>(), field("saturation", &Readout::saturation, "Counts, 1 to 2^adc_bits - 1.")),
      fieldsOf<kNoiseFields>(),
      std::tuple(field("taxel_gain", &Readout::taxel_gain, "(num_taxels), >= 0; empty: 1."),
                 field("taxel_trigger", &Readout::taxel_trigger, "(num_taxels), N; empty: `trigger`."),
                 field("calibrated_gain", &Readout::calibrated_gain, "(num_taxels), >= 0, by which ridge_edge_angle divides; empty: 1."),
                 field("three_axis", &Readout::three_axis, "Electronics for shear, or None. Needs a skin with friction."),
                 field("hysteresis_strength", &Readout::hysteresis_strength, "(num_elements), each >= 0, sum < 1."),
                 field("hysteresis_width", &Readout::hysteresis_width, "(num_elements), N, >= 0."),
                 field("creep", &Readout::creep, "0 to 4 terms.")),
      fieldsOf<kTimeFields>(), fieldsOf<kImperfectionFields>());
}

// (num_taxels, 3), an array of its own.
nb::ndarray<nb::numpy, double, nb::shape<-1, 3>> rowsOf(const std::vector<Vector3>& rows) {
  auto* const copy = new std::vector<Vector3>(rows);
  const nb::capsule owner(copy, [](void* p) noexcept { delete static_cast<std::vector<Vector3>*>(p); });
  return {copy->data()->data(), {copy->size(), 3}, owner};
}

void bindModelOfSensor(nb::module_& module) {
  nb::enum_<DepthSampling>(module, "DepthSampling", "What the depth of a sample is.")
      .value("POINT", DepthSampling::kPoint, "The depth at the middle of its cell.")
      .value("AREA", DepthSampling::kArea, "The mean depth over its cell.");
  nb::class_<Sensor> sensor(module, "Sensor", "A sensor model: taxels on patches, the skin above them, the electronics that read them.");
  addTables(sensor,
            std::tuple(field("name", &Sensor::name, "Name in messages and data sets."),
                       field("patches", &Sensor::patches, "Patches, at least one.")),
            fieldsOf<kSensorFields>(),
            std::tuple(field("depth_sampling", &Sensor::depth_sampling, "Depth of a sample."), field("skin", &Sensor::skin, "Skin."),
                       field("psf", &Sensor::psf, "Point spread function."), field("readout", &Sensor::readout, "Electronics.")),
            fieldsOf<kFrameRateFields>());
  sensor.def_prop_ro("num_taxels", &numTaxels, "Number of taxels of all patches.")
      .def_prop_ro(
          "taxel_positions", [](const Sensor& self) { return rowsOf(taxelPositions(self)); }, nb::rv_policy::automatic,
          "(num_taxels, 3), m, centres of all taxels in S, in storage order.")
      .def_prop_ro(
          "taxel_normals", [](const Sensor& self) { return rowsOf(taxelNormals(self)); }, nb::rv_policy::automatic,
          "(num_taxels, 3), unit normals of all taxels in S.");
  module.def("load_sensor", &loadSensor, "file"_a, nb::call_guard<WithoutGil>(),
             "Reads a sensor file. Raises InputError with file, line, column and key.");
  module.def("sensor_text", &sensorText, "sensor"_a, "notes"_a = std::map<std::string, std::string>{},
             "Text of a sensor file, all settings in SI units; load_sensor() reads it as the same sensor. notes: comments by key.");
  module.def("check_sensor", &checkSensor, "sensor"_a, "Raises InputError with the field, its value and what is allowed.");
  module.def("nominal_force", &nominalForce, "readout"_a, "counts"_a, "Force (N) that reads `counts` on the nominal curve.");
}

}  // namespace

void bindSensor(nb::module_& module) {
  bindPatch(module);
  bindLaws(module);
  bindSkin(module);
  bindPsf(module);
  bindReadout(module);
  bindModelOfSensor(module);
}

}  // namespace taxelsim::python
