#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "taxelsim/error.h"
#include "taxelsim/experiment.h"
#include "taxelsim/model.h"
#include "taxelsim/simulator.h"

namespace taxelsim {
namespace {

constexpr double kDt = 1;  // s; nothing of a first step at rest depends on it

struct Contact {
  std::size_t object = 0;
  Pose X_SO;  // lowest point over the origin of S
  double load = 0;
};

std::vector<Contact> contactsOf(const StaticExperiment& experiment) {
  std::vector<Contact> contacts;
  for (std::size_t object = 0; object < experiment.objects.size(); ++object) {
    for (const double yaw : experiment.yaw) {
      Pose X_SO;
      X_SO.rotation = axisAngle({0, 0, 1}, yaw) * experiment.objects[object].orientation;
      const Vector3 lowest = rotate(X_SO.rotation, lowestPoint(experiment.objects[object].object, X_SO.rotation));
      X_SO.position = {-lowest[0], -lowest[1], -lowest[2]};
      for (const double load : experiment.loads) contacts.push_back({object, X_SO, load});
    }
  }
  return contacts;
}

struct Pressed {
  std::vector<std::vector<float>> images;  // (num_contacts x num_taxels), N
  std::vector<double> offsets;             // (num_contacts), m, along z
};

// All contacts as one batch; by load, or `offsets` deep.
Pressed press(const Device& device, const StaticExperiment& experiment, const Sensor& sensor, const std::vector<Contact>& contacts,
              const std::vector<double>* offsets) {
  std::vector<Object> objects;
  for (const SceneObject& object : experiment.objects) objects.push_back(object.object);
  const Model model(device, {.sensor = sensor, .objects = objects});
  Simulator simulator(model, {.num_instances = static_cast<int>(contacts.size()),
                              .outputs = {.tactile_normal_force = true, .tactile_shear_force = false, .penetration_depth = false}});
  std::vector<int> ids;
  std::vector<Pose> X_SO;
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    ids.push_back(static_cast<int>(contacts[c].object));
    X_SO.push_back(contacts[c].X_SO);
    if (offsets != nullptr) {
      X_SO.back().position[2] += (*offsets)[c];
    } else {
      simulator.setLoad(static_cast<int>(c), static_cast<float>(contacts[c].load));
    }
  }
  simulator.setObjects(ids, X_SO);
  simulator.step(kDt);
  const FrameView frame = simulator.read();
  const auto num_taxels = static_cast<std::size_t>(numTaxels(sensor));
  Pressed pressed;
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    if (frame.ground_truth.load_reached[c] == 0) {
      throw Error(ErrorKind::kInput, sensor.name + ": " + std::to_string(contacts[c].load) + " N on " + objects[contacts[c].object].name +
                                         " are out of reach: pressed through the skin it carries " +
                                         std::to_string(-frame.ground_truth.contact_wrench[6 * c + 2]) + " N");
    }
    const auto image = frame.ground_truth.tactile_normal_force.subspan(c * num_taxels, num_taxels);
    pressed.images.emplace_back(image.begin(), image.end());
    pressed.offsets.push_back(frame.ground_truth.load_offset[c]);
  }
  return pressed;
}

double medianOf(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return (*middle + *std::max_element(values.begin(), middle)) / 2;
}

// What judges the images of one experiment.
class Judge {
 public:
  Judge(const Device& device, const StaticExperiment& experiment)
      : device_(device),
        experiment_(experiment),
        contacts_(contactsOf(experiment)),
        least_(nominalForce(experiment.reference.readout, 1) - experiment.reference.readout.trigger),
        full_scale_(nominalForce(experiment.reference.readout, experiment.reference.readout.saturation)),
        reference_(press(device, experiment, experiment.reference, contacts_, nullptr)) {}

  StaticImages reference() const {
    return {experiment_.reference.name, experiment_.reference, 0, reference_.images, std::vector<ImageDistance>(contacts_.size())};
  }

  StaticImages imagesOf(const Sensor& sensor) const {
    const bool by_depth = std::holds_alternative<Proximity>(sensor.skin.law);
    StaticImages result{
        sensor.name, sensor, 0, press(device_, experiment_, sensor, contacts_, by_depth ? &reference_.offsets : nullptr).images, {}};
    for (std::size_t c = 0; c < contacts_.size(); ++c) {
      if (by_depth) scaleTo(contacts_[c].load, result.images[c]);
      result.distances.push_back(imageDistance(result.images[c], reference_.images[c], least_, full_scale_));
    }
    return result;
  }

  // Stiffness and width of the PSF by the simplex method of Nelder and Mead on their logarithms.
  StaticImages fitted(const Sensor& nominal) const;

 private:
  static void scaleTo(double load, std::vector<float>& image) {
    const double sum = std::accumulate(image.begin(), image.end(), 0.0);
    for (float& force : image) force = static_cast<float>(sum > 0 ? force * load / sum : 0);
  }

  const Device& device_;
  const StaticExperiment& experiment_;
  std::vector<Contact> contacts_;
  double least_, full_scale_;  // N
  Pressed reference_;
};

constexpr int kFitEvaluations = 60;
constexpr double kFitStep = 0.3;     // of the logarithms, at first
constexpr double kFitEnough = 5e-3;  // of the logarithms: the corners are this close together

StaticImages Judge::fitted(const Sensor& nominal) const {
  using Point = std::array<double, 2>;  // logarithms of stiffness (N/m^3) and sigma (taxels)
  struct Corner {
    Point at{};
    double cost = std::numeric_limits<double>::infinity();
    StaticImages images;
  };
  const int size = std::max(nominal.psf.size, 3);
  const auto evaluate = [&](const Point& at) {
    Corner corner{at, std::numeric_limits<double>::infinity(), {}};
    Sensor sensor = nominal;
    const double sigma = std::exp(at[1]);
    std::get<Winkler>(sensor.skin.law).normal_contact_stiffness = std::exp(at[0]);
    sensor.psf = gaussianPsf(sigma, size, Psf::Normalization::kPerSource);
    try {
      corner.images = imagesOf(sensor);
    } catch (const Error&) {
      return corner;  // too soft for the largest load: infinitely bad
    }
    corner.images.fitted_sigma = sigma;
    // The mean, since a median would not see the contacts that tell two sensors apart.
    corner.cost = 0;
    for (const ImageDistance& distance : corner.images.distances) corner.cost += distance.relative_l1;
    return corner;
  };
  const Point start{std::log(std::get<Winkler>(nominal.skin.law).normal_contact_stiffness), std::log(0.5)};
  std::array<Corner, 3> simplex{evaluate(start), evaluate({start[0] + kFitStep, start[1]}), evaluate({start[0], start[1] + kFitStep})};
  for (int used = 3; used < kFitEvaluations;) {
    std::sort(simplex.begin(), simplex.end(), [](const Corner& a, const Corner& b) { return a.cost < b.cost; });
    const auto apart = [&](std::size_t k) {
      return std::max(std::abs(simplex[k].at[0] - simplex[0].at[0]), std::abs(simplex[k].at[1] - simplex[0].at[1]));
    };
    if (std::max(apart(1), apart(2)) < kFitEnough) break;
    const Point middle{(simplex[0].at[0] + simplex[1].at[0]) / 2, (simplex[0].at[1] + simplex[1].at[1]) / 2};
    const auto along = [&](double t) {
      ++used;
      return evaluate({middle[0] + t * (middle[0] - simplex[2].at[0]), middle[1] + t * (middle[1] - simplex[2].at[1])});
    };
    Corner next = along(1);
    if (next.cost < simplex[0].cost) {
      Corner farther = along(2);
      simplex[2] = farther.cost < next.cost ? std::move(farther) : std::move(next);
    } else if (next.cost < simplex[1].cost) {
      simplex[2] = std::move(next);
    } else {
      Corner nearer = along(next.cost < simplex[2].cost ? 0.5 : -0.5);
      if (nearer.cost < std::min(next.cost, simplex[2].cost)) {
        simplex[2] = std::move(nearer);
      } else {
        for (std::size_t k : {1u, 2u}) {
          ++used;
          simplex[k] = evaluate({(simplex[k].at[0] + simplex[0].at[0]) / 2, (simplex[k].at[1] + simplex[0].at[1]) / 2});
        }
      }
    }
  }
  StaticImages& best =
      std::min_element(simplex.begin(), simplex.end(), [](const Corner& a, const Corner& b) { return a.cost < b.cost; })->images;
  best.name = nominal.name + "_fitted";
  return std::move(best);
}

}  // namespace

ImageDistance imageDistance(const std::vector<float>& image, const std::vector<float>& reference, double least, double full_scale) {
  std::vector<double> differences;
  double sum = 0;
  double all = 0;
  for (std::size_t t = 0; t < image.size(); ++t) {
    const double difference = std::abs(static_cast<double>(image[t]) - static_cast<double>(reference[t]));
    sum += difference;
    all += std::abs(static_cast<double>(reference[t]));
    if (image[t] > least || reference[t] > least) differences.push_back(difference);
  }
  return {medianOf(differences) / full_scale, all > 0 ? sum / all : 0};
}

ImageDistance medianDistance(const StaticExperiment& experiment, const StaticImages& images, std::size_t load) {
  std::vector<double> differences;
  std::vector<double> relative;
  for (std::size_t contact = load; contact < images.distances.size(); contact += experiment.loads.size()) {
    differences.push_back(images.distances[contact].median_difference);
    relative.push_back(images.distances[contact].relative_l1);
  }
  return {medianOf(differences), medianOf(relative)};
}

StaticResult runStaticExperiment(const Device& device, const StaticExperiment& experiment) {
  const Judge judge(device, experiment);
  StaticResult result{judge.reference(), {}};
  for (const StaticExperiment::Entry& entry : experiment.sensors) {
    result.sensors.push_back(entry.fitted ? judge.fitted(entry.sensor) : judge.imagesOf(entry.sensor));
  }
  return result;
}

}  // namespace taxelsim
