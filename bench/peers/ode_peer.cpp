#include "peers/ode_peer.h"

#include <ode/ode.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <new>
#include <variant>

#include "peers/taxel_stage.h"
#include "peers/threads.h"
#include "reference/skin_mesh.h"
#include "taxelsim/error.h"

namespace taxelsim::bench {
namespace {

constexpr int kMaxContacts = 65535;  // ODE's own limit
constexpr int kSide = 4;             // samples per taxel, per side

// Drops ODE's message about full tables, which it prints at every collision.
void ignoreMessage(int, const char*, va_list) {}

void startEngine() {
  static const bool started = [] {
    dInitODE2(0);
    dAllocateODEDataForThread(dAllocateMaskAll);
    dSetMessageHandler(ignoreMessage);
    return true;
  }();
  static_cast<void>(started);
}

// A mesh for ODE, which keeps pointers into these arrays.
struct OdeShape {
  std::vector<double> vertices;
  std::vector<dTriIndex> corners;
  dTriMeshDataID data = nullptr;
  dGeomID geom = nullptr;

  explicit OdeShape(const Cylinder& cylinder) : geom(dCreateCylinder(nullptr, cylinder.radius, cylinder.length)) {}
  explicit OdeShape(const Mesh& mesh) {
    for (const auto& vertex : mesh.vertices) vertices.insert(vertices.end(), vertex.begin(), vertex.end());
    for (const auto& triangle : mesh.triangles) corners.insert(corners.end(), triangle.begin(), triangle.end());
    data = dGeomTriMeshDataCreate();
    dGeomTriMeshDataBuildDouble(data, vertices.data(), 3 * sizeof(double), static_cast<int>(vertices.size() / 3), corners.data(),
                                static_cast<int>(corners.size()), 3 * sizeof(dTriIndex));
    geom = dCreateTriMesh(nullptr, data, nullptr, nullptr, nullptr);
  }
  ~OdeShape() {
    dGeomDestroy(geom);
    if (data) dGeomTriMeshDataDestroy(data);
  }
  OdeShape(const OdeShape&) = delete;
  OdeShape& operator=(const OdeShape&) = delete;
};

std::unique_ptr<OdeShape> shapeOf(const Object& object) {
  if (const auto* cylinder = std::get_if<Cylinder>(&object.shape)) return std::make_unique<OdeShape>(*cylinder);
  if (const auto* mesh = std::get_if<Mesh>(&object.shape)) return std::make_unique<OdeShape>(*mesh);
  throw Error(ErrorKind::kInput, object.name + ": the ODE peer does meshes and cylinders only");
}

// Head of the memory shared with the workers; ids, poses and forces follow.
struct Board {
  std::atomic<int> next;
  int num_instances;
};

}  // namespace

struct OdePeer::Impl {
  Impl(const Sensor& sensor, OdeCells which, int max, int workers)
      : stage(sensor),
        cells(which),
        per_side(which == OdeCells::kSamples ? kSide : 1),
        max_instances(max),
        num_workers(threadsOf(workers)) {}
  ~Impl();

  void share();
  void startWorkers();
  [[noreturn]] void work(int asked, int done);
  void collide(int instance);

  TaxelStage stage;
  OdeCells cells;
  int per_side;  // cells of the sensor's mesh per taxel
  int max_instances, num_workers;
  std::unique_ptr<OdeShape> skin;
  std::vector<std::unique_ptr<OdeShape>> objects;

  std::size_t shared_bytes = 0;
  void* shared = nullptr;
  Board* board = nullptr;
  int* ids = nullptr;
  Pose* poses = nullptr;
  float* forces = nullptr;  // (num_instances x num_taxels), N

  struct Worker {
    pid_t process;
    int ask, answer;  // pipes to and from the worker
  };
  std::vector<Worker> workers;

  // Used by the workers.
  std::vector<dContactGeom> contacts;
  std::vector<float> depth_sum, depth_count;  // (num_taxels)
  std::vector<std::size_t> touched;           // taxels

  std::vector<TaxelStage::Scratch> scratches;  // (num_workers)
};

OdePeer::Impl::~Impl() {
  for (const Worker& worker : workers) {
    close(worker.ask);
    close(worker.answer);
  }
  for (const Worker& worker : workers) {
    // Another worker may hold the write end of its pipe open.
    kill(worker.process, SIGTERM);
    waitpid(worker.process, nullptr, 0);
  }
  if (shared) munmap(shared, shared_bytes);
}

void OdePeer::Impl::share() {
  const auto count = static_cast<std::size_t>(max_instances);
  const auto aligned = [](std::size_t bytes) { return (bytes + 63) / 64 * 64; };
  const std::size_t at_ids = aligned(sizeof(Board)), at_poses = at_ids + aligned(count * sizeof(int));
  const std::size_t at_forces = at_poses + aligned(count * sizeof(Pose));
  shared_bytes = at_forces + count * static_cast<std::size_t>(stage.numTaxels()) * sizeof(float);
  shared = mmap(nullptr, shared_bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (shared == MAP_FAILED) {
    shared = nullptr;
    throw Error(ErrorKind::kDevice, "the ODE peer cannot share " + std::to_string(shared_bytes) + " bytes with its workers");
  }
  auto* bytes = static_cast<std::byte*>(shared);
  board = new (bytes) Board{};
  ids = reinterpret_cast<int*>(bytes + at_ids);
  poses = reinterpret_cast<Pose*>(bytes + at_poses);
  forces = reinterpret_cast<float*>(bytes + at_forces);
}

void OdePeer::Impl::startWorkers() {
  contacts.resize(kMaxContacts);
  depth_sum.resize(static_cast<std::size_t>(stage.numTaxels()));
  depth_count.resize(static_cast<std::size_t>(stage.numTaxels()));
  for (int w = 0; w < num_workers; ++w) {
    int ask[2], answer[2];
    if (pipe(ask) != 0 || pipe(answer) != 0)
      throw Error(ErrorKind::kDevice, std::string("the ODE peer has no pipes: ") + std::strerror(errno));
    const pid_t process = fork();
    if (process < 0) throw Error(ErrorKind::kDevice, std::string("the ODE peer cannot start a worker: ") + std::strerror(errno));
    if (process == 0) {
      prctl(PR_SET_PDEATHSIG, SIGTERM);
      close(ask[1]);
      close(answer[0]);
      work(ask[0], answer[1]);
    }
    close(ask[0]);
    close(answer[1]);
    workers.push_back({process, ask[1], answer[0]});
  }
}

// Main loop of a worker: waits for a byte, processes instances until none is left, answers with a byte.
void OdePeer::Impl::work(int asked, int done) {
  char word = 0;
  while (read(asked, &word, 1) == 1) {
    for (int i; (i = board->next.fetch_add(1)) < board->num_instances;) collide(i);
    if (write(done, &word, 1) != 1) break;
  }
  _exit(0);
}

void OdePeer::Impl::collide(int instance) {
  const auto num_taxels = static_cast<std::size_t>(stage.numTaxels());
  float* force = forces + static_cast<std::size_t>(instance) * num_taxels;
  std::fill_n(force, num_taxels, 0.0f);
  const Pose& X_SO = poses[instance];
  dGeomID object = objects[static_cast<std::size_t>(ids[instance])]->geom;
  const dQuaternion q{X_SO.rotation[0], X_SO.rotation[1], X_SO.rotation[2], X_SO.rotation[3]};
  dGeomSetPosition(object, X_SO.position[0], X_SO.position[1], X_SO.position[2]);
  dGeomSetQuaternion(object, q);
  const int num_contacts = dCollide(skin->geom, object, kMaxContacts, contacts.data(), sizeof(dContactGeom));

  const int rows = stage.numRows(), cols = stage.numCols();
  const double per_x = 1 / static_cast<double>(stage.pitchX()), per_y = 1 / static_cast<double>(stage.pitchY());
  touched.clear();
  for (int c = 0; c < num_contacts; ++c) {
    const dContactGeom& contact = contacts[static_cast<std::size_t>(c)];
    const int row = static_cast<int>(std::floor(contact.pos[0] * per_x + rows / 2.0));
    const int col = static_cast<int>(std::floor(contact.pos[1] * per_y + cols / 2.0));
    if (row < 0 || row >= rows || col < 0 || col >= cols) continue;
    const auto taxel = static_cast<std::size_t>(row * cols + col);
    const double depth = std::clamp(contact.depth * std::abs(contact.normal[2]), 0.0, static_cast<double>(stage.thickness()));
    if (depth_count[taxel] == 0) touched.push_back(taxel);
    depth_sum[taxel] += static_cast<float>(depth);
    depth_count[taxel] += 1;
  }
  for (const std::size_t taxel : touched) {
    force[taxel] = stage.taxelStiffness() * depth_sum[taxel] / depth_count[taxel];
    depth_sum[taxel] = depth_count[taxel] = 0;
  }
}

OdePeer::OdePeer(const Sensor& sensor, const std::vector<Object>& objects, OdeCells cells, int max_instances, int num_workers)
    : impl_(std::make_unique<Impl>(sensor, cells, max_instances, num_workers)) {
  startEngine();
  Impl& impl = *impl_;
  impl.skin = std::make_unique<OdeShape>(reference::skinMesh(sensor.patches[0], impl.per_side));
  for (const Object& object : objects) impl.objects.push_back(shapeOf(object));
  for (int t = 0; t < impl.num_workers; ++t) impl.scratches.push_back(impl.stage.scratch());
  impl.share();
  impl.startWorkers();
}

OdePeer::~OdePeer() = default;

std::string OdePeer::name() const {
  return impl_->cells == OdeCells::kSamples ? "ode_samples" : "ode_taxels";
}

std::string OdePeer::what() const {
  return std::string("ODE contacts, uncapped, sensor mesh at ") + (impl_->cells == OdeCells::kSamples ? "sample" : "taxel") + " resolution";
}

void OdePeer::run(std::span<const int> ids, std::span<const Pose> X_SO, PeerFrame& frame) {
  Impl& impl = *impl_;
  if (X_SO.size() > static_cast<std::size_t>(impl.max_instances))
    throw Error(ErrorKind::kInput, "more instances than the ODE peer was made for");
  std::copy(ids.begin(), ids.end(), impl.ids);
  std::copy(X_SO.begin(), X_SO.end(), impl.poses);
  impl.board->num_instances = static_cast<int>(X_SO.size());
  impl.board->next = 0;
  for (const Impl::Worker& worker : impl.workers) {
    if (write(worker.ask, "", 1) != 1) throw Error(ErrorKind::kDevice, "a worker of the ODE peer is gone");
  }
  for (const Impl::Worker& worker : impl.workers) {
    char word = 0;
    if (read(worker.answer, &word, 1) != 1) throw Error(ErrorKind::kDevice, "a worker of the ODE peer is gone");
  }

  const TaxelStage& stage = impl.stage;
  frame.resize(X_SO.size(), static_cast<std::size_t>(stage.numTaxels()));
  inThreads(impl.num_workers, static_cast<int>(X_SO.size()), 16, [&](int thread, int instance) {
    const auto i = static_cast<std::size_t>(instance);
    TaxelStage::Scratch& scratch = impl.scratches[static_cast<std::size_t>(thread)];
    const float* force = impl.forces + i * static_cast<std::size_t>(stage.numTaxels());
    for (int row = 0; row < stage.numRows(); ++row)
      for (int col = 0; col < stage.numCols(); ++col) stage.force(scratch, row, col) = *force++;
    stage.finish(scratch, 0, stage.numRows() - 1, i, frame);
  });
}

}  // namespace taxelsim::bench
