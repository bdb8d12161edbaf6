#include "simulation/pack/pack_law.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "mass_spring_damper_variants.h"
#include "proximity.spv.h"
#include "sensor/deformation_mask.h"
#include "shared/model.h"

namespace taxelsim {
namespace {

// What each law adds to its foundation.
struct AddLaw {
  PackedLaw& packed;
  float reach;  // m

  void operator()(const Winkler&) const {}
  void operator()(const MassSpringDamper&) const {
    packed.taxel_passes = {{"mass_spring_damper", k_mass_spring_damper_variants}};
    packed.whole_array = true;
  }
  void operator()(const DeformationMask& law) const { packed.taxel_parameters = {static_cast<float>(law.saturation_pressure)}; }
  void operator()(const Proximity&) const {
    packed.taxel_passes = {{"proximity", {k_proximity_spirv, k_proximity_spirv}, TaxelPass::Owner::kTile}};
  }
  void operator()(const ElasticLayer&) const { packed = {.reach = reach}; }
  void operator()(const LuGre& law) const {
    packed.has_bristles = true;
    packed.bristles = {static_cast<float>(law.bristle_stiffness), static_cast<float>(law.bristle_damping),
                       static_cast<float>(law.viscous_friction),  static_cast<float>(law.static_friction),
                       static_cast<float>(law.coulomb_friction),  static_cast<float>(law.stribeck_velocity)};
  }
};

}  // namespace

PackedLaw packLaw(const Skin& skin, float reach) {
  const Winkler foundation = foundationOf(skin);
  PackedLaw packed{.parameters = {static_cast<float>(foundation.normal_contact_stiffness), static_cast<float>(foundation.normal_exponent),
                                  static_cast<float>(foundation.normal_damping)},
                   .has_state = foundation.normal_damping > 0};
  std::visit(AddLaw{packed, reach * static_cast<float>(skin.thickness)}, skin.law);
  return packed;
}

std::array<float, 4> transitionOf(const ContactLaw& law, double dt) {
  const MassSpringDamper* taxel = std::get_if<MassSpringDamper>(&law);
  if (taxel == nullptr) return {};
  // y" + 2 decay y' + rate^2 y = 0: exp(-decay t) (cos, sin / w) below critical damping, (cosh, sinh / w) above it.
  const double square = taxel->stiffness / taxel->mass;
  const double decay = taxel->damping / (2 * taxel->mass);
  const double w = std::sqrt(std::abs(square - decay * decay));
  double c = std::exp(-decay * dt);
  double s = c * dt;
  if (w * dt > 1e-6 && square > decay * decay) {
    s = c * std::sin(w * dt) / w;
    c *= std::cos(w * dt);
  } else if (w * dt > 1e-6) {
    // decay - w without cancellation; neither exponential grows.
    const double slow = std::exp(-square / (decay + w) * dt);
    const double fast = std::exp(-(decay + w) * dt);
    c = (slow + fast) / 2;
    s = (slow - fast) / (2 * w);
  }
  return {static_cast<float>(c + decay * s), static_cast<float>(s), static_cast<float>(-square * s), static_cast<float>(c - decay * s)};
}

void packRelaxation(std::span<const RelaxationTerm> terms, double dt, layout::StepRecord& record) {
  double settled = 1, added = 0;
  for (std::size_t m = 0; m < terms.size(); ++m) {
    const auto [fraction, time] = terms[m];
    const double x = dt / time;
    const double fade = std::exp(-x);
    const double growth = fraction * (x > 0 ? -std::expm1(-x) / x : 1);
    const int row = static_cast<int>(m);
    record.relaxation_fade[row] = static_cast<float>(fade);
    record.relaxation_fade_rest[row] = static_cast<float>(fade - static_cast<double>(static_cast<float>(fade)));
    record.relaxation_growth[row] = static_cast<float>(growth);
    record.relaxation_fraction[row] = static_cast<float>(fraction);
    settled -= fraction;
    added += growth;
  }
  settled = std::max(settled, 0x1p-53);  // a sum just below 1, rounded in another order
  record.relaxation.x = static_cast<float>(settled);
  record.relaxation.y = static_cast<float>(settled + added);
}

namespace {

struct GridMask {
  std::vector<std::vector<MaskSource>> sources;  // of each taxel
  std::vector<float> scale;                      // of each source: 1 / the part of the mask that stays on the sensor
};

GridMask maskOfGrids(const Sensor& sensor) {
  // By the number of steps to the neighbour.
  constexpr std::array<double, 3> kWeights{layout::kMaskMiddle, layout::kMaskSide, layout::kMaskCorner};
  GridMask mask;
  mask.sources.resize(static_cast<std::size_t>(numTaxels(sensor)));
  int first = 0;
  for (const GridPatch& patch : sensor.patches) {
    const auto forNeighbours = [&](int i, int j, const auto& visit) {
      for (int a = std::max(-1, -i); a <= std::min(1, patch.num_rows - 1 - i); ++a) {
        for (int b = std::max(-1, -j); b <= std::min(1, patch.num_cols - 1 - j); ++b) {
          visit(first + (i + a) * patch.num_cols + j + b, kWeights[static_cast<std::size_t>(std::abs(a) + std::abs(b))]);
        }
      }
    };
    for (int source = 0; source < patch.num_rows * patch.num_cols; ++source) {
      const int i = source / patch.num_cols;
      const int j = source % patch.num_cols;
      double inside = 0;
      forNeighbours(i, j, [&](int, double weight) { inside += weight; });
      mask.scale.push_back(static_cast<float>(1 / inside));
      forNeighbours(i, j, [&](int taxel, double weight) {
        mask.sources[static_cast<std::size_t>(taxel)].push_back({first + source, weight / inside});
      });
    }
    first += patch.num_rows * patch.num_cols;
  }
  return mask;
}

}  // namespace

std::vector<float> packMaskScale(const Sensor& sensor) {
  return maskOfGrids(sensor).scale;
}

std::vector<glm::vec2> packMask(const Sensor& sensor) {
  const std::vector<std::vector<MaskSource>> sources = isTaxelList(sensor) ? maskSources(sensor) : maskOfGrids(sensor).sources;
  std::size_t most = 0;
  for (const std::vector<MaskSource>& list : sources) most = std::max(most, list.size());
  std::vector<glm::vec2> pairs;
  for (std::size_t e = 0; e < most; e += 2) {
    for (std::size_t t = 0; t < sources.size(); ++t) {
      for (std::size_t k = e; k < e + 2; ++k) {
        const MaskSource source = k < sources[t].size() ? sources[t][k] : MaskSource{static_cast<int>(t), 0};
        pairs.emplace_back(std::bit_cast<float>(source.taxel), static_cast<float>(source.weight));
      }
    }
  }
  return pairs;
}

}  // namespace taxelsim
