#include "peers/vector_peer.h"

#include <variant>

#include "peers/taxel_stage.h"
#include "peers/threads.h"
#include "peers/vector_mesh.h"
#include "peers/vector_solids.h"
#include "taxelsim/error.h"

namespace taxelsim::bench {
namespace {

constexpr int kBlock = 16;  // instances per work item of a thread

using VectorShape = std::variant<VectorMesh, VectorPolyhedron, VectorCylinder>;

VectorShape shapeOf(const Object& object) {
  if (const auto* cylinder = std::get_if<Cylinder>(&object.shape)) return VectorCylinder(*cylinder);
  if (const auto* mesh = std::get_if<Mesh>(&object.shape)) {
    if (const auto faces = convexFaces(*mesh, VectorPolyhedron::kMaxFaces)) return VectorPolyhedron(*faces, boundsOf(object));
    return VectorMesh(*mesh);
  }
  throw Error(ErrorKind::kInput, object.name + ": the hand-written frame does meshes and cylinders only");
}

}  // namespace

struct VectorPeer::Impl {
  TaxelStage stage;
  int num_threads;
  std::vector<VectorShape> shapes;

  struct Scratch {
    TaxelStage::Scratch taxels;
    VectorMesh::Scratch mesh;
  };
  std::vector<std::unique_ptr<Scratch>> scratches;  // (num_threads)

  TaxelRange press(const VectorShape& shape, const SampleView& view, Scratch& scratch) const {
    if (const auto* mesh = std::get_if<VectorMesh>(&shape)) return mesh->press(view, stage, scratch.mesh, scratch.taxels);
    if (const auto* body = std::get_if<VectorPolyhedron>(&shape)) return body->press(view, stage, scratch.taxels);
    return std::get<VectorCylinder>(shape).press(view, stage, scratch.taxels);
  }
};

VectorPeer::VectorPeer(const Sensor& sensor, const std::vector<Object>& objects, int num_threads)
    : impl_(std::make_unique<Impl>(Impl{TaxelStage(sensor), threadsOf(num_threads), {}, {}})) {
  for (const Object& object : objects) impl_->shapes.push_back(shapeOf(object));
  for (int t = 0; t < impl_->num_threads; ++t) {
    auto scratch = std::make_unique<Impl::Scratch>();
    scratch->taxels = impl_->stage.scratch();
    for (const VectorShape& shape : impl_->shapes) {
      const auto* mesh = std::get_if<VectorMesh>(&shape);
      if (!mesh) continue;
      VectorMesh::Scratch made = mesh->scratch(impl_->stage);
      if (made.packs.size() > scratch->mesh.packs.size()) scratch->mesh = std::move(made);
    }
    impl_->scratches.push_back(std::move(scratch));
  }
}

VectorPeer::~VectorPeer() = default;

std::string VectorPeer::what() const {
#if defined(__AVX512F__)
  return "C++ by hand, AVX-512";
#elif defined(__AVX2__)
  return "C++ by hand, AVX2";
#else
  return "C++ by hand, without AVX2";
#endif
}

void VectorPeer::run(std::span<const int> ids, std::span<const Pose> X_SO, PeerFrame& frame) {
  const Impl& impl = *impl_;
  frame.resize(X_SO.size(), static_cast<std::size_t>(impl.stage.numTaxels()));
  inThreads(impl.num_threads, static_cast<int>(X_SO.size()), kBlock, [&](int thread, int instance) {
    const auto i = static_cast<std::size_t>(instance);
    Impl::Scratch& scratch = *impl.scratches[static_cast<std::size_t>(thread)];
    const SampleView view = viewOf(X_SO[i], impl.stage);
    const TaxelRange rows = impl.press(impl.shapes[static_cast<std::size_t>(ids[i])], view, scratch);
    impl.stage.finish(scratch.taxels, rows.first_row, rows.last_row, i, frame);
  });
}

}  // namespace taxelsim::bench
