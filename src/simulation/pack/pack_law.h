// Contact law -> its variant of the contact pass and the numbers that it is compiled with.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <string>
#include <vector>

#include "shared/batch.h"
#include "taxelsim/sensor.h"

namespace taxelsim {

// A pass over the taxels between contact and image.
struct TaxelPass {
  enum class Owner { kTaxel, kInstance, kTile };

  std::string kernel;
  std::span<const std::uint32_t> spirv;
  Owner owner = Owner::kTaxel;  // of an invocation
};

// A pass, and the same for workgroups that are one vector, shaders/driver/barrier.glsl.
struct Spirv {
  std::span<const std::uint32_t> any, lockstep;
};

struct PackedLaw {
  std::string kernel;  // of the contact pass
  Spirv spirv;
  float reach = 0;                          // up to which height over the skin surfaces matter, m
  std::array<float, 3> parameters{};        // LAW_0 .. LAW_2 of shaders/contact.comp
  bool has_state = false;                   // the law needs every sample's depth of the step before
  bool has_bristles = false;                // shear is the law's own, shaders/skin/laws/lugre.glsl
  std::array<float, 6> bristles{};          // BRISTLE_STIFFNESS .. STRIBECK_VELOCITY of shaders/contact.comp
  std::vector<TaxelPass> taxel_passes{};    // in order
  std::array<float, 2> taxel_parameters{};  // LAW_0, LAW_1 of shaders/common/taxel_pass.glsl
  bool whole_array = false;                 // taxels that nothing reaches may have a force
};

// `reach`: of an elastic layer, gaps that matter in thicknesses.
PackedLaw packLaw(const Skin& skin, float reach);

// What a step of `dt` s does to the force in a taxel's spring (N) and its rate (N/s), about rest: exp(A dt) of MassSpringDamper, by rows;
// of other laws zeros.
std::array<float, 4> transitionOf(const ContactLaw& law, double dt);

// What a step of `dt` s does to a skin that relaxes, into the record's rows for that.
void packRelaxation(std::span<const RelaxationTerm> terms, double dt, layout::StepRecord& record);

// The mask of DeformationMask on this sensor: (9 x num_taxels) pairs of source (as bits) and weight.
std::vector<glm::vec2> packMask(const Sensor& sensor);

}  // namespace taxelsim
