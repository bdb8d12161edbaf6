#include "generation/recorder.h"

#include <array>
#include <cmath>
#include <cstring>

namespace taxelsim {
namespace {

// Prefetch distance, rows. Rows of different instances are scattered, which defeats the hardware prefetcher.
constexpr std::size_t kPrefetchRows = 12;

// Calls write(instance, first byte of its row) for every active instance of the range.
template <typename Write>
void forEachRow(const InstanceRange& range, std::size_t column, std::size_t row_bytes, Write write) {
  const auto row_of = [&](const FramePlace& place) { return place.columns[column] + place.row * row_bytes; };
  const std::span<const FramePlace> places = range.places;
  for (std::size_t i = range.first; i < range.last; ++i) {
    if (i + kPrefetchRows < range.last && places[i + kPrefetchRows].columns) __builtin_prefetch(row_of(places[i + kPrefetchRows]), 1);
    if (places[i].columns) write(i, row_of(places[i]));
  }
}

// With a constant num_floats the compiler turns memcpy into single moves.
template <std::size_t num_floats>
void copyShortRows(std::span<const float> values, const InstanceRange& range, std::size_t column) {
  forEachRow(range, column, num_floats * sizeof(float),
             [&](std::size_t i, std::byte* to) { std::memcpy(to, &values[i * num_floats], num_floats * sizeof(float)); });
}

void copyRows(std::span<const float> values, std::size_t num_floats, const InstanceRange& range, std::size_t column) {
  switch (num_floats) {
    case 1:
      return copyShortRows<1>(values, range, column);
    case 2:
      return copyShortRows<2>(values, range, column);
    case 3:
      return copyShortRows<3>(values, range, column);
    default:
      forEachRow(range, column, num_floats * sizeof(float),
                 [&](std::size_t i, std::byte* to) { std::memcpy(to, &values[i * num_floats], num_floats * sizeof(float)); });
  }
}

template <typename To, typename From>
void convertRows(std::span<const From> values, std::size_t width, const InstanceRange& range, std::size_t column) {
  forEachRow(range, column, width * sizeof(To), [&](std::size_t i, std::byte* to) {
    for (const From value : values.subspan(i * width, width)) {
      const auto number = static_cast<To>(value);
      std::memcpy(to, &number, sizeof number);
      to += sizeof number;
    }
  });
}

void copyFeature(std::span<const float> values, ScalarType, std::size_t width, const InstanceRange& range, std::size_t column) {
  copyRows(values, width, range, column);
}

// Integers, flags and enumerations, in the integer type of their column.
template <typename From>
void copyFeature(std::span<const From> values, ScalarType type, std::size_t width, const InstanceRange& range, std::size_t column) {
  switch (type) {
    case ScalarType::kUint8:
      return convertRows<std::uint8_t>(values, width, range, column);
    case ScalarType::kUint16:
      return convertRows<std::uint16_t>(values, width, range, column);
    case ScalarType::kInt16:
      return convertRows<std::int16_t>(values, width, range, column);
    default:
      return convertRows<std::int32_t>(values, width, range, column);
  }
}

void copyImages(std::span<const std::uint32_t> counts, std::size_t num_taxels, const InstanceRange& range, std::size_t column) {
  forEachRow(range, column, num_taxels * sizeof(std::uint16_t), [&](std::size_t i, std::byte* to) {
    const std::uint32_t* from = &counts[i * num_taxels];
    for (std::size_t t = 0; t < num_taxels; ++t) {
      const std::uint16_t value = static_cast<std::uint16_t>(from[t]);
      std::memcpy(to + t * sizeof value, &value, sizeof value);
    }
  });
}

// poses (num_instances x num_sensors)
void copyPoses(std::span<const Pose> poses, std::size_t num_sensors, const InstanceRange& range, std::size_t column) {
  constexpr std::size_t kPoseSize = 7;
  forEachRow(range, column, num_sensors * kPoseSize * sizeof(double), [&](std::size_t i, std::byte* to) {
    for (const Pose& pose : poses.subspan(i * num_sensors, num_sensors)) {
      const auto& [p, q] = pose;
      const std::array<double, kPoseSize> row{p[0], p[1], p[2], q[0], q[1], q[2], q[3]};
      std::memcpy(to, row.data(), sizeof row);
      to += sizeof row;
    }
  });
}

void copyDoubles(std::span<const double> values, std::size_t row_bytes, const InstanceRange& range, std::size_t column) {
  forEachRow(range, column, row_bytes,
             [&](std::size_t i, std::byte* to) { std::memcpy(to, &values[i * (row_bytes / sizeof(double))], row_bytes); });
}

void copyTwists(std::span<const Twist> twists, const InstanceRange& range, std::size_t column) {
  forEachRow(range, column, 6 * sizeof(float), [&](std::size_t i, std::byte* to) {
    std::array<float, 6> row;
    for (int k = 0; k < 3; ++k) {
      row[k] = static_cast<float>(twists[i].v[k]);
      row[k + 3] = static_cast<float>(twists[i].w[k]);
    }
    std::memcpy(to, row.data(), sizeof row);
  });
}

}  // namespace

void Recorder::recordExactEdge(const FrameContext& context, const InstanceRange& range, std::size_t angle_column) const {
  const auto num_sensors = static_cast<std::size_t>(context.num_sensors);
  for (std::size_t i = range.first; i < range.last; ++i) {
    const FramePlace& place = range.places[i];
    if (!place.columns) continue;
    for (std::size_t s = 0; s < num_sensors; ++s) {
      const double exact = edges_[place.object].project(context.X_SO[i * num_sensors + s]).angle;
      const std::uint8_t known = std::isfinite(exact);
      const float angle = known ? static_cast<float>(exact) : 0.0f;
      const std::uint64_t at = place.row * num_sensors + s;
      std::memcpy(place.columns[angle_column] + at * sizeof angle, &angle, sizeof angle);
      std::memcpy(place.columns[angle_column + 1] + at * sizeof known, &known, sizeof known);
    }
  }
}

void Recorder::recordFrames(const FrameView& frame, const FrameContext& context, std::span<const FramePlace> places) const {
  context.share(places.size(), [&](int first, int last) {
    recordRange(frame, context, {places, static_cast<std::size_t>(first), static_cast<std::size_t>(last)});
  });
}

void Recorder::recordRange(const FrameView& frame, const FrameContext& context, const InstanceRange& range) const {
  for (std::size_t c = 0; c < plan_.frame.size(); ++c) {
    const FrameColumn& entry = plan_.frame[c];
    const std::size_t row_bytes = rowBytes(entry.column);
    switch (entry.source) {
      case FrameColumn::Source::kTime:
        forEachRow(range, c, sizeof(double), [&](std::size_t i, std::byte* to) { std::memcpy(to, &context.times[i], sizeof(double)); });
        break;
      case FrameColumn::Source::kImage:
        copyImages(frame.tactile_image, row_bytes / sizeof(std::uint16_t), range, c);
        break;
      case FrameColumn::Source::kFeature:
        std::visit([&](const auto& values) { copyFeature(values, entry.column.type, row_bytes / scalarSize(entry.column), range, c); },
                   entry.values(frame));
        break;
      case FrameColumn::Source::kExactEdge:
        recordExactEdge(context, range, c);
        break;
      case FrameColumn::Source::kExactEdgeKnown:
        break;
      case FrameColumn::Source::kPose:
        copyPoses(context.X_SO, static_cast<std::size_t>(context.num_sensors), range, c);
        break;
      case FrameColumn::Source::kSensorPose:
        copyPoses(context.X_WS, static_cast<std::size_t>(context.num_sensors), range, c);
        break;
      case FrameColumn::Source::kAction:
        copyTwists(context.actions, range, c);
        break;
      case FrameColumn::Source::kControllerAction:
        copyTwists(context.controller_actions, range, c);
        break;
      case FrameColumn::Source::kJointPosition:
        copyDoubles(context.joint_positions, row_bytes, range, c);
        break;
      case FrameColumn::Source::kJointVelocity:
        copyDoubles(context.joint_velocities, row_bytes, range, c);
        break;
      case FrameColumn::Source::kRobotStatus:
        convertRows<std::uint8_t>(context.robot_status, 1, range, c);
        break;
    }
  }
}

void Recorder::recordEpisode(const EpisodeValues& values, const EpisodePlace& place) const {
  for (std::size_t c = 0; c < plan_.episode.size(); ++c) {
    const EpisodeColumn& entry = plan_.episode[c];
    entry.write(values, place.buffer->columns[plan_.frame.size() + c] + place.row * rowBytes(entry.column));
  }
}

}  // namespace taxelsim
