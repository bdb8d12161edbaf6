#include "scene/sensor_file.h"

#include <algorithm>
#include <limits>
#include <set>

#include "scene/curve_reader.h"
#include "scene/pose_reader.h"
#include "scene/taxel_reader.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

// The numbers of a list, or of a list of rows.
std::vector<double> flatNumbers(const YamlNode& node, const Allowed& allowed, std::vector<std::size_t>& row_lengths) {
  std::vector<double> result;
  for (const YamlNode& item : node.items("a list of numbers, or of rows of numbers")) {
    if (!item.isList()) {
      result.push_back(item.number(allowed));
      continue;
    }
    const std::vector<YamlNode> row = item.items("a row of numbers");
    row_lengths.push_back(row.size());
    for (const YamlNode& number : row) result.push_back(number.number(allowed));
  }
  if (!row_lengths.empty() && node.items("").size() != row_lengths.size()) node.fail("numbers and rows are mixed: either, not both");
  return result;
}

// All of a patch but its name.
GridPatch readGrid(const YamlMap& map, std::string name) {
  GridPatch patch;
  patch.name = std::move(name);
  patch.num_rows = static_cast<int>(map.integer("num_rows", 1, kMaxTaxelsPerSide));
  patch.num_cols = static_cast<int>(map.integer("num_cols", 1, kMaxTaxelsPerSide));
  const Allowed allowed = Allowed::above(0, "m");
  const YamlNode pitch = map.require("pitch", "a number > 0 m, or a list of two");
  if (pitch.isList()) {
    const std::vector<double> numbers = pitch.numbers(allowed, 2);
    patch.pitch = {numbers[0], numbers[1]};
  } else {
    patch.pitch.fill(pitch.number(allowed));
  }
  map.canonical().line("pitch", canonicalList(patch.pitch));
  patch.X_SP = readPose(map, "pose");
  return patch;
}

// The key by which the sensor gives its taxels, if it is not one grid.
std::optional<std::string_view> layoutKey(const YamlMap& map) {
  std::optional<std::string_view> chosen;
  for (const std::string_view key : {"patches", "taxels", "taxel_mesh", "urdf"}) {
    const std::optional<YamlNode> given = map.find(key);
    if (given && chosen) given->fail("stands beside `" + std::string(*chosen) + "`: one of the two");
    if (given) chosen = key;
  }
  if (!chosen) return chosen;
  for (const std::string_view key : {"num_rows", "num_cols", "pitch", "pose"}) {
    const std::optional<YamlNode> beside = map.find(key);
    if (beside) beside->fail("stands beside `" + std::string(*chosen) + (chosen == "patches" ? "`: give it in each patch instead" : "`"));
  }
  return chosen;
}

std::vector<GridPatch> readPatches(const YamlMap& map, const std::filesystem::path& directory) {
  const std::optional<std::string_view> layout = layoutKey(map);
  if (layout == "taxels") return readTaxelList(map);
  if (layout == "taxel_mesh") return readTaxelMesh(map, directory);
  if (layout == "urdf") return readTaxelUrdf(map, directory);
  Canonical& canonical = map.canonical();
  std::vector<GridPatch> patches;
  canonical.open("patches");
  if (const std::optional<YamlNode> list = map.find("patches")) {
    const std::vector<YamlNode> items = list->items("a list of patches");
    if (items.empty()) list->refuse("a list of at least one patch");
    std::set<std::string> names;
    for (const YamlNode& item : items) {
      const YamlMap patch = YamlMap::item(item, {"name", "num_rows", "num_cols", "pitch[_mm]", "pose"}, canonical);
      const std::string name = patch.text("name", "a name", "patch_" + std::to_string(patches.size()));
      if (!names.insert(name).second) item.fail("the name '" + name + "' is taken by an earlier patch");
      patches.push_back(readGrid(patch, name));
    }
  } else {
    const std::string name = "patch_0";
    canonical.openItem();
    canonical.line("name", name);
    patches.push_back(readGrid(map, name));
    canonical.close();
  }
  canonical.close();
  return patches;
}

// The terms of a series: a list of {fraction, time}.
template <typename Read>
void forTerms(const YamlMap& map, std::string_view key, int most, const Read& read) {
  const std::optional<YamlNode> node = map.find(key);
  const std::string what = "a list of at most " + std::to_string(most) + " of {fraction, time}";
  const std::vector<YamlNode> items = node ? node->items(what) : std::vector<YamlNode>{};
  if (items.size() > static_cast<std::size_t>(most)) node->refuse(what);
  if (items.empty()) {
    map.canonical().line(key, "[]");
    return;
  }
  map.canonical().open(key);
  for (const YamlNode& item : items) read(YamlMap::item(item, {"fraction", "time"}, map.canonical()));
  map.canonical().close();
}

Winkler readWinkler(const YamlMap& map) {
  Winkler law;
  law.normal_contact_stiffness = map.number("normal_contact_stiffness", Allowed::above(0, "Pa/m^normal_exponent"));
  law.normal_exponent = map.number("normal_exponent", Allowed::within(1, 3, ""), law.normal_exponent);
  law.normal_damping = map.number("normal_damping", Allowed::atLeast(0, "Pa s/m"), law.normal_damping);
  return law;
}

MassSpringDamper readMassSpringDamper(const YamlMap& map) {
  MassSpringDamper law;
  law.normal_contact_stiffness = map.number("normal_contact_stiffness", Allowed::above(0, "N/m^3"));
  law.mass = map.number("mass", Allowed::above(0, "kg"), law.mass);
  law.stiffness = map.number("stiffness", Allowed::above(0, "N/m"), law.stiffness);
  law.damping = map.number("damping", Allowed::atLeast(0, "N s/m"), law.damping);
  return law;
}

DeformationMask readDeformationMask(const YamlMap& map) {
  DeformationMask law;
  law.normal_contact_stiffness = map.number("normal_contact_stiffness", Allowed::above(0, "N/m^3"), law.normal_contact_stiffness);
  law.saturation_pressure = map.number("saturation_pressure", Allowed::above(0, "Pa"), law.saturation_pressure);
  return law;
}

Proximity readProximity(const YamlMap& map) {
  return {.sensitivity = map.number("sensitivity", Allowed::above(0, "N/m^3"))};
}

ElasticLayer readElasticLayer(const YamlMap& map) {
  ElasticLayer law;
  law.elastic_modulus = map.number("elastic_modulus", Allowed::above(0, "Pa"));
  law.poisson_ratio = map.number("poisson_ratio", Allowed::within(0, 0.5, ""));
  const bool bonded = map.choice("base", {"half_space", "bonded"}, "bonded") == "bonded";
  law.base = bonded ? ElasticLayer::Base::kBonded : ElasticLayer::Base::kHalfSpace;
  law.iterations = static_cast<int>(map.integer("iterations", 1, kMaxLayerIterations, static_cast<std::uint64_t>(law.iterations)));
  law.tolerance = map.number("tolerance", Allowed::within(1e-5, 0.1, ""), law.tolerance);
  return law;
}

LuGre readLuGre(const YamlMap& map) {
  LuGre law;
  law.normal_contact_stiffness = map.number("normal_contact_stiffness", Allowed::above(0, "N/m^3"));
  law.bristle_stiffness =
      map.number("bristle_stiffness", {.min = 0, .max = kMaxBristle, .above_min = true, .unit = "1/m"}, law.bristle_stiffness);
  law.bristle_damping = map.number("bristle_damping", Allowed::within(0, kMaxBristle, "s/m"), law.bristle_damping);
  law.viscous_friction = map.number("viscous_friction", Allowed::within(0, kMaxBristle, "s/m"), law.viscous_friction);
  law.static_friction = map.number("static_friction", Allowed::within(kMinLuGreFriction, kMaxFrictionCoefficient, ""), law.static_friction);
  law.coulomb_friction =
      map.number("coulomb_friction", Allowed::within(kMinLuGreFriction, kMaxFrictionCoefficient, ""), law.coulomb_friction);
  law.stribeck_velocity = map.number("stribeck_velocity", Allowed::above(0, "m/s"), law.stribeck_velocity);
  return law;
}

// Laws by name, their keys, and how they are read.
struct LawReader {
  std::string_view name;
  YamlMap::Keys keys;
  ContactLaw (*read)(const YamlMap&);
};

const std::vector<LawReader>& lawReaders() {
  static const std::vector<LawReader> readers{
      {"winkler",
       {"normal_contact_stiffness", "normal_exponent", "normal_damping"},
       [](const YamlMap& map) -> ContactLaw { return readWinkler(map); }},
      {"mass_spring_damper",
       {"normal_contact_stiffness", "mass", "stiffness", "damping"},
       [](const YamlMap& map) -> ContactLaw { return readMassSpringDamper(map); }},
      {"deformation_mask",
       {"normal_contact_stiffness", "saturation_pressure"},
       [](const YamlMap& map) -> ContactLaw { return readDeformationMask(map); }},
      {"proximity", {"sensitivity"}, [](const YamlMap& map) -> ContactLaw { return readProximity(map); }},
      {"elastic_layer",
       {"elastic_modulus", "poisson_ratio", "base", "iterations", "tolerance", "margin[_mm]"},
       [](const YamlMap& map) -> ContactLaw { return readElasticLayer(map); }},
      {"lugre",
       {"normal_contact_stiffness", "bristle_stiffness", "bristle_damping", "viscous_friction", "static_friction", "coulomb_friction",
        "stribeck_velocity"},
       [](const YamlMap& map) -> ContactLaw { return readLuGre(map); }},
  };
  return readers;
}

ContactLaw readLaw(const YamlMap& map) {
  const std::string name =
      map.choice("law", {"winkler", "mass_spring_damper", "deformation_mask", "proximity", "elastic_layer", "lugre"}, "winkler");
  const LawReader& law =
      *std::find_if(lawReaders().begin(), lawReaders().end(), [&](const LawReader& reader) { return reader.name == name; });
  for (const LawReader& other : lawReaders()) {
    for (const std::string_view key : other.keys) {
      if (std::find(law.keys.begin(), law.keys.end(), key) != law.keys.end()) continue;
      if (const std::optional<YamlNode> given = map.find(key))
        given->fail("not a key of law " + name + " but of " + std::string(other.name));
    }
  }
  return law.read(map);
}

Friction readFriction(const YamlMap& map) {
  Friction friction;
  friction.friction_coefficient =
      map.number("friction_coefficient", Allowed::within(0, kMaxFrictionCoefficient, ""), friction.friction_coefficient);
  if (friction.friction_coefficient > 0) {
    friction.tangential_stiffness = map.number("tangential_stiffness", Allowed::above(0, "N/m^3"));
  } else if (const std::optional<YamlNode> alone = map.find("tangential_stiffness")) {
    alone->fail("given without friction: friction_coefficient must be > 0 beside it");
  }
  return friction;
}

std::vector<RelaxationTerm> readRelaxation(const YamlMap& map) {
  std::vector<RelaxationTerm> terms;
  forTerms(map, "relaxation", kMaxRelaxationTerms, [&](const YamlMap& term) {
    const double fraction = term.number("fraction", Allowed::within(0, 1, "of the stiffness"));
    terms.push_back({.fraction = fraction, .time = term.number("time", Allowed::above(0, "s"))});
  });
  return terms;
}

Skin readSkin(const YamlMap& sensor) {
  YamlMap::Keys keys{"thickness[_mm]", "law", "friction_coefficient", "tangential_stiffness", "relaxation"};
  for (const LawReader& law : lawReaders()) {
    for (const std::string_view key : law.keys) {
      if (std::find(keys.begin(), keys.end(), key) == keys.end()) keys.push_back(key);
    }
  }
  const YamlMap map(sensor, "skin", keys);
  Skin skin;
  skin.thickness = map.number("thickness", Allowed::above(0, "m"));
  skin.law = readLaw(map);
  if (std::holds_alternative<ElasticLayer>(skin.law)) skin.margin = map.number("margin", Allowed::within(0, 1, "m"), skin.margin);
  skin.friction = readFriction(map);
  skin.relaxation = readRelaxation(map);
  return skin;
}

int readKernelSize(const YamlNode& node) {
  const std::uint64_t size = node.integer(1, kMaxKernelSize);
  if (size % 2 == 0) node.refuse("an odd whole number from 1 to " + std::to_string(kMaxKernelSize));
  return static_cast<int>(size);
}

std::vector<double> readKernel(const YamlNode& node, Canonical& canonical) {
  const std::string what = "a square list of rows of weights, their number odd and at most " + std::to_string(kMaxKernelSize);
  const std::vector<YamlNode> rows = node.items(what);
  if (rows.size() % 2 == 0 || rows.size() > static_cast<std::size_t>(kMaxKernelSize)) node.refuse(what);
  std::vector<double> kernel;
  std::string text;
  double sum = 0;
  for (const YamlNode& row : rows) {
    const std::vector<double> weights = row.numbers(Allowed::atLeast(0, ""), rows.size());
    kernel.insert(kernel.end(), weights.begin(), weights.end());
    for (const double weight : weights) sum += weight;
    text += (text.empty() ? "" : ", ") + canonicalList(weights);
  }
  if (sum <= 0) node.fail("the weights sum to 0: at least one must be > 0");
  canonical.line("kernel", "[" + text + "]");
  return kernel;
}

Psf readPsf(const YamlMap& sensor) {
  const YamlMap map(sensor, "psf", {"gaussian", "skin_gaussian", "kernel", "normalization"});
  Canonical& canonical = map.canonical();
  const std::optional<YamlNode> kernel = map.find("kernel"), skin_gaussian = map.find("skin_gaussian");
  Psf psf;
  if (skin_gaussian && map.has("gaussian")) skin_gaussian->fail("given beside `gaussian`: either, not both");
  if (kernel && skin_gaussian) kernel->fail("given beside `skin_gaussian`: either, not both");
  if (skin_gaussian) {
    const YamlMap gaussian(map, "skin_gaussian", {"sigma[_mm]", "reach[_mm]"});
    psf.sigma = gaussian.number("sigma", Allowed::above(0, "m"));
    psf.reach = gaussian.number("reach", Allowed::above(0, "m"), 3 * psf.sigma);
  } else if (map.has("gaussian")) {
    if (kernel) kernel->fail("given beside `gaussian`: either, not both");
    const YamlMap gaussian(map, "gaussian", {"sigma", "size"});
    // In taxels. A narrower one is no spread, a wider one is flat over the largest kernel.
    const double sigma = gaussian.number("sigma", Allowed::within(1e-3, 100, "taxels"));
    const int size = readKernelSize(gaussian.require("size", "an odd whole number from 1 to " + std::to_string(kMaxKernelSize)));
    canonical.line("size", std::to_string(size));
    psf = gaussianPsf(sigma, size);
  } else if (kernel) {
    psf.kernel = readKernel(*kernel, canonical);
    psf.size = static_cast<int>(kernel->items("").size());
  } else {
    canonical.line("kernel", "[[1]]");
  }
  const bool none = map.choice("normalization", {"per_source", "none"}, "per_source") == "none";
  psf.normalization = none ? Psf::Normalization::kNone : Psf::Normalization::kPerSource;
  return psf;
}

// One number per taxel, or none.
std::vector<double> readPerTaxel(const YamlMap& map, std::string_view key, std::string_view unit, const std::vector<GridPatch>& patches) {
  std::vector<double> values;
  if (const std::optional<YamlNode> node = map.find(key)) {
    std::size_t num_taxels = 0;
    for (const GridPatch& patch : patches)
      num_taxels += static_cast<std::size_t>(patch.num_rows) * static_cast<std::size_t>(patch.num_cols);
    std::vector<std::size_t> row_lengths;
    values = flatNumbers(*node, Allowed::atLeast(0, unit), row_lengths);
    if (!values.empty() && values.size() != num_taxels) {
      node->fail(std::to_string(values.size()) + " numbers are not allowed: one for each of the " + std::to_string(num_taxels) + " taxels");
    }
    const auto num_cols = static_cast<std::size_t>(patches.front().num_cols);
    for (const std::size_t length : row_lengths) {
      if (patches.size() == 1 && length != num_cols) {
        node->fail("a row of " + std::to_string(length) + " is not allowed: rows of " + std::to_string(num_cols) + " (num_cols)");
      }
    }
  }
  map.canonical().line(key, canonicalList(values));
  return values;
}

// A number, or a list of them: one per element of the hysteresis.
std::vector<double> readElements(const YamlMap& map, std::string_view key, const Allowed& allowed) {
  std::vector<double> values;
  if (const std::optional<YamlNode> node = map.find(key)) {
    if (node->isList()) {
      const std::string what = "a number, or a list of at most " + std::to_string(kMaxHysteresisElements);
      const std::vector<YamlNode> items = node->items(what);
      if (items.size() > static_cast<std::size_t>(kMaxHysteresisElements)) node->refuse(what);
      for (const YamlNode& item : items) values.push_back(item.number(allowed));
    } else {
      values.push_back(node->number(allowed));
    }
  }
  map.canonical().line(key, canonicalList(values));
  return values;
}

void readHysteresis(const YamlMap& map, Readout& readout) {
  readout.hysteresis_strength = readElements(map, "hysteresis_strength", Allowed::within(0, 1, ""));
  readout.hysteresis_width = readElements(map, "hysteresis_width", Allowed::atLeast(0, "N"));
  if (readout.hysteresis_width.size() == readout.hysteresis_strength.size()) return;
  const bool has_width = map.has("hysteresis_width");
  const YamlNode place = has_width ? map.require("hysteresis_width", "") : map.require("hysteresis_strength", "");
  place.fail(std::to_string(readout.hysteresis_strength.size()) + " of hysteresis_strength and " +
             std::to_string(readout.hysteresis_width.size()) + " of hysteresis_width: as many of one as of the other");
}

std::vector<CreepTerm> readCreep(const YamlMap& map) {
  std::vector<CreepTerm> terms;
  forTerms(map, "creep", kMaxCreepTerms, [&](const YamlMap& term) {
    const double fraction = term.number("fraction", Allowed::within(0, kMaxCreepFraction, "of the force"));
    terms.push_back({.fraction = fraction, .time = term.number("time", Allowed::above(0, "s"))});
  });
  return terms;
}

Readout readReadout(const YamlMap& sensor, const std::vector<GridPatch>& patches) {
  const YamlMap map(sensor, "readout",
                    {"curve", "output_scale", "trigger", "adc_bits", "saturation", "noise", "taxel_gain", "taxel_trigger",
                     "hysteresis_strength", "hysteresis_width", "creep", "low_pass_time", "delay", "jitter", "bias", "random_walk",
                     "gain_spread", "press_gain_spread", "dead_taxel_probability"});
  Readout readout;
  readCurve(map, readout);
  readout.output_scale = map.number("output_scale", Allowed::above(0, ""), readout.output_scale);
  readout.trigger = map.number("trigger", Allowed::atLeast(0, "N"), readout.trigger);
  readout.adc_bits = static_cast<int>(map.integer("adc_bits", 1, kMaxAdcBits, readout.adc_bits));
  const std::uint64_t full_scale = (std::uint64_t{1} << readout.adc_bits) - 1;
  readout.saturation = static_cast<int>(map.integer("saturation", 1, full_scale, full_scale));
  readout.noise = map.number("noise", Allowed::atLeast(0, "counts"), readout.noise);
  readout.taxel_gain = readPerTaxel(map, "taxel_gain", "", patches);
  readout.taxel_trigger = readPerTaxel(map, "taxel_trigger", "N", patches);
  readHysteresis(map, readout);
  readout.creep = readCreep(map);
  readout.low_pass_time = map.number("low_pass_time", Allowed::atLeast(0, "s"), readout.low_pass_time);
  readout.delay = map.number("delay", Allowed::atLeast(0, "s"), readout.delay);
  readout.jitter = map.number("jitter", Allowed::atLeast(0, "s"), readout.jitter);
  readout.bias = map.number("bias", Allowed::within(0, kMaxOffsetCounts, "counts"), readout.bias);
  readout.random_walk = map.number("random_walk", Allowed::within(0, kMaxOffsetCounts, "counts/sqrt(s)"), readout.random_walk);
  readout.gain_spread = map.number("gain_spread", Allowed::within(0, kMaxGainSpread, ""), readout.gain_spread);
  readout.press_gain_spread = map.number("press_gain_spread", Allowed::within(0, kMaxGainSpread, ""), readout.press_gain_spread);
  readout.dead_taxel_probability = map.number("dead_taxel_probability", Allowed::within(0, 1, ""), readout.dead_taxel_probability);
  return readout;
}

// checkSensor() begins its messages with the field, "readout.curve: ...": they are told at the nearest block that the file has.
[[noreturn]] void failAtField(const YamlNode& sensor, std::string_view message) {
  YamlNode place = sensor;
  std::string_view rest = message;
  while (true) {
    const std::size_t end = rest.find_first_of(".:[");
    if (end == std::string_view::npos) break;
    const std::optional<YamlNode> next = place.child(rest.substr(0, end));
    if (!next) break;
    place = *next;
    rest.remove_prefix(end + 1);
    if (message[message.size() - rest.size() - 1] != '.') break;
  }
  place.fail(std::string(rest.starts_with(' ') ? rest.substr(1) : message));
}

}  // namespace

void checkFormatVersion(const YamlNode& root) {
  if (!root.isMap()) root.refuse("a mapping that begins with format_version: " + std::to_string(kFormatVersion));
  const std::optional<YamlNode> given = root.child("format_version");
  if (!given) root.fail("format_version is missing: " + std::to_string(kFormatVersion));
  const std::uint64_t version = given->integer(1, std::numeric_limits<std::uint64_t>::max());
  if (version > kFormatVersion) {
    given->fail("version " + std::to_string(version) + " is newer than this program: it reads up to " + std::to_string(kFormatVersion));
  }
}

Sensor readSensor(const YamlNode& node, const std::filesystem::path& directory, Canonical& canonical, bool versioned) {
  std::vector<std::string_view> keys = {"name",       "patches", "taxels",     "taxel_mesh",        "urdf", "num_rows", "num_cols",
                                        "pitch[_mm]", "pose",    "frame_rate", "samples_per_taxel", "skin", "psf",      "readout"};
  if (versioned) keys.insert(keys.begin(), "format_version");
  const YamlMap map(node, keys, canonical);
  Sensor sensor;
  sensor.name = map.text("name", "a name");
  sensor.patches = readPatches(map, directory);
  sensor.samples_per_taxel =
      static_cast<int>(map.integer("samples_per_taxel", 1, kMaxSamplesPerTaxel, static_cast<std::uint64_t>(sensor.samples_per_taxel)));
  sensor.skin = readSkin(map);
  sensor.psf = readPsf(map);
  sensor.readout = readReadout(map, sensor.patches);
  sensor.frame_rate = map.number("frame_rate", Allowed::atLeast(0, "Hz"), sensor.frame_rate);
  try {
    checkSensor(sensor);
  } catch (const Error& error) {
    failAtField(node, error.what());
  }
  return sensor;
}

Sensor readSensorFile(const std::filesystem::path& file, Canonical& canonical) {
  const std::string name = file.generic_string();
  const YamlTree tree = parseYaml(readYamlFile(file), name);
  const YamlNode root(tree, name);
  checkFormatVersion(root);
  return readSensor(root, file.parent_path(), canonical, true);
}

Sensor readSensorBlock(const YamlNode& node, const std::filesystem::path& directory, Canonical& canonical) {
  canonical.open("sensor");
  Sensor sensor;
  if (node.isMap()) {
    sensor = readSensor(node, directory, canonical, false);
  } else {
    const std::filesystem::path file = directory / node.text(kSensorBlock);
    std::error_code error;
    // What is wrong inside that file is reported with a position there.
    if (!std::filesystem::is_regular_file(file, error)) node.fail(file.generic_string() + " is not there, or not a file");
    sensor = readSensorFile(file, canonical);
  }
  canonical.close();
  return sensor;
}

Sensor loadSensor(const std::filesystem::path& file) {
  Canonical canonical;
  return readSensorFile(file, canonical);
}

}  // namespace taxelsim
