/// @file
/// Contact points that a physics engine recorded, per step of several episodes: the source of a Scene of kind contact_points. Not the input
/// of a running simulation, which is Simulator::setContacts().
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "taxelsim/contact_point.h"

namespace taxelsim {

/// Contact points of recorded episodes, in the frame of the sensor. A frame without points has no contact.
struct ContactRecording {
  /// Frame that has points.
  struct Frame {
    std::uint64_t episode = 0;  ///< Below num_episodes.
    int step = 0;               ///< Below Scene::num_steps.
    std::size_t begin = 0;      ///< Index of its first point; those up to the begin of the next frame follow.
  };

  std::string file_name;             ///< Name of the file without its folder.
  std::string sha256;                ///< Of the bytes of the file, 64 hexadecimal digits.
  std::uint64_t num_episodes = 1;    ///< 1 to kMaxRecordedEpisodes.
  double contact_band = 1e-4;        ///< m, 0 to 1: SimulatorOptions::contact_band. Default 1e-4.
  std::vector<Frame> frames;         ///< Those with points, ascending by episode and step.
  std::vector<ContactPoint> points;  ///< In S; those of a frame in the order of the file.

  /// Points of a frame; empty if it has none. The span is valid as long as `points`.
  std::span<const ContactPoint> pointsOf(std::uint64_t episode, int step) const;

  /// Most points of a frame.
  int maxPoints() const;
};

inline constexpr std::uint64_t kMaxRecordedEpisodes = 1'000'000;  ///< Most episodes of a ContactRecording.

}  // namespace taxelsim
