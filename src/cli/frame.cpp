// `taxelsim frame`: presses objects on one sensor and prints one frame.
#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <numeric>
#include <optional>
#include <span>

#include "base/vector3.h"
#include "cli/activity.h"
#include "cli/commands.h"
#include "cli/contacts_file.h"
#include "cli/frame_figure.h"
#include "cli/frame_objects.h"
#include "cli/frame_output.h"
#include "cli/pose_argument.h"
#include "cli/print.h"
#include "cli/scene_options.h"
#include "geometry/unit_check.h"
#include "taxelsim/device.h"
#include "taxelsim/error.h"
#include "taxelsim/model.h"
#include "taxelsim/simulator.h"

namespace taxelsim::cli {

namespace {

constexpr double kDefaultStep = 0.01;  // s, for sensors with a frame at every step
constexpr int kSlideSteps = 10;        // of --slide

struct FrameArguments {
  std::string sensor, contacts, picture, device;
  ObjectArguments objects;
  bool json = false;
  bool validation = false;
};

void show(const FrameArguments& arguments, const Sensor& sensor, const FrameView& frame, const std::string& what) {
  if (arguments.json)
    printOut("{}\n", frameJson(sensor, frame));
  else
    printFrame(sensor, frame);
  if (arguments.picture.empty()) return;
  writeFrameFigure(arguments.picture, sensor, frame, what);
  spdlog::info("wrote {}", arguments.picture);
}

double stepOf(const Sensor& sensor) {
  return sensor.frame_rate > 0 ? 1 / sensor.frame_rate : kDefaultStep;
}

Device openDevice(const FrameArguments& arguments) {
  return Device::open({.device = arguments.device, .validation = arguments.validation});
}

int runContacts(const FrameArguments& arguments) {
  const ObjectArguments& objects = arguments.objects;
  if (!objects.objects.empty() || !objects.poses.empty() || !objects.rotations.empty() || objects.load || !objects.slide.empty() ||
      objects.has_mesh_options) {
    throw Error(ErrorKind::kInput, "--contacts excludes --object, --pose, --rpy-deg, --load, --slide, --scale and --up-axis");
  }
  const std::vector<ContactPoint> contacts = readContacts(arguments.contacts);
  const Sensor sensor = loadSensor(arguments.sensor);
  Activity activity("computing a frame");
  Simulator simulator(Model(openDevice(arguments), {.sensor = sensor}), {.outputs = {.penetration_depth = false,
                                                                                     .taxel_counts = sensor.readout.three_axis.has_value(),
                                                                                     .contact_features = true,
                                                                                     .clean_contact_features = true},
                                                                         .max_contacts = std::max(1, static_cast<int>(contacts.size())),
                                                                         .max_regions = kMaxRegions});
  simulator.setContacts(0, contacts);
  simulator.step(stepOf(sensor));
  const FrameView frame = simulator.read();
  activity.end();
  show(arguments, sensor, frame, fmt::format("{} contacts", contacts.size()));
  return kExitOk;
}

// "cube is 20 x 20 x 20 mm". The sides of a half-space are infinite.
std::string sizeText(const Object& object) {
  const Bounds bounds = boundsOf(object);
  const Vector3 mm = scale(1e3, subtract(bounds.max, bounds.min));
  const bool is_tiny = std::max({mm[0], mm[1], mm[2]}) < 1e3 * kShortestPlausible;
  return fmt::format("{} is {:.3g} x {:.3g} x {:.3g} mm{}", object.name, mm[0], mm[1], mm[2], is_tiny ? "; was it scaled twice?" : "");
}

// The load search ends at the deepest contact that the skin allows, whose force is the largest possible.
void checkLoad(double load, const GroundTruthView& truth, const std::vector<Object>& objects) {
  if (truth.load_reached[0]) return;
  const float carried = -truth.contact_wrench[2];
  std::vector<std::string> sizes;
  for (const Object& object : objects) sizes.push_back(sizeText(object));
  if (carried > 0) {
    throw Error(ErrorKind::kInput, fmt::format("--load {} N is out of reach: pressed through the skin, the objects carry {:.4g} N: {}",
                                               load, carried, fmt::join(sizes, ", ")));
  }
  throw Error(ErrorKind::kInput,
              fmt::format("--load {} N is out of reach: no object touches a sample point of the skin; it lies outside of "
                          "the array, or is thinner than the distance of the points: {}",
                          load, fmt::join(sizes, ", ")));
}

void warnOfOverPenetration(const Sensor& sensor, const GroundTruthView& truth) {
  if (!(truth.over_penetration[0] > 0)) return;
  spdlog::warn("over-penetration: {:.3g} % of the sample points are deeper than the skin is thick ({:.4g} mm) and count as that deep",
               100 * truth.over_penetration[0], 1e3 * sensor.skin.thickness);
}

// The frame with the objects at `X_SO`, or the last one after they have slid by `slide`, if any, m in S.
FrameView pressAndSlide(Simulator& simulator, std::span<const int> ids, std::vector<Pose> X_SO, const Vector3& slide) {
  const double step = stepOf(simulator.model().sensor());
  simulator.setObjects(ids, X_SO);
  simulator.step(step);
  FrameView frame = simulator.read();
  for (int k = 0; k < kSlideSteps && slide != Vector3{0, 0, 0}; ++k) {
    for (Pose& pose : X_SO) pose.position = taxelsim::add(pose.position, scale(1.0 / kSlideSteps, slide));
    simulator.setObjects(ids, X_SO);
    simulator.step(step);
    frame = simulator.read();
  }
  return frame;
}

int runObjects(const FrameArguments& arguments) {
  const ObjectPlan plan(arguments.objects);
  const Vector3 slide = arguments.objects.slide.empty() ? Vector3{0, 0, 0} : parseSlide(arguments.objects.slide);
  Sensor sensor = loadSensor(arguments.sensor);
  sensor.readout.delay = sensor.readout.low_pass_time = 0;  // the single frame shows the steady state
  ModelOptions options{.sensor = sensor, .objects = {}};
  Activity activity("loading objects");
  options.objects = plan.loadObjects(sensor);
  std::vector<int> ids(options.objects.size());
  std::iota(ids.begin(), ids.end(), 0);

  activity.next("computing a frame");
  const Model model(openDevice(arguments), options);
  Simulator simulator(
      model, {.num_instances = 1,
              .num_slots = static_cast<int>(ids.size()),
              .outputs = {.taxel_counts = sensor.readout.three_axis.has_value(), .contact_features = true, .clean_contact_features = true},
              .max_regions = kMaxRegions});
  const std::optional<double>& load = arguments.objects.load;
  simulator.setLoad(0, load ? static_cast<float>(*load) : kPoseDriven);
  const FrameView frame = pressAndSlide(simulator, ids, plan.posesOf(options.objects), slide);
  activity.end();
  if (load) checkLoad(*load, frame.ground_truth, options.objects);
  warnOfOverPenetration(sensor, frame.ground_truth);
  std::vector<std::string> names;
  for (const Object& object : options.objects) names.push_back(object.name);
  show(arguments, sensor, frame, fmt::format("{}", fmt::join(names, ", ")));
  return kExitOk;
}

void addObjectOptions(CLI::App& command, ObjectArguments& objects) {
  command
      .add_option("--object", objects.objects,
                  "Mesh file, or sphere:R, cylinder:R,L, capsule:R,L, box:X,Y,Z, half_space, cone:R,H, torus:MAJOR,MINOR in m; may be "
                  "repeated")
      ->allow_extra_args(false)
      ->type_name("SPEC");
  command
      .add_option("--pose", objects.poses,
                  "\"x y z\" or \"x y z qw qx qy qz\" of each object in the sensor frame, m and a unit quaternion. Default with --load: "
                  "the lowest point of the object over the origin")
      ->allow_extra_args(false)
      ->type_name("POSE");
  command
      .add_option("--rpy-deg", objects.rotations, "\"roll pitch yaw\" of each object, degrees about the fixed axes x, y, z in this order")
      ->allow_extra_args(false)
      ->type_name("RPY");
  command.add_option("--load", objects.load, "Move the objects along z until they press with this force, N")->type_name("N");
  command
      .add_option("--slide", objects.slide,
                  "\"x y\": then slide the objects by so much in the sensor frame, m; friction of the skin, if it has any, makes shear")
      ->type_name("XY");
  command.add_option("--scale", objects.mesh.scale, "Metres per unit of the mesh files: 0.001 for files in millimetres")
      ->capture_default_str()
      ->each([&objects](const std::string&) { objects.has_mesh_options = true; })
      ->type_name("M");
  command
      .add_option_function<std::string>(
          "--up-axis",
          [&objects](const std::string& axis) {
            objects.mesh.up_axis = axis == "x" ? UpAxis::kX : axis == "y" ? UpAxis::kY : UpAxis::kZ;
            objects.has_mesh_options = true;
          },
          "Axis of the mesh files that becomes z: x, y or z. Default: z")
      ->check(silent(CLI::IsMember({"x", "y", "z"})))
      ->type_name("AXIS");
}

}  // namespace

void addFrame(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("frame", "Press objects or contact points against one sensor and print what it reports");
  command->footer(
      "Examples:\n  taxelsim frame --sensor scenes/sensors/wts0614_soft_cover.yaml --object sphere:0.01 --pose \"0 0 0.0095\"\n"
      "  taxelsim frame --sensor scenes/sensors/wts0614_soft_cover.yaml --object cylinder:0.008,0.04 --rpy-deg \"90 0 0\" --load 5\n"
      "Poses are of the object in the sensor frame, whose z points out of the skin: here the sphere is 0.5 mm deep.");
  const auto arguments = std::make_shared<FrameArguments>();
  command->add_option("--sensor", arguments->sensor, "Sensor file (YAML)")->required()->type_name("FILE");
  addObjectOptions(*command, arguments->objects);
  CLI::Option* contacts =
      command
          ->add_option(
              "--contacts", arguments->contacts,
              "Instead of objects: contact points from another engine, lines of \"x,y,z,normal_force\", m in the sensor frame and N")
          ->type_name("FILE");
  command->add_flag("--json", arguments->json, "Print JSON, all numbers in full");
  command->add_option("--png", arguments->picture, "Figure of the tactile image to write (PNG)")->check(requirePngName)->type_name("FILE");
  addDeviceOptions(*command, arguments->device, arguments->validation);
  command->callback([=, &action] { action = [=] { return contacts->count() > 0 ? runContacts(*arguments) : runObjects(*arguments); }; });
}

}  // namespace taxelsim::cli
