#include "simulation/pack_law.h"

#include "contact_winkler.spv.h"
#include "contact_winkler_pairs.spv.h"

namespace taxelsim {
namespace {

// One a law.
struct Pack {
  PackedLaw operator()(const Winkler& law) const {
    return {.kernel = "contact_winkler",
            .spirv = k_contact_winkler_spirv,
            .spirv_pairs = k_contact_winkler_pairs_spirv,
            .parameters = {static_cast<float>(law.normal_contact_stiffness), static_cast<float>(law.normal_exponent),
                           static_cast<float>(law.normal_damping)},
            .has_state = law.normal_damping > 0};
  }
};

}  // namespace

PackedLaw packLaw(const ContactLaw& law) {
  return std::visit(Pack{}, law);
}

}  // namespace taxelsim
