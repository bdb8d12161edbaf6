// Draws the frames of one episode for videos. A picture shows the sensor and the object in 3-D, the tactile image, and curves of force and
// edge angle over time.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "figures/frame_figures.h"
#include "figures/line_plot.h"
#include "figures/scene_view.h"
#include "taxelsim/object.h"

namespace taxelsim::figures {

// Degrees, of angles (rad) of lines without direction: half turns are added, so that each is next to the one before it that is defined and
// their mean lies between -45 and 135. NaN stays NaN.
std::vector<double> continuousAngles(std::vector<double> angles);

class EpisodeView {
 public:
  // `frames`: of one episode of one sensor; must outlive the view. `assets`: folders with the meshes of the scene. Throws Error(kInput)
  // that names what the data set lacks, and what FrameFigures throws.
  EpisodeView(FrameFigures& frames, std::span<const std::filesystem::path> assets);

  // Draws one frame, counted from 0. All pictures have one size, one colour scale and one time axis.
  Canvas pictureOf(std::uint64_t frame);

 private:
  // A quantity over the frames of the episode; NaN where it is undefined.
  struct Curve {
    std::string name, unit;
    Colour colour;
    std::vector<double> values;  // (num_frames)
  };

  Curve forceCurve() const;
  Curve angleCurve() const;
  void drawHeading(const Canvas& canvas, std::uint64_t frame) const;
  void drawImage(const Canvas& canvas, const TactilePanel& panel, const ColourScale& scale) const;
  void drawValue(const Canvas& canvas, const Curve& curve, std::uint64_t frame, double left) const;
  void drawCurve(const Canvas& canvas, const Curve& curve, std::uint64_t frame, double left) const;

  FrameFigures& frames_;
  std::vector<Object> objects_;
  std::vector<Pose> poses_;    // X_SO, (num_frames x num_objects)
  std::vector<double> times_;  // s, (num_frames)
  std::vector<Curve> curves_;
  std::string subtitle_;
  std::optional<SceneView> scene_;
};

}  // namespace taxelsim::figures
