// `taxelsim frame`: one sensor, one moment, everything it reports.
#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>

#include "cli/commands.h"
#include "cli/contacts_file.h"
#include "figures/tactile_figure.h"
#include "figures/taxel_chart.h"
#include "taxelsim/device.h"
#include "taxelsim/error.h"
#include "taxelsim/model.h"
#include "taxelsim/simulator.h"

namespace taxelsim::cli {

using namespace figures;

namespace {

constexpr double kQuaternionTolerance = 1e-3;  // as Simulator::setObjects() has it
constexpr double kDefaultStep = 0.01;          // s, for sensors that give a frame at every step

struct Arguments {
  std::string sensor, contacts, picture, device;
  std::vector<std::string> objects, poses;
  double load = 0;
  bool json = false;
  bool validation = false;
};

// Seven numbers between blanks or commas, whatever the locale.
Pose parsePose(const std::string& text) {
  const auto refuse = [&](const std::string& why) -> Error {
    return Error(ErrorKind::kInput, "--pose \"" + text + "\": " + why + "; a pose is \"x y z qw qx qy qz\", m and a unit quaternion");
  };
  std::array<double, 7> numbers{};
  std::size_t count = 0;
  const char* place = text.data();
  const char* const end = text.data() + text.size();
  while (true) {
    while (place != end && (*place == ' ' || *place == ',' || *place == '\t')) ++place;
    if (place == end) break;
    if (count == numbers.size()) throw refuse("has more than 7 numbers");
    const auto [next, problem] = std::from_chars(*place == '+' ? place + 1 : place, end, numbers[count]);
    const bool whole_word = next == end || *next == ' ' || *next == ',' || *next == '\t';
    if (problem != std::errc() || !whole_word || !std::isfinite(numbers[count]))
      throw refuse(fmt::format("number {} cannot be read", count + 1));
    place = next;
    ++count;
  }
  if (count != numbers.size()) throw refuse(fmt::format("has {} numbers, not 7", count));
  const double norm = std::sqrt(numbers[3] * numbers[3] + numbers[4] * numbers[4] + numbers[5] * numbers[5] + numbers[6] * numbers[6]);
  if (!(std::abs(norm - 1) <= kQuaternionTolerance)) throw refuse(fmt::format("the quaternion has length {:.6g}, not 1 within 1e-3", norm));
  return {{numbers[0], numbers[1], numbers[2]}, {numbers[3] / norm, numbers[4] / norm, numbers[5] / norm, numbers[6] / norm}};
}

template <typename T>
nlohmann::ordered_json arrayOf(std::span<const T> values) {
  return nlohmann::ordered_json(std::vector<T>(values.begin(), values.end()));
}

// Per-taxel values, `width` to a taxel: rows of rows for one grid, else a plain list.
template <typename T>
nlohmann::ordered_json taxelsOf(const Sensor& sensor, std::span<const T> values, std::size_t width = 1) {
  const auto taxel = [&](std::size_t t) -> nlohmann::ordered_json {
    if (width == 1) return values[t];
    return arrayOf(values.subspan(t * width, width));
  };
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  const std::size_t num_taxels = values.size() / width;
  const std::size_t num_cols = sensor.patches.size() == 1 ? static_cast<std::size_t>(sensor.patches[0].num_cols) : 0;
  for (std::size_t t = 0; t < num_taxels; ++t) {
    if (num_cols == 0) {
      list.push_back(taxel(t));
      continue;
    }
    if (t % num_cols == 0) list.push_back(nlohmann::ordered_json::array());
    list.back().push_back(taxel(t));
  }
  return list;
}

// Those of one row.
void addFeatures(nlohmann::ordered_json& json, const FeatureView& features, std::size_t row = 0) {
  json["total_force"] = features.total_force[row];
  json["peak_force"] = features.peak_force[row];
  json["center_of_pressure"] = arrayOf(features.center_of_pressure.subspan(3 * row, 3));
  json["second_moments"] = arrayOf(features.second_moments.subspan(3 * row, 3));
  json["eigenvalues"] = arrayOf(features.eigenvalues.subspan(2 * row, 2));
  json["edge_angle"] = features.edge_angle[row];
  json["edge_confidence"] = features.edge_confidence[row];
  json["contact_area"] = features.contact_area[row];
}

constexpr const char* kContactTypes[] = {"none", "point", "edge", "area"};

const char* contactTypeOf(const ContactFeatureView& contact, std::size_t row) {
  return kContactTypes[static_cast<std::size_t>(contact.contact_type[row])];
}

// The regions that have rows; the last rows may be empty.
std::size_t numRegionRows(const ContactFeatureView& contact) {
  return std::min(static_cast<std::size_t>(contact.num_regions[0]), static_cast<std::size_t>(kMaxRegions));
}

nlohmann::ordered_json contactRow(const ContactFeatureView& contact, std::size_t row) {
  nlohmann::ordered_json json;
  json["contact_type"] = contactTypeOf(contact, row);
  json["patch"] = static_cast<int>(contact.patch[row]);
  addFeatures(json, contact, row);
  json["windowed_edge_angle"] = contact.windowed_edge_angle[row];
  json["windowed_edge_confidence"] = contact.windowed_edge_confidence[row];
  json["tilt"] = arrayOf(contact.tilt.subspan(2 * row, 2));
  json["tilt_confidence"] = contact.tilt_confidence[row];
  return json;
}

nlohmann::ordered_json contactJson(const ContactFeatureView& contact) {
  nlohmann::ordered_json json;
  json["sensor"] = contactRow(contact, 0);
  json["patches"] = nlohmann::ordered_json::array();
  const auto num_patches = static_cast<std::size_t>(contact.num_patches);
  for (std::size_t p = 0; p < num_patches; ++p) json["patches"].push_back(contactRow(contact, 1 + p));
  json["num_regions"] = static_cast<int>(contact.num_regions[0]);
  json["regions"] = nlohmann::ordered_json::array();
  for (std::size_t r = 0; r < numRegionRows(contact); ++r) json["regions"].push_back(contactRow(contact, 1 + num_patches + r));
  return json;
}

nlohmann::ordered_json asJson(const Sensor& sensor, const FrameView& frame) {
  nlohmann::ordered_json json;
  json["sensor"] = sensor.name;
  json["tactile_image"] = taxelsOf(sensor, frame.tactile_image);
  addFeatures(json, frame);
  json["saturated"] = frame.saturated[0];
  json["contact"] = contactJson(frame.contact);
  const GroundTruthView& truth = frame.ground_truth;
  nlohmann::ordered_json& clean = json["ground_truth"];
  clean["tactile_normal_force"] = taxelsOf(sensor, truth.tactile_normal_force);
  clean["tactile_shear_force"] = taxelsOf(sensor, truth.tactile_shear_force, 2);
  if (!truth.penetration_depth.empty()) clean["penetration_depth"] = taxelsOf(sensor, truth.penetration_depth);
  addFeatures(clean, truth);
  clean["contact"] = contactJson(truth.contact);
  clean["contact_wrench"] = arrayOf(truth.contact_wrench);
  clean["over_penetration"] = truth.over_penetration[0];
  clean["load_offset"] = truth.load_offset[0];
  clean["load_reached"] = truth.load_reached[0];
  clean["off_array_load"] = truth.off_array_load[0];
  clean["off_array_contacts"] = truth.off_array_contacts[0];
  if (!truth.contact_residual.empty()) {
    clean["contact_residual"] = truth.contact_residual[0];
    clean["contact_iterations"] = truth.contact_iterations[0];
  }
  return json;
}

void printImage(const Sensor& sensor, std::span<const std::uint32_t> image) {
  const auto width = std::to_string(*std::max_element(image.begin(), image.end())).size();
  std::size_t taxel = 0;
  if (isTaxelList(sensor)) {
    constexpr std::size_t kTaxelsPerLine = 16;
    fmt::print("tactile_image, counts ({} taxels, {} a line)\n", image.size(), kTaxelsPerLine);
    for (; taxel < image.size(); ++taxel)
      fmt::print("{} {:>{}}{}", taxel % kTaxelsPerLine == 0 ? " " : "", image[taxel], width,
                 (taxel + 1) % kTaxelsPerLine == 0 || taxel + 1 == image.size() ? "\n" : "");
    return;
  }
  for (const GridPatch& patch : sensor.patches) {
    fmt::print("tactile_image{}{}, counts ({} rows along x, {} columns along y)\n", patch.name.empty() ? "" : " of ", patch.name,
               patch.num_rows, patch.num_cols);
    for (int i = 0; i < patch.num_rows; ++i) {
      std::string line = " ";
      for (int j = 0; j < patch.num_cols; ++j) line += fmt::format(" {:>{}}", image[taxel++], width);
      fmt::print("{}\n", line);
    }
  }
}

std::string numbersText(std::span<const float> values) {
  std::string text;
  for (const float value : values) text += fmt::format("{}{:.6g}", text.empty() ? "" : "  ", value == 0 ? 0 : value);  // no "-0"
  return text;
}

void printText(const Sensor& sensor, const FrameView& frame) {
  printImage(sensor, frame.tactile_image);
  const GroundTruthView& truth = frame.ground_truth;
  const auto line = [](const char* name, const char* unit, std::span<const float> measured, std::span<const float> clean) {
    fmt::print("{:<20} {:<7} {:<40} {}\n", name, unit, numbersText(measured), numbersText(clean));
  };
  fmt::print("\n{:<20} {:<7} {:<40} {}\n", "feature", "unit", "measured", "ground truth");
  line("total_force", "N", frame.total_force, truth.total_force);
  line("peak_force", "N", frame.peak_force, truth.peak_force);
  line("center_of_pressure", "m", frame.center_of_pressure, truth.center_of_pressure);
  line("second_moments", "m^2", frame.second_moments, truth.second_moments);
  line("eigenvalues", "m^2", frame.eigenvalues, truth.eigenvalues);
  line("edge_angle", "rad", frame.edge_angle, truth.edge_angle);
  line("edge_confidence", "1", frame.edge_confidence, truth.edge_confidence);
  line("contact_area", "m^2", frame.contact_area, truth.contact_area);
  const ContactFeatureView &measured = frame.contact, &true_contact = truth.contact;
  line("windowed_edge_angle", "rad", measured.windowed_edge_angle.first(1), true_contact.windowed_edge_angle.first(1));
  line("tilt", "rad", measured.tilt.first(2), true_contact.tilt.first(2));
  line("tilt_confidence", "1", measured.tilt_confidence.first(1), true_contact.tilt_confidence.first(1));
  fmt::print("{:<20} {:<7} {:<40} {}\n", "contact_type", "", contactTypeOf(measured, 0), contactTypeOf(true_contact, 0));
  line("num_regions", "1", measured.num_regions, true_contact.num_regions);
  line("saturated", "1", frame.saturated, {});
  const auto clean = [&](const char* name, const char* unit, std::span<const float> values) {
    fmt::print("{:<20} {:<7} {:<40} {}\n", name, unit, "", numbersText(values));
  };
  clean("contact_wrench", "N, N m", truth.contact_wrench);
  clean("over_penetration", "1", truth.over_penetration);
  clean("load_offset", "m", truth.load_offset);
  const bool of_layer = !truth.contact_residual.empty();
  const bool of_contacts = truth.penetration_depth.empty();
  if (of_layer || of_contacts) clean("off_array_load", "N", truth.off_array_load);
  if (of_contacts) clean("off_array_contacts", "1", truth.off_array_contacts);
  if (!of_layer) return;
  clean("contact_residual", "1", truth.contact_residual);
  clean("contact_iterations", "1", truth.contact_iterations);
}

// One panel a patch, or all taxels of a list together.
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
    fmt::print("{}\n", asJson(sensor, frame).dump(2));
  else
    printText(sensor, frame);
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
    throw Error(ErrorKind::kInput, "--contacts comes instead of --object, --pose and --load");
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
  sensor.readout.delay = sensor.readout.low_pass_time = 0;  // the one frame shows what they would settle to
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
  if (load_driven && frame.ground_truth.load_reached[0] == 0) {
    // The search ends at the deepest contact that the skin allows; what that carries is the most there is.
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
  command->add_option("--device", arguments->device, "discrete, integrated, cpu, a number of `taxelsim devices` or part of a name")
      ->type_name("D");
  command->add_flag("--validation", arguments->validation, "Run with Vulkan's validation layers; slow");
  command->callback([=, &action] {
    action = [=] { return contacts->count() > 0 ? runContacts(*arguments, load->count() > 0) : runObjects(*arguments, load->count() > 0); };
  });
}

}  // namespace taxelsim::cli
