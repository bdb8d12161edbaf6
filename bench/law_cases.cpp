#include "law_cases.h"

#include <algorithm>

namespace taxelsim::bench {
namespace {

Skin elasticSkin(const Skin& skin, ElasticLayer::Base base, double margin) {
  return {.thickness = skin.thickness, .law = ElasticLayer{.elastic_modulus = 1e6, .poisson_ratio = 0.49, .base = base}, .margin = margin};
}

}  // namespace

// Long function: a list.
std::vector<LawCase> lawCases() {
  const auto stiffness = [](const Sensor& s) { return foundationOf(s.skin).normal_contact_stiffness; };
  return {
      {"winkler", [](Sensor&) {}},
      {.name = "winkler, damped",
       .change = [](Sensor& s) { std::get<Winkler>(s.skin.law).normal_damping = 1e4; },
       .is_paired = true,
       .is_law = true},
      {.name = "winkler, area", .change = [](Sensor& s) { s.depth_sampling = DepthSampling::kArea; }, .is_paired = true},
      {.name = "mass_spring_damper",
       .change = [=](Sensor& s) { s.skin.law = MassSpringDamper{.normal_contact_stiffness = stiffness(s)}; },
       .is_paired = true,
       .is_law = true},
      {.name = "deformation_mask", .change = [](Sensor& s) { s.skin.law = DeformationMask{}; }, .is_paired = true, .is_law = true},
      {"proximity", [=](Sensor& s) { s.skin.law = Proximity{.sensitivity = stiffness(s)}; }},
      {"winkler, 2 x 2 samples", [](Sensor& s) { s.samples_per_taxel = 2; }},
      {"elastic_layer, half-space, 2 x 2, cold",
       [](Sensor& s) { s.samples_per_taxel = 2, s.skin = elasticSkin(s.skin, ElasticLayer::Base::kHalfSpace, 0); }, true},
      {"elastic_layer, half-space, 2 x 2, cold, ten iterations",
       [](Sensor& s) {
         s.samples_per_taxel = 2, s.skin = elasticSkin(s.skin, ElasticLayer::Base::kHalfSpace, 0);
         std::get<ElasticLayer>(s.skin.law).tolerance = 1e-5;
       },
       true},
      {"elastic_layer, half-space, 2 x 2, sliding",
       [](Sensor& s) { s.samples_per_taxel = 2, s.skin = elasticSkin(s.skin, ElasticLayer::Base::kHalfSpace, 0); }},
      {"elastic_layer, bonded, margin, 2 x 2, sliding",
       [](Sensor& s) { s.samples_per_taxel = 2, s.skin = elasticSkin(s.skin, ElasticLayer::Base::kBonded, 4e-3); }},
      {"elastic_layer, bonded, margin, 2 x 2, sliding, friction",
       [](Sensor& s) {
         s.samples_per_taxel = 2, s.skin = elasticSkin(s.skin, ElasticLayer::Base::kBonded, 4e-3);
         s.skin.friction = {.tangential_stiffness = 1e8, .friction_coefficient = 0.5};
       }},
      {"elastic_layer, bonded, margin, 2 x 2, sliding, relaxation, two terms",
       [](Sensor& s) {
         s.samples_per_taxel = 2, s.skin = elasticSkin(s.skin, ElasticLayer::Base::kBonded, 4e-3);
         s.skin.relaxation = {{.fraction = 0.2, .time = 0.1}, {.fraction = 0.2, .time = 2}};
       }},
      {.name = "lugre",
       .change = [=](Sensor& s) { s.skin.law = LuGre{.normal_contact_stiffness = stiffness(s)}; },
       .is_paired = true,
       .is_law = true},
      {.name = "friction",
       .change = [](Sensor& s) { s.skin.friction = {.tangential_stiffness = 1e8, .friction_coefficient = 0.5}; },
       .is_paired = true},
      {.name = "relaxation, two terms",
       .change =
           [](Sensor& s) {
             s.skin.relaxation = {{.fraction = 0.2, .time = 0.1}, {.fraction = 0.2, .time = 2}};
           },
       .is_paired = true},
      {.name = "readout: low-pass, hysteresis, creep, delay",
       .change =
           [](Sensor& s) {
             s.readout.low_pass_time = 0.01;
             s.readout.hysteresis_strength = {0.1, 0.1};
             s.readout.hysteresis_width = {0.01, 0.1};
             s.readout.creep = {{0.1, 1}, {0.1, 10}};
             s.readout.delay = 2 * kLawCaseStep;
           },
       .is_paired = true},
      {.name = "readout: noise, bias, walk, gain spread, dead taxels",
       .change =
           [](Sensor& s) {
             s.readout.noise = 17;
             s.readout.bias = 5;
             s.readout.random_walk = 1;
             s.readout.gain_spread = 0.05;
             s.readout.dead_taxel_probability = 0.01;
           },
       .is_paired = true},
      {.name = "contact features, no regions", .change = [](Sensor&) {}, .max_regions = 0, .is_paired = true},
      {.name = "contact features, four regions", .change = [](Sensor&) {}, .max_regions = 4, .is_paired = true},
      {.name = "tactile Jacobian", .change = [](Sensor&) {}, .jacobian = true, .is_paired = true},
  };
}

std::optional<LawCase> bothOf(const LawCase& a, const LawCase& b) {
  const bool excluded = (a.is_law && b.is_law) || (a.max_regions >= 0 && b.max_regions >= 0);
  if (!a.is_paired || !b.is_paired || excluded) return {};
  return LawCase{.name = a.name + " + " + b.name,
                 .change = [a = a.change, b = b.change](Sensor& s) { a(s), b(s); },
                 .max_regions = std::max(a.max_regions, b.max_regions),
                 .jacobian = a.jacobian || b.jacobian};
}

}  // namespace taxelsim::bench
