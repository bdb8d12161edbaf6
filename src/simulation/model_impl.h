// What a Model holds on the device.
#pragma once

#include <array>
#include <map>
#include <mutex>
#include <optional>
#include <vector>

#include "gpu/buffer.h"
#include "gpu/kernel.h"
#include "shared/candidates.h"
#include "simulation/faster_paths.h"
#include "simulation/pack/pack_contact_features.h"
#include "simulation/pack/pack_law.h"
#include "simulation/pack/pack_layer.h"
#include "simulation/pack/pack_sensor.h"
#include "simulation/tuning.h"
#include "taxelsim/model.h"

namespace taxelsim {

inline constexpr std::uint32_t kNoSearch = 0;
inline constexpr std::uint32_t kSearchInTile = 1;
inline constexpr std::uint32_t kSearchOverTiles = 2;
inline constexpr std::uint32_t kSearchEnded = 3;

struct Model::Impl {
  Impl(const Device& of, const ModelOptions& options, const Tuning& tuning);

  Device device;
  Sensor sensor;
  std::vector<Object> objects;
  std::vector<Bounds> bounds;  // of the objects, in O; the endless ones cut at 1 m
  PackedSensor packed;
  std::optional<PackedLayer> layer;  // of a law that is solved over all samples at once
  // What the contact pass works on: the sensor, or the nodes of its layer as taxels.
  Sensor contact_sensor;
  PackedSensor contact_packed;
  PackedLaw law;
  PackedContactFeatures packed_contact;
  std::uint32_t kinds = 0;         // bit per kind of object
  std::uint32_t triangles_of = 0;  // bit 0: meshes of small triangles, bit 1: of large ones
  std::uint32_t num_taxels = 0;
  std::uint32_t contact_workgroup = 0;
  std::uint32_t image_workgroup = 0;
  int image_workgroup_wanted = 0;  // by the caller
  std::uint32_t layer_workgroup = 0;
  std::uint32_t contact_repeat = 1;  // tiles that a workgroup does one after another
  std::uint32_t image_team = 1;      // invocations that share an instance in the image pass
  std::uint32_t image_repeat = 1;    // instances that such a team does one after another
  std::uint32_t image_partials = 1;  // partial sums of the image pass's teams

  std::uint32_t num_faces = 1;         // of each polyhedron
  std::uint32_t groups_per_batch = 0;  // of clusters, in the contact pass
  FasterPaths faster = fasterPaths();
  gpu::Buffer object_records, groups, clusters, quads, faces;
  gpu::Buffer sensor_record, patches, tiles, taxels, spread_rows, spread_scale, mask, influence, planes, neighbours;
  std::uint64_t static_bytes = 0;

  // Passes in the variants that batches need; made when first asked for, kept as long as the model. Safe to call from several threads.
  struct ContactVariant {
    std::uint32_t search = 0;  // kSearch... of shaders/contact.comp
    bool many_slots = false;
    bool with_depth = false;                                  // penetration_depth is wanted
    bool with_shear = false;                                  // tactile_shear_force is wanted, of a sensor with friction
    bool with_jacobian = false;                               // what a tactile Jacobian is made from is wanted
    std::uint32_t list = layout::kNumLists;                   // of instances that it goes through; all
    auto operator<=>(const ContactVariant&) const = default;  // NOLINT(modernize-use-nullptr): clang-tidy 14 misreads it
  };
  const gpu::Kernel& contactKernel(const ContactVariant& variant) const;
  // Tiles that a workgroup of it does one after another; a load search in a tile has turns enough for one.
  std::uint32_t contactRepeat(const ContactVariant& variant) const { return variant.search == kSearchInTile ? 1 : contact_repeat; }
  // Whether batches of one slot keep candidates while no instance is driven by load: shaders/keep_candidates.comp.
  bool keeps_candidates = false;
  struct CandidatePasses {
    gpu::Kernel keep, find;
  };
  const CandidatePasses& candidatePasses(bool with_jacobian) const;
  gpu::Buffer no_work;  // what the lists of work start from
  struct ImageVariant {
    bool random = false;                                    // some instance draws noise or gains
    bool whole_array = false;                               // taxels that nothing reaches may have a force
    bool with_normal = false;                               // tactile_normal_force is wanted
    bool with_shear = false;                                // tactile_shear_force is wanted, of a sensor with friction
    auto operator<=>(const ImageVariant&) const = default;  // NOLINT(modernize-use-nullptr): the same
  };
  const gpu::Kernel& imageKernel(const ImageVariant& variant) const;
  std::uint32_t imagesPerWorkgroup() const { return image_workgroup / image_team * image_repeat; }
  const gpu::Kernel& loadKernel() const;
  const std::vector<gpu::Kernel>& taxelKernels(bool with_shear) const;  // of the law's taxel passes
  // Workgroups of such a pass over `num_instances`.
  std::uint32_t taxelGroups(const TaxelPass& pass, std::uint32_t num_instances) const;
  // Contacts from another engine instead of objects: shaders/contacts.comp, with the workgroups and teams of the image pass.
  std::uint32_t contactsRepeat(int max_contacts) const;  // instances that a team does one after another
  const gpu::Kernel& contactsKernel(std::uint32_t repeat) const;
  bool hasFriction() const { return taxelsim::hasFriction(sensor.skin); }
  bool relaxes() const { return !sensor.skin.relaxation.empty(); }
  struct LayerVariant {
    bool loads = false;  // some instance is driven by load
    bool many_slots = false;
    bool with_depth = false;  // penetration_depth is wanted
    bool with_shear = false;  // tactile_shear_force is wanted, of a sensor with friction
    bool with_jacobian = false;
    auto operator<=>(const LayerVariant&) const = default;  // NOLINT(modernize-use-nullptr): the same
  };
  const gpu::Kernel& layerKernel(const LayerVariant& variant) const;
  struct ContactFeatureVariant {
    bool clean = false;  // of the clean forces, else of the image
    int max_regions = 0;
    auto operator<=>(const ContactFeatureVariant&) const = default;  // NOLINT(modernize-use-nullptr): the same
  };
  struct ContactFeaturePasses {
    gpu::Kernel regions, features;
    std::uint32_t instances_per_workgroup, parts_per_workgroup;
  };
  const ContactFeaturePasses& contactFeatures(const ContactFeatureVariant& variant) const;
  // Tactile Jacobian: of every taxel, through a law's mask, of the features.
  struct JacobianVariant {
    bool clean = false;                                        // of the clean forces, else as the readout has them
    bool random = false;                                       // some instance draws gains
    auto operator<=>(const JacobianVariant&) const = default;  // NOLINT(modernize-use-nullptr): the same
  };
  struct JacobianPass {
    gpu::Kernel features;
    std::uint32_t parts_per_workgroup;
  };
  bool masksForces() const { return std::holds_alternative<DeformationMask>(sensor.skin.law); }
  const std::vector<gpu::Kernel>& taxelJacobian()
      const;  // shaders/taxel_jacobian.comp; under a mask then mask_jacobian.comp, rescale_jacobian.comp
  const JacobianPass& tactileJacobian(const JacobianVariant& variant) const;

 private:
  struct Sizes {
    std::uint32_t workgroup, lanes, repeats;
  };
  static std::vector<gpu::Constant> constants(const Sensor& sensor, const PackedSensor& packed, const Sizes& sizes,
                                              const std::vector<std::uint32_t>& of_the_pass);
  std::span<const std::uint32_t> spirvFor(const Spirv& spirv, std::uint32_t workgroup) const;
  gpu::Kernel makeContactKernel(const ContactVariant& variant) const;
  CandidatePasses makeCandidatePasses(bool with_jacobian) const;
  gpu::Kernel makeImageKernel(const ImageVariant& variant) const;
  gpu::Kernel makeLoadKernel() const;
  gpu::Kernel makeTaxelKernel(const TaxelPass& pass, bool with_shear) const;
  gpu::Kernel makeContactsKernel(std::uint32_t repeat) const;
  gpu::Kernel makeLayerKernel(const LayerVariant& variant) const;
  ContactFeaturePasses makeContactFeatures(const ContactFeatureVariant& variant) const;
  JacobianPass makeTactileJacobian(const JacobianVariant& variant) const;

  mutable std::mutex kernels_mutex_;
  mutable std::map<ContactVariant, gpu::Kernel> contact_;
  mutable std::map<bool, CandidatePasses> candidates_;  // by with_jacobian
  mutable std::map<ImageVariant, gpu::Kernel> image_;
  mutable std::optional<gpu::Kernel> load_;
  mutable std::array<std::vector<gpu::Kernel>, 2> taxel_;  // without shear, with it
  mutable std::map<std::uint32_t, gpu::Kernel> contacts_;
  mutable std::map<LayerVariant, gpu::Kernel> layer_;
  mutable std::map<ContactFeatureVariant, ContactFeaturePasses> contact_features_;
  mutable std::vector<gpu::Kernel> taxel_jacobian_;
  mutable std::map<JacobianVariant, JacobianPass> tactile_jacobian_;
};

// Of the passes over taxels: no invocation waits for another.
inline constexpr std::uint32_t kTaxelWorkgroup = 64;

// Evaluations of the load search over several tiles.
inline constexpr std::uint32_t kLoadEvaluations = 48;

}  // namespace taxelsim
