#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/median.h"
#include "experiments/nelder_mead.h"
#include "taxelsim/error.h"
#include "taxelsim/experiment.h"
#include "taxelsim/model.h"
#include "taxelsim/simulator.h"

namespace taxelsim {
namespace {

constexpr double kDt = 1;  // s; results of a first step at rest do not depend on it

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

// Simulates all contacts as one batch, under their loads or at `offsets`.
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
                                         " is out of reach: at full indentation the skin carries " +
                                         std::to_string(-frame.ground_truth.contact_wrench[6 * c + 2]) + " N");
    }
    const auto image = frame.ground_truth.tactile_normal_force.subspan(c * num_taxels, num_taxels);
    pressed.images.emplace_back(image.begin(), image.end());
    pressed.offsets.push_back(frame.ground_truth.load_offset[c]);
  }
  return pressed;
}

// Simulates sensors in the contacts of an experiment and compares their images with the reference.
class ReferenceComparison {
 public:
  ReferenceComparison(const Device& device, const StaticExperiment& experiment)
      : device_(device),
        experiment_(experiment),
        contacts_(contactsOf(experiment)),
        least_(nominalForce(experiment.reference.readout, 1) - experiment.reference.readout.trigger),
        full_scale_(nominalForce(experiment.reference.readout, experiment.reference.readout.saturation)),
        reference_(press(device, experiment, experiment.reference, contacts_, nullptr)) {}

  StaticImages reference() const {
    return {experiment_.reference.name, experiment_.reference, 0, reference_.images, std::vector<ImageDistance>(contacts_.size())};
  }

  // Images with a `share` of the load, 0 or 1, in equal parts on all taxels.
  StaticImages uniform(const std::string& name, double share) const {
    StaticImages result = reference();
    result.name = name;
    for (std::size_t c = 0; c < contacts_.size(); ++c) {
      const std::size_t num_taxels = result.images[c].size();
      result.images[c].assign(num_taxels, static_cast<float>(share * contacts_[c].load / static_cast<double>(num_taxels)));
      result.distances[c] = imageDistance(result.images[c], reference_.images[c], least_, full_scale_);
    }
    return result;
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

  // Fits stiffness and PSF width to the reference, on their logarithms.
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

// Steps and tolerance are of the logarithms.
constexpr NelderMeadOptions kFitOptions{.step = 0.3, .tolerance = 5e-3, .max_evaluations = 60};

StaticImages ReferenceComparison::fitted(const Sensor& nominal) const {
  const int size = std::max(nominal.psf.size, 3);
  StaticImages best;
  double least = std::numeric_limits<double>::infinity();
  // Parameters: logarithms of stiffness (N/m^3) and sigma (taxels).
  const auto cost = [&](const std::vector<double>& at) {
    Sensor sensor = nominal;
    const double sigma = std::exp(at[1]);
    std::get<Winkler>(sensor.skin.law).normal_contact_stiffness = std::exp(at[0]);
    sensor.psf = gaussianPsf(sigma, size, Psf::Normalization::kPerSource);
    StaticImages images;
    try {
      images = imagesOf(sensor);
    } catch (const Error&) {
      return std::numeric_limits<double>::infinity();  // too soft for the largest load
    }
    // A sum: a median would ignore the few contacts that distinguish two sensors.
    double sum = 0;
    for (std::size_t c = 0; c < contacts_.size(); ++c) {
      if (!isScored(experiment_, contacts_[c].object)) sum += images.distances[c].relative_l1;
    }
    if (sum < least) {
      least = sum;
      best = std::move(images);
      best.fitted_sigma = sigma;
    }
    return sum;
  };
  minimizeNelderMead({std::log(std::get<Winkler>(nominal.skin.law).normal_contact_stiffness), std::log(0.5)}, kFitOptions, cost);
  if (!std::isfinite(least))
    throw Error(ErrorKind::kInput, nominal.name + ": no fit: every stiffness tried is too soft for the largest load");
  best.name = nominal.name + "_fitted";
  return best;
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

bool isScored(const StaticExperiment& experiment, std::size_t object) {
  const bool any_fitted =
      std::any_of(experiment.sensors.begin(), experiment.sensors.end(), [](const StaticExperiment::Entry& entry) { return entry.fitted; });
  return !any_fitted || object % 2 == 1;
}

ImageDistance medianDistance(const StaticExperiment& experiment, const StaticImages& images, std::size_t load) {
  std::vector<double> differences;
  std::vector<double> relative;
  const std::size_t per_object = experiment.yaw.size() * experiment.loads.size();
  for (std::size_t contact = load; contact < images.distances.size(); contact += experiment.loads.size()) {
    if (!isScored(experiment, contact / per_object)) continue;
    differences.push_back(images.distances[contact].median_difference);
    relative.push_back(images.distances[contact].relative_l1);
  }
  return {medianOf(differences), medianOf(relative)};
}

StaticResult runStaticExperiment(const Device& device, const StaticExperiment& experiment) {
  const ReferenceComparison comparison(device, experiment);
  StaticResult result{.reference = comparison.reference(), .sensors = {}, .baselines = {}};
  result.baselines = {comparison.uniform("all-zero image", 0), comparison.uniform("uniform image", 1)};
  for (const StaticExperiment::Entry& entry : experiment.sensors) {
    result.sensors.push_back(entry.fitted ? comparison.fitted(entry.sensor) : comparison.imagesOf(entry.sensor));
  }
  return result;
}

}  // namespace taxelsim
