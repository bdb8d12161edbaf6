// Contact law -> parameters of the contact pass, its passes over taxels and their parameters.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <string>
#include <vector>

#include "gpu/driver_profile.h"
#include "shared/batch.h"
#include "taxelsim/sensor.h"

namespace taxelsim {

// A pass between contact and image, shaders/passes/taxel_law.h.
struct TaxelPass {
  enum class Owner { kTaxel, kTile };

  std::string kernel;
  gpu::ShaderVariants spirv;
  Owner owner = Owner::kTaxel;  // what an invocation owns
};

struct PackedLaw {
  float reach = 0;                          // surfaces matter up to this height over the skin, m
  std::array<float, 3> parameters{};        // STIFFNESS, EXPONENT, DAMPING of shaders/passes/contact.h
  bool has_state = false;                   // the law needs the depth of every sample in the step before
  bool has_bristles = false;                // shear by shaders/skin/law.glsl
  std::array<float, 6> bristles{};          // BRISTLE_STIFFNESS to STRIBECK_VELOCITY of shaders/passes/contact.h
  std::vector<TaxelPass> taxel_passes{};    // in order
  std::array<float, 2> taxel_parameters{};  // LAW_0, LAW_1 of shaders/passes/taxel_law.h
  bool whole_array = false;                 // taxels that no object reaches may have a force
};

// `reach`: of an elastic layer, gaps that matter in thicknesses.
PackedLaw packLaw(const Skin& skin, float reach);

// exp(A dt), row-major, of MassSpringDamper: the transition of the force in a taxel's spring (N) and its rate (N/s) about rest over a step
// of `dt` s. Zeros for other laws.
std::array<float, 4> transitionOf(const ContactLaw& law, double dt);

// Writes the coefficients of relaxation over a step of `dt` s.
void packRelaxation(std::span<const RelaxationTerm> terms, double dt, layout::StepRecord& record);

// The mask of DeformationMask: (num_sources / 2 x num_taxels x 2) pairs of source (as bits) and weight; num_sources is even, ten on grids.
std::vector<glm::vec2> packMask(const Sensor& sensor);

// (num_taxels): what a source on grids gives to the mask per newton, so that its force stays on the sensor.
std::vector<float> packMaskScale(const Sensor& sensor);

}  // namespace taxelsim
