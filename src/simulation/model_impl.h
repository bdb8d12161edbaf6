// Implementation of Model: its data, and every pass that a frame may consist of.
#pragma once

#include <optional>

#include "simulation/model_data.h"
#include "simulation/passes/candidates.h"
#include "simulation/passes/contact.h"
#include "simulation/passes/contact_features.h"
#include "simulation/passes/contacts.h"
#include "simulation/passes/deformation_mask.h"
#include "simulation/passes/elastic_layer.h"
#include "simulation/passes/heights.h"
#include "simulation/passes/image.h"
#include "simulation/passes/integer_features.h"
#include "simulation/passes/load_search.h"
#include "simulation/passes/place.h"
#include "simulation/passes/servo.h"
#include "simulation/passes/tactile_jacobian.h"
#include "simulation/passes/taxel_laws.h"
#include "simulation/passes/three_axis.h"

namespace taxelsim {

// Passes refer to the data and to each other, so it must not move. Threads: immutable except for the passes' caches of kernels, which any
// thread may use.
struct Model::Impl {
  // Throws as the constructor of Model, and Error(kInput) for a tuning that is not allowed.
  Impl(const Device& device, const ModelOptions& options, const Tuning& tuning);
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  ModelData data;
  TilePlan tiles;
  ContactPass contact;
  CandidatePasses candidates;
  std::optional<HeightsPass> heights;  // of the law elastic_layer, as the next
  std::optional<ElasticLayerPass> elastic_layer;
  TaxelLawPasses taxel_laws;
  std::optional<DeformationMaskPass> deformation_mask;  // of this law
  ImagePass image;
  ThreeAxisPass three_axis;
  LoadSearchPass load_search;
  ContactsPass contacts;
  ContactFeaturePasses contact_features;
  TactileJacobianPasses tactile_jacobian;
  IntegerFeaturesPass integer_features;
  ServoPass servo;
  PlacePass place;
};

}  // namespace taxelsim
