// The paper's static experiments (section V.A): indenters pressed on a sensor by dead weights, the images of several sensor models beside
// those of one that they are judged by.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "taxelsim/scene.h"
#include "taxelsim/sensor.h"

namespace taxelsim {

class Device;

struct StaticExperiment {
  struct Entry {
    Sensor sensor;
    bool fitted = false;  // normal_contact_stiffness and the width of a Gaussian PSF are sought so that its images come closest to the
                          // reference's; law winkler on grids only
  };

  std::string name;
  Sensor reference;  // its images are the ground truth
  std::vector<Entry> sensors;
  std::vector<SceneObject> objects;
  std::vector<double> yaw;    // rad, about z of S
  std::vector<double> loads;  // N
};

// Reads an experiment (docs/file_formats.md). Throws Error(kInput) with file, line, column and key.
StaticExperiment loadStaticExperiment(const std::filesystem::path& file);

// How far an image is from the reference's. Of the taxels that carry more than a count's worth of force in either.
struct ImageDistance {
  double median_difference = 0;  // median |I - R| over these taxels, as a fraction of the reference's full scale (M1)
  double relative_l1 = 0;        // sum |I - R| / sum |R| over all taxels (M4)
};

struct StaticImages {
  std::string name;                        // of the sensor; a fitted one's ends in "_fitted"
  Sensor sensor;                           // as used: of a fitted one with what was found
  double fitted_sigma = 0;                 // taxels; of a fitted one
  std::vector<std::vector<float>> images;  // (num_contacts x num_taxels), N: tactile_normal_force
  std::vector<ImageDistance> distances;    // (num_contacts); of the reference all 0
};

// Contacts are numbered (object x yaw + yaw number) x loads + load number.
struct StaticResult {
  StaticImages reference;
  std::vector<StaticImages> sensors;
};

// Each object is turned, laid with its lowest point over the sensor's origin and pressed with the load. A sensor of law proximity, which
// carries none, is pressed as deep as the reference was and its images are scaled to the load. Submits and waits. Throws Error(kInput)
// where a load is out of reach.
StaticResult runStaticExperiment(const Device& device, const StaticExperiment& experiment);

// Medians over all contacts of one load (its number), each measure by itself.
ImageDistance medianDistance(const StaticExperiment& experiment, const StaticImages& images, std::size_t load);

// The distance of one image from another of the same length. `least` (N): a count's worth; `full_scale`, N.
ImageDistance imageDistance(const std::vector<float>& image, const std::vector<float>& reference, double least, double full_scale);

}  // namespace taxelsim
