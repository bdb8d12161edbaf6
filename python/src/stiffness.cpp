// Parameters of contact laws from a material or from one measurement.
#include "taxelsim/stiffness.h"

#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include "structs.h"

namespace taxelsim::python {
namespace {

void bindSources(nb::module_& module) {
  nb::class_<Material> material(module, "Material", "An isotropic linear-elastic material.");
  addFields(material, field("elastic_modulus", &Material::elastic_modulus, "Young's modulus, Pa, > 0."),
            field("poisson_ratio", &Material::poisson_ratio, "0 to below 0.5."));
  nb::class_<KnownModulus> modulus(module, "KnownModulus", R"(Young's modulus of a skin is known.

Springs: confined modulus / thickness, for contacts much wider than the skin is thick; with match_pin_diameter the area stiffness at which
springs carry the force of the layer under a flat pin of this diameter.)");
  addFields(modulus, field("elastic_modulus", &KnownModulus::elastic_modulus, "Pa, > 0."),
            field("match_pin_diameter", &KnownModulus::match_pin_diameter, "m, > 0, at most 128 thicknesses; None: none."));
  nb::class_<PinPress> press(module, "PinPress", "A flat circular pin was pressed into a skin.");
  addFields(press, field("pin_force", &PinPress::pin_force, "N, > 0."),
            field("pin_depth", &PinPress::pin_depth, "m, > 0, at most the thickness."),
            field("pin_diameter", &PinPress::pin_diameter, "m, > 0, at most 128 thicknesses."));
  nb::class_<TaxelStiffness> taxel(module, "TaxelStiffness",
                                   "Force per depth of one whole taxel, with all taxels around it pressed equally deep.");
  addFields(taxel, field("taxel_stiffness", &TaxelStiffness::taxel_stiffness, "N/m, > 0."),
            field("pitch", &TaxelStiffness::pitch, "(2), m, > 0, along x and along y."));
  nb::class_<AreaStiffness> area(module, "AreaStiffness", "Pressure per depth under a stamp much wider than the skin is thick.");
  addFields(area, field("area_stiffness", &AreaStiffness::area_stiffness, "N/m^3, > 0."));
}

}  // namespace

void bindStiffness(nb::module_& module) {
  bindSources(module);
  nb::class_<SkinData> data(module, "SkinData", "What is known about a skin: its material, or one measurement of its stiffness.");
  addFields(data, field("thickness", &SkinData::thickness, "m, 1e-4 to 0.1."),
            field("poisson_ratio", &SkinData::poisson_ratio, "0 to below 0.5."),
            field("stiffness", &SkinData::stiffness, "KnownModulus, PinPress, TaxelStiffness or AreaStiffness."));
  nb::class_<SkinStiffness> stiffness(module, "SkinStiffness", "Stiffness of a skin, as springs and as a bonded layer.");
  addFields(stiffness, field("thickness", &SkinStiffness::thickness, "m."), field("material", &SkinStiffness::material, "Of the layer."),
            field("area_stiffness", &SkinStiffness::area_stiffness, "N/m^3, of springs."),
            field("tangential_stiffness", &SkinStiffness::tangential_stiffness, "N/m^3, shear modulus / thickness."));
  module.def("shore_a_modulus", &shoreAModulus, "shore_a"_a,
             "Young's modulus (Pa) of rubber of a Shore A hardness, 20 to 90; Gent (1958).");
  module.def("shear_modulus", &shearModulus, "material"_a, "E / (2 (1 + nu)), Pa.");
  module.def("confined_modulus", &confinedModulus, "material"_a, "E (1 - nu) / ((1 + nu) (1 - 2 nu)), Pa.");
  module.def("layer_pin_stiffness", &layerPinStiffness, "material"_a, "thickness"_a, "pin_diameter"_a,
             "Force per depth (N/m) of a rigid flat circular pin on a layer bonded to a rigid base, without friction under the pin.");
  module.def("skin_stiffness", &skinStiffness, "data"_a,
             "Stiffness that follows from `data`. Raises InputError with the field, its value and what is allowed.");
  module.def(
      "skins_of", &skinsOf, "stiffness"_a, "friction_coefficient"_a = 0.0,
      "A skin of this stiffness under each contact law: Winkler, MassSpringDamper, DeformationMask, Proximity, ElasticLayer, LuGre.");
  module.def("pin_force", &pinForce, "skin"_a, "pin_diameter"_a, "depth"_a,
             "Force (N) under a flat circular pin at `depth` (m, 0 to the thickness), at rest; what the taxels read for Proximity.");
  module.def("pin_depth", &pinDepth, "skin"_a, "pin_diameter"_a, "force"_a,
             "Depth (m) at which pin_force() is `force` (N, >= 0); may exceed the thickness.");
}

}  // namespace taxelsim::python
