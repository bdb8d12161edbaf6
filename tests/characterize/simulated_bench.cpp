#include "characterize/simulated_bench.h"

#include "characterize/footprint.h"
#include "support/test.h"
#include "taxelsim/simulator.h"

namespace taxelsim::testing {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kPitch = 3.4e-3;  // m
constexpr int kSide = 6;           // taxels
// s: longer than the memory of any law; SkinSim's taxels forget within 0.1 s.
constexpr double kDwell = 0.5;

constexpr std::array<double, 2> kStampSize{8e-3, 6e-3};
constexpr double kEdgeRadius = 4e-3, kEdgeLength = 12e-3;
constexpr double kSquareSide = 10.5e-3, kBallRadius = 6e-3, kRidgeRadius = 2.5e-3, kRidgeLength = 14e-3;
constexpr double kTall = 10e-3;

// An object of the bench, its rotation at yaw 0, and its outline seen from above.
struct Shaped {
  Object object;
  Quaternion rotation{1, 0, 0, 0};
  Indenter outline;
};

const std::vector<Shaped>& objects() {
  const Quaternion lying = axisAngle({0, 1, 0}, kPi / 2);  // along x
  const auto rectangle = [](double x, double y) { return Indenter{.shape = Indenter::Shape::kStamp, .size = {x, y}}; };
  const auto disc = [](double radius) { return Indenter{.shape = Indenter::Shape::kFlatPin, .radius = radius}; };
  static const std::vector<Shaped> all{
      {Cylinder{kPinRadius, kTall}, {1, 0, 0, 0}, disc(kPinRadius)},
      {Box{{kStampSize[0], kStampSize[1], kTall}}, {1, 0, 0, 0}, rectangle(kStampSize[0], kStampSize[1])},
      {Cylinder{kEdgeRadius, kEdgeLength}, lying, rectangle(kEdgeLength, 2 * kEdgeRadius)},
      {Box{{kSquareSide, kSquareSide, kTall}}, {1, 0, 0, 0}, rectangle(kSquareSide, kSquareSide)},
      {Sphere{kBallRadius}, {1, 0, 0, 0}, disc(kBallRadius)},
      {Cylinder{kRidgeRadius, kRidgeLength}, lying, rectangle(kRidgeLength, 2 * kRidgeRadius)},
  };
  return all;
}

const Shaped& shapeOf(const BenchPlace& place) {
  return objects()[static_cast<std::size_t>(place.object)];
}

// Touches the skin.
Pose poseOf(const BenchPlace& place) {
  const Shaped& shape = shapeOf(place);
  const Quaternion R_SO = axisAngle({0, 0, 1}, place.yaw) * shape.rotation;
  const Vector3 lowest = rotate(R_SO, lowestPoint(shape.object, R_SO));
  return {{place.at[0], place.at[1], -lowest[2]}, R_SO};
}

const Device& device() {
  static const Device opened = Device::open();
  return opened;
}

std::vector<double> upAndDown(double first, double last, int count) {
  std::vector<double> values;
  for (int k = 0; k < count; ++k) values.push_back(first + (last - first) * k / (count - 1));
  for (int k = count - 2; k >= 0; --k) values.push_back(values[static_cast<std::size_t>(k)]);
  return values;
}

// count x count places of an object on the taxel next to the middle, from one border to the other.
std::vector<BenchPlace> placesOnATaxel(BenchObject object, int count) {
  std::vector<BenchPlace> places;
  for (int a = 0; a < count; ++a) {
    for (int b = 0; b < count; ++b) places.push_back({object, {kPitch * a / (count - 1), kPitch * b / (count - 1)}});
  }
  return places;
}

std::vector<BenchPlace> middlesOfTaxels(const Sensor& sensor) {
  std::vector<BenchPlace> places;
  for (const Vector3& middle : taxelPositions(sensor)) places.push_back({BenchObject::kPin, {middle[0], middle[1]}});
  return places;
}

std::string indenterText(BenchObject object) {
  std::ostringstream text;
  switch (object) {
    case BenchObject::kPin:
      text << "{flat_pin: {radius: " << kPinRadius << "}}";
      break;
    case BenchObject::kStamp:
      text << "{stamp: {size: [" << kStampSize[0] << ", " << kStampSize[1] << "]}}";
      break;
    default:
      text << "{cylinder: {radius: " << kEdgeRadius << ", length: " << kEdgeLength << "}}";
  }
  return text.str();
}

Measurement written(const std::filesystem::path& directory, const std::string& name, const std::string& keys, const std::string& table) {
  std::ofstream(directory / (name + ".csv")) << table;
  std::ofstream(directory / (name + ".yaml")) << "format_version: 1\nsensor: sensor.yaml\ntable: " << name << ".csv\n" << keys;
  return loadMeasurement(directory / (name + ".yaml"));
}

std::string imageTable(const std::vector<BenchPlace>& places, const std::vector<BenchReading>& readings) {
  std::ostringstream table;
  table.precision(9);
  table << "x_m,y_m,force_N";
  for (int row = 0; row < kSide; ++row) {
    for (int col = 0; col < kSide; ++col) table << ",r" << row << "_c" << col;
  }
  table << '\n';
  for (std::size_t r = 0; r < readings.size(); ++r) {
    const BenchPlace& place = places[r % places.size()];
    table << place.at[0] << ',' << place.at[1] << ',' << readings[r].force;
    for (const float counts : readings[r].counts) table << ',' << counts;
    table << '\n';
  }
  return table.str();
}

}  // namespace

Sensor benchPrior() {
  Sensor sensor;
  sensor.name = "prior";
  sensor.patches = {{.name = "pad", .num_rows = kSide, .num_cols = kSide, .pitch = {kPitch, kPitch}, .X_SP = {}}};
  sensor.samples_per_taxel = kBenchSamples;
  sensor.skin.thickness = 2e-3;
  sensor.skin.law = Winkler{.normal_contact_stiffness = 1e8};
  sensor.readout.curve = {1000};
  return sensor;
}

Sensor benchTruth(const ContactLaw& law) {
  Sensor sensor = benchPrior();
  sensor.name = "truth";
  sensor.skin.law = law;
  sensor.psf = gaussianPsf(0.5, 3);
  sensor.readout.curve = {1500};
  sensor.readout.trigger = 0.02;
  sensor.readout.noise = 2;
  for (int t = 0; t < numTaxels(sensor); ++t) sensor.readout.taxel_gain.push_back(1 + 0.1 * std::sin(2.4 * t));
  return sensor;
}

// Load, or depth below the surface, of all places.
struct SimulatedBench::Step {
  std::optional<double> load;  // N
  std::vector<double> depths;  // (num_places), m; empty under a load
};

SimulatedBench::SimulatedBench(const Sensor& sensor)
    : model_(device(), {.sensor = sensor, .objects = [] {
                          std::vector<Object> all;
                          for (const Shaped& shape : objects()) all.push_back(shape.object);
                          return all;
                        }()}) {}

std::vector<BenchReading> SimulatedBench::simulate(const std::vector<BenchPlace>& places, const std::vector<Step>& steps) const {
  const std::size_t num_taxels = static_cast<std::size_t>(numTaxels(sensor()));
  const bool by_depth = std::holds_alternative<Proximity>(sensor().skin.law);
  Simulator simulator(model_, {.num_instances = static_cast<int>(places.size()), .seed = 1});
  std::vector<int> ids;
  for (const BenchPlace& place : places) ids.push_back(static_cast<int>(place.object));
  std::vector<BenchReading> readings;
  for (const Step& step : steps) {
    std::vector<Pose> X_SO;
    for (std::size_t k = 0; k < places.size(); ++k) {
      X_SO.push_back(poseOf(places[k]));
      if (!step.load) X_SO.back().position[2] -= step.depths[k];
    }
    simulator.setObjects(ids, X_SO);
    if (step.load) simulator.setLoads(std::vector<float>(places.size(), static_cast<float>(*step.load)));
    simulator.step(kDwell);
    const FrameView frame = simulator.read();
    for (std::size_t k = 0; k < places.size(); ++k) {
      if (!frame.ground_truth.load_reached[k]) throw std::runtime_error("a load of the bench is out of reach");
      const auto image = frame.tactile_image.subspan(k * num_taxels, num_taxels);
      const double force = by_depth ? frame.ground_truth.total_force[k] : -frame.ground_truth.contact_wrench[6 * k + 2];
      const double depth = step.load ? -frame.ground_truth.load_offset[k] : step.depths[k];
      readings.push_back({force, depth, {image.begin(), image.end()}});
    }
  }
  return readings;
}

std::vector<BenchReading> SimulatedBench::press(const std::vector<BenchPlace>& places, const std::vector<double>& loads) const {
  std::vector<Step> steps;
  if (const auto* law = std::get_if<Proximity>(&sensor().skin.law)) {
    Sensor springs = sensor();
    springs.skin.law = Winkler{.normal_contact_stiffness = law->sensitivity};
    const std::vector<BenchReading> readings = SimulatedBench(springs).press(places, loads);
    for (std::size_t r = 0; r < readings.size(); ++r) {
      if (r % places.size() == 0) steps.emplace_back();
      steps.back().depths.push_back(readings[r].depth);
    }
  } else {
    for (const double load : loads) steps.push_back({.load = load, .depths = {}});
  }
  return simulate(places, steps);
}

std::vector<double> SimulatedBench::forcesAt(const std::vector<BenchPlace>& places, const std::vector<double>& depths) const {
  std::vector<Step> steps;
  for (const double depth : depths) steps.push_back({.load = {}, .depths = std::vector<double>(places.size(), depth)});
  std::vector<double> forces;
  for (const BenchReading& reading : simulate(places, steps)) forces.push_back(reading.force);
  return forces;
}

std::vector<Measurement> SimulatedBench::measure(const Sensor& prior, const std::filesystem::path& directory) const {
  std::ofstream(directory / "sensor.yaml") << sensorText(prior);
  std::vector<Measurement> measurements;

  std::ostringstream curve;
  curve << "taxel,force_N,counts\n";
  const std::vector<BenchPlace> middles = middlesOfTaxels(sensor());
  const std::vector<BenchReading> readings = press(middles, upAndDown(0.1, 2.5, 9));
  for (std::size_t r = 0; r < readings.size(); ++r) {
    const std::size_t taxel = r % middles.size();
    curve << taxel << ',' << readings[r].force << ',' << readings[r].counts[taxel] << '\n';
  }
  measurements.push_back(written(directory, "force_curve", "measurement: force_curve\n", curve.str()));

  const auto images = [&](const std::string& name, BenchObject object, int places_per_side, double most) {
    const std::vector<BenchPlace> places = placesOnATaxel(object, places_per_side);
    measurements.push_back(written(directory, name, "measurement: point_images\nindenter: " + indenterText(object) + "\n",
                                   imageTable(places, press(places, upAndDown(most / 2, most, 2)))));
  };
  images("pin", BenchObject::kPin, 4, 2);
  images("stamp", BenchObject::kStamp, 2, 6);
  images("edge", BenchObject::kEdge, 2, 4);

  const auto depths = [&](const std::string& name, BenchObject object, int places_per_side, double most) {
    const std::vector<BenchPlace> places = placesOnATaxel(object, places_per_side);
    const std::vector<double> steps = upAndDown(most / 6, most, 6);
    const std::vector<double> forces = forcesAt(places, steps);
    std::ostringstream table;
    table.precision(9);
    table << "depth_m,force_N\n";
    for (std::size_t r = 0; r < forces.size(); ++r) table << steps[r / places.size()] << ',' << forces[r] << '\n';
    measurements.push_back(written(directory, name, "measurement: force_depth\nindenter: " + indenterText(object) + "\n", table.str()));
  };
  depths("pin_depth", BenchObject::kPin, 5, 0.9e-3);
  depths("edge_depth", BenchObject::kEdge, 3, 0.4e-3);
  return measurements;
}

std::vector<float> uniformStamp(const Sensor& sensor, const BenchPlace& place, double load) {
  const Polygon outline = moved(sectionOf(shapeOf(place).outline, 0), place.at, place.yaw);
  const GridPatch& patch = sensor.patches.front();
  const double area = overlap(outline, {-1, -1}, {1, 1});
  std::vector<float> image;
  for (const Vector3& middle : taxelPositions(sensor)) {
    const double x = middle[0] - patch.pitch[0] / 2, y = middle[1] - patch.pitch[1] / 2;
    const double force = load * overlap(outline, {x, y}, {x + patch.pitch[0], y + patch.pitch[1]}) / area;
    const double counts = sensor.readout.curve[0] * (sensor.readout.taxel_gain[image.size()] * force - sensor.readout.trigger);
    image.push_back(static_cast<float>(std::clamp(std::round(counts), 0.0, static_cast<double>(sensor.readout.saturation))));
  }
  return image;
}

}  // namespace taxelsim::testing
