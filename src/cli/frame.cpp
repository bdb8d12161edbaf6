// `taxelsim frame`: presses objects on one sensor and prints one frame.
#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "cli/commands.h"
#include "cli/contacts_file.h"
#include "cli/frame_output.h"
#include "cli/pose_argument.h"
#include "figures/tactile_figure.h"
#include "figures/taxel_chart.h"
#include "taxelsim/device.h"
#include "taxelsim/error.h"
#include "taxelsim/model.h"
#include "taxelsim/simulator.h"

namespace taxelsim::cli {

using namespace figures;

namespace {

constexpr double kDefaultStep = 0.01;  // s, for sensors with a frame at every step

struct Arguments {
  std::string sensor, contacts, picture, device;
  std::vector<std::string> objects, poses;
  double load = 0;
  bool json = false;
  bool validation = false;
};

// One panel per patch; one panel for a list of taxels.
std::vector<TactilePanel> panelsOf(const Sensor& sensor, const FrameView& frame) {
  std::vector<TactilePanel> panels;
  if (isTaxelList(sensor)) {
    TactilePanel panel;
    panel.values.assign(frame.tactile_image.begin(), frame.tactile_image.end());
    panel.outlines = unrolled(sensor);
    panel.caption = kUnrolled;
    panel.neighbours = false;
    panels.push_back(std::move(panel));
    return panels;
  }
  std::size_t first = 0;
  for (const GridPatch& patch : sensor.patches) {
    TactilePanel panel;
    panel.num_rows = patch.num_rows;
    panel.num_cols = patch.num_cols;
    panel.pitch = patch.pitch;
    const std::size_t count = static_cast<std::size_t>(patch.num_rows) * patch.num_cols;
    for (const std::uint32_t counts : frame.tactile_image.subspan(first, count)) panel.values.push_back(counts);
    first += count;
    panel.title = sensor.patches.size() > 1 ? patch.name : "";
    panel.axes = axesOfImage(panel);
    if (panel.axes && sensor.patches.size() == 1) {
      const Vector3 p_SC_S{frame.center_of_pressure[0], frame.center_of_pressure[1], frame.center_of_pressure[2]};
      const Vector3 p_PC_P = inverse(patch.X_SP) * p_SC_S;
      panel.axes = ContactAxes{{p_PC_P[0], p_PC_P[1]}, frame.edge_angle[0], {frame.eigenvalues[0], frame.eigenvalues[1]}};
    }
    panels.push_back(std::move(panel));
  }
  return panels;
}

void drawFrame(const std::string& file, const Sensor& sensor, const FrameView& frame, const std::string& what) {
  const std::vector<TactilePanel> panels = panelsOf(sensor, frame);
  writeTactileFigure(
      file, panels,
      {.title = fmt::format("{} on {}", what, sensor.name),
       .subtitle = fmt::format("{:.4g} N   angle {:.1f}°   confidence {:.2f}   area {:.3g} mm²", frame.total_force[0],
                               frame.edge_angle[0] * 180 / std::numbers::pi, frame.edge_confidence[0], frame.contact_area[0] * 1e6)});
}

void show(const Arguments& arguments, const Sensor& sensor, const FrameView& frame, const std::string& what) {
  if (arguments.json)
    fmt::print("{}\n", frameJson(sensor, frame));
  else
    printFrame(sensor, frame);
  if (!arguments.picture.empty()) drawFrame(arguments.picture, sensor, frame, what);
}

double stepOf(const Sensor& sensor) {
  return sensor.frame_rate > 0 ? 1 / sensor.frame_rate : kDefaultStep;
}

Device openDevice(const Arguments& arguments) {
  return Device::open({.device = arguments.device, .validation = arguments.validation});
}

int runContacts(const Arguments& arguments, bool load_driven) {
  if (!arguments.objects.empty() || !arguments.poses.empty() || load_driven)
    throw Error(ErrorKind::kInput, "--contacts excludes --object, --pose and --load");
  const std::vector<ContactPoint> contacts = readContacts(arguments.contacts);
  const Sensor sensor = loadSensor(arguments.sensor);
  Simulator simulator(Model(openDevice(arguments), {.sensor = sensor}),
                      {.outputs = {.penetration_depth = false, .contact_features = true, .clean_contact_features = true},
                       .max_contacts = std::max(1, static_cast<int>(contacts.size())),
                       .max_regions = kMaxRegions});
  simulator.setContacts(0, contacts);
  simulator.step(stepOf(sensor));
  show(arguments, sensor, simulator.read(), fmt::format("{} contacts", contacts.size()));
  return kExitOk;
}

int runObjects(const Arguments& arguments, bool load_driven) {
  if (arguments.objects.empty()) throw Error(ErrorKind::kInput, "--object with --pose, or --contacts, is required");
  if (arguments.poses.size() != arguments.objects.size())
    throw Error(ErrorKind::kInput, fmt::format("{} --object but {} --pose: each object needs its pose, in the same order",
                                               arguments.objects.size(), arguments.poses.size()));
  if (arguments.objects.size() > static_cast<std::size_t>(kMaxSlots))
    throw Error(ErrorKind::kInput, fmt::format("{} --object: a sensor can touch at most {}", arguments.objects.size(), kMaxSlots));
  if (load_driven && !(std::isfinite(arguments.load) && arguments.load >= 0))
    throw Error(ErrorKind::kInput, fmt::format("--load {}: must be a force of 0 N or more", arguments.load));
  std::vector<Pose> X_SO;
  for (const std::string& text : arguments.poses) X_SO.push_back(parsePose(text));
  Sensor sensor = loadSensor(arguments.sensor);
  sensor.readout.delay = sensor.readout.low_pass_time = 0;  // the single frame shows the steady state
  ModelOptions options{.sensor = sensor, .objects = {}};
  std::vector<int> ids;
  for (const std::string& text : arguments.objects) {
    ids.push_back(static_cast<int>(ids.size()));
    options.objects.push_back(parseObject(text));
  }

  const Model model(openDevice(arguments), options);
  Simulator simulator(model, {.num_instances = 1,
                              .num_slots = static_cast<int>(ids.size()),
                              .outputs = {.contact_features = true, .clean_contact_features = true},
                              .max_regions = kMaxRegions});
  simulator.setObjects(ids, X_SO);
  simulator.setLoad(0, load_driven ? static_cast<float>(arguments.load) : kPoseDriven);
  simulator.step(stepOf(sensor));
  const FrameView frame = simulator.read();
  if (load_driven && !frame.ground_truth.load_reached[0]) {
    // The search ended at the deepest contact that the skin allows, whose force is the largest possible.
    const float carried = isTaxelList(sensor) ? frame.ground_truth.total_force[0] : -frame.ground_truth.contact_wrench[2];
    throw Error(ErrorKind::kInput, carried > 0
                                       ? fmt::format("--load {} N is out of reach: pressed through the skin, the objects carry {:.4g} N",
                                                     arguments.load, carried)
                                       : fmt::format("--load {} N is out of reach: no object lies over the skin", arguments.load));
  }
  std::vector<std::string> names;
  for (const Object& object : options.objects) names.push_back(object.name);
  show(arguments, sensor, frame, fmt::format("{}", fmt::join(names, ", ")));
  return kExitOk;
}

}  // namespace

void addFrame(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("frame", "Press objects or contact points against one sensor and print what it reports");
  command->footer(
      "Example:\n  taxelsim frame --sensor scenes/sensors/wts0614.yaml --object sphere:0.01 --pose \"0 0 0.0095 1 0 0 0\"\n"
      "Poses are of the object in the sensor frame, whose z points out of the skin: here the sphere is 0.5 mm deep.");
  const auto arguments = std::make_shared<Arguments>();
  command->add_option("--sensor", arguments->sensor, "Sensor file (YAML)")->required()->type_name("FILE");
  command
      ->add_option(
          "--object", arguments->objects,
          "Mesh file, or sphere:R, cylinder:R,L, capsule:R,L, box:X,Y,Z, half_space, cone:R,H, torus:MAJOR,MINOR in m; may be repeated")
      ->allow_extra_args(false)
      ->type_name("SPEC");
  command->add_option("--pose", arguments->poses, "\"x y z qw qx qy qz\" of each object in the sensor frame, m and a unit quaternion")
      ->allow_extra_args(false)
      ->type_name("POSE");
  CLI::Option* contacts =
      command
          ->add_option(
              "--contacts", arguments->contacts,
              "Instead of objects: contact points from another engine, lines of \"x,y,z,normal_force\", m in the sensor frame and N")
          ->type_name("FILE");
  CLI::Option* load =
      command->add_option("--load", arguments->load, "Move the objects along z until they press with this force, N")->type_name("N");
  command->add_flag("--json", arguments->json, "Print JSON, all numbers in full");
  command->add_option("--png", arguments->picture, "Draw the tactile image into this picture")->type_name("FILE");
  command
      ->add_option("--device", arguments->device,
                   "Device: discrete, integrated, cpu, a number from `taxelsim devices`, or part of its name")
      ->type_name("D");
  command->add_flag("--validation", arguments->validation, "Enable the Vulkan validation layers; slow");
  command->callback([=, &action] {
    action = [=] { return contacts->count() > 0 ? runContacts(*arguments, load->count() > 0) : runObjects(*arguments, load->count() > 0); };
  });
}

}  // namespace taxelsim::cli
