#include "peers/mujoco_peer.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <array>
#include <sstream>
#include <variant>

#include "peers/taxel_stage.h"
#include "peers/threads.h"
#include "taxelsim/error.h"

namespace taxelsim::bench {
namespace {

struct ModelRelease {
  void operator()(mjModel* model) const { mj_deleteModel(model); }
};
struct DataRelease {
  void operator()(mjData* data) const { mj_deleteData(data); }
};
using ModelPointer = std::unique_ptr<mjModel, ModelRelease>;
using DataPointer = std::unique_ptr<mjData, DataRelease>;

static_assert(mjVERSION_HEADER >= 3009000, "MuJoCo before 3.9: the tactile sensor reports no depth");

constexpr int kSide = 4;             // samples per taxel, per side
constexpr double kPadHeight = 0.01;  // m; more than any penetration

std::string objText(const Mesh& mesh) {
  std::ostringstream out;
  out.precision(9);
  for (const auto& [x, y, z] : mesh.vertices) out << "v " << x << ' ' << y << ' ' << z << '\n';
  for (const auto& [a, b, c] : mesh.triangles) out << "f " << a + 1 << ' ' << b + 1 << ' ' << c + 1 << '\n';
  return out.str();
}

// The skin: `per_side` x `per_side` vertices per taxel.
Mesh skinMesh(const GridPatch& patch, int per_side) {
  const int rows = patch.num_rows * per_side, cols = patch.num_cols * per_side;
  Mesh mesh;
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < cols; ++j)
      mesh.vertices.push_back({static_cast<float>((i - (rows - 1) / 2.0) * patch.pitch[0] / per_side),
                               static_cast<float>((j - (cols - 1) / 2.0) * patch.pitch[1] / per_side), 0});
  }
  const auto vertex = [&](int i, int j) { return static_cast<std::uint32_t>(i * cols + j); };
  for (int i = 0; i + 1 < rows; ++i) {
    for (int j = 0; j + 1 < cols; ++j) {
      mesh.triangles.push_back({vertex(i, j), vertex(i + 1, j), vertex(i, j + 1)});
      mesh.triangles.push_back({vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)});
    }
  }
  return mesh;
}

// The pad is a box: its contacts select the objects that the sensor evaluates. The skin on it does not collide. A mesh collides by its
// convex hull; a second geom without collision gives it the distance field.
std::string modelText(const GridPatch& patch, const Object& object) {
  std::ostringstream out;
  out.precision(9);
  const auto* cylinder = std::get_if<Cylinder>(&object.shape);
  out << "<mujoco><asset><mesh name=\"skin\" file=\"skin.obj\" inertia=\"shell\"/>";
  if (!cylinder) out << "<mesh name=\"object\" file=\"object.obj\"/>";
  out << "</asset><worldbody><body name=\"pad\"><geom type=\"box\" pos=\"0 0 " << -kPadHeight / 2 << "\" size=\""
      << patch.num_rows * patch.pitch[0] / 2 << ' ' << patch.num_cols * patch.pitch[1] / 2 << ' ' << kPadHeight / 2 << "\"/>"
      << "<geom name=\"skin\" type=\"mesh\" mesh=\"skin\" contype=\"0\" conaffinity=\"0\"/></body>"
      << "<body name=\"object\"><freejoint/><inertial pos=\"0 0 0\" mass=\"0.1\" diaginertia=\"1e-5 1e-5 1e-5\"/>";
  if (cylinder) {
    out << "<geom type=\"cylinder\" size=\"" << cylinder->radius << ' ' << cylinder->length / 2 << "\"/>";
  } else {
    out << "<geom type=\"mesh\" mesh=\"object\"/><geom type=\"sdf\" mesh=\"object\" contype=\"0\" conaffinity=\"0\"/>";
  }
  out << "</body></worldbody><sensor><tactile mesh=\"skin\" geom=\"skin\"/></sensor></mujoco>";
  return out.str();
}

ModelPointer modelOf(const GridPatch& patch, const Object& object, int per_side) {
  const auto* mesh = std::get_if<Mesh>(&object.shape);
  if (!mesh && !std::holds_alternative<Cylinder>(object.shape))
    throw Error(ErrorKind::kInput, object.name + ": the MuJoCo peer does meshes and cylinders only");
  mjVFS files;
  mj_defaultVFS(&files);
  const auto add = [&](const char* name, const std::string& text) {
    mj_addBufferVFS(&files, name, text.data(), static_cast<int>(text.size()));
  };
  add("skin.obj", objText(skinMesh(patch, per_side)));
  if (mesh) add("object.obj", objText(*mesh));
  add("model.xml", modelText(patch, object));
  std::array<char, 1000> message{};
  ModelPointer model(mj_loadXML("model.xml", &files, message.data(), static_cast<int>(message.size())));
  mj_deleteVFS(&files);
  if (!model) {
    std::string reason(message.data());
    std::replace(reason.begin(), reason.end(), '\n', ' ');
    throw Error(ErrorKind::kInput, object.name + ": MuJoCo refuses the model: " + reason);
  }
  return model;
}

}  // namespace

struct MujocoPeer::Impl {
  TaxelStage stage;
  int per_side;  // points per taxel
  int num_threads;
  std::vector<ModelPointer> models;  // (num_objects)

  struct Worker {
    std::vector<DataPointer> data;  // (num_objects)
    TaxelStage::Scratch taxels;
  };
  std::vector<Worker> workers;  // (num_threads)

  void press(const mjModel& model, mjData& data, const Pose& X_SO, TaxelStage::Scratch& taxels) const;
};

void MujocoPeer::Impl::press(const mjModel& model, mjData& data, const Pose& X_SO, TaxelStage::Scratch& taxels) const {
  std::copy(X_SO.position.begin(), X_SO.position.end(), data.qpos);
  std::copy(X_SO.rotation.begin(), X_SO.rotation.end(), data.qpos + 3);
  mj_kinematics(&model, &data);
  mj_comPos(&model, &data);
  mj_collision(&model, &data);
  // The stage of the sensor differs between MuJoCo versions.
  switch (model.sensor_needstage[0]) {
    case mjSTAGE_POS:
      mj_sensorPos(&model, &data);
      break;
    case mjSTAGE_VEL:
      mj_sensorVel(&model, &data);
      break;
    default:
      mj_sensorAcc(&model, &data);
  }
  const mjtNum* depth = data.sensordata;
  const int cols = stage.numCols() * per_side;
  const float point_stiffness = stage.taxelStiffness() / static_cast<float>(per_side * per_side);
  for (int i = 0; i < stage.numRows() * per_side; ++i) {
    for (int j = 0; j < cols; ++j) {
      const auto deep = static_cast<float>(*depth++);
      if (deep > 0) stage.force(taxels, i / per_side, j / per_side) += point_stiffness * std::min(deep, stage.thickness());
    }
  }
}

MujocoPeer::MujocoPeer(const Sensor& sensor, const std::vector<Object>& objects, MujocoPoints points, int num_threads)
    : impl_(
          std::make_unique<Impl>(Impl{TaxelStage(sensor), points == MujocoPoints::kSamples ? kSide : 1, threadsOf(num_threads), {}, {}})) {
  for (const Object& object : objects) impl_->models.push_back(modelOf(sensor.patches[0], object, impl_->per_side));
  for (int t = 0; t < impl_->num_threads; ++t) {
    Impl::Worker& worker = impl_->workers.emplace_back();
    for (const ModelPointer& model : impl_->models) worker.data.emplace_back(mj_makeData(model.get()));
    worker.taxels = impl_->stage.scratch();
  }
}

MujocoPeer::~MujocoPeer() = default;

std::string MujocoPeer::name() const {
  return impl_->per_side == 1 ? "mujoco" : "mujoco_samples";
}

std::string MujocoPeer::what() const {
  return std::string("MuJoCo ") + mj_versionString() + " tactile sensor, " +
         (impl_->per_side == 1 ? "one point per taxel" : "every sample");
}

void MujocoPeer::run(std::span<const int> ids, std::span<const Pose> X_SO, PeerFrame& frame) {
  Impl& impl = *impl_;
  frame.resize(X_SO.size(), static_cast<std::size_t>(impl.stage.numTaxels()));
  inThreads(impl.num_threads, static_cast<int>(X_SO.size()), 4, [&](int thread, int instance) {
    const auto i = static_cast<std::size_t>(instance), object = static_cast<std::size_t>(ids[i]);
    Impl::Worker& worker = impl.workers[static_cast<std::size_t>(thread)];
    impl.press(*impl.models[object], *worker.data[object], X_SO[i], worker.taxels);
    impl.stage.finish(worker.taxels, 0, impl.stage.numRows() - 1, i, frame);
  });
}

}  // namespace taxelsim::bench
