// A sensor as the text of a sensor file, with every setting that readSensor() reads.
#include <array>
#include <cstdint>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <type_traits>
#include <variant>

#include "base/text.h"
#include "scene/canonical.h"
#include "scene/sensor_file.h"
#include "sensor/fields.h"
#include "taxelsim/sensor.h"

namespace taxelsim {
namespace {

// Lines of a file, with the notes of their keys as comments.
class Writer {
 public:
  explicit Writer(const std::map<std::string, std::string>& notes) : notes_(notes) {}

  void line(std::string_view key, const std::string& value) {
    const auto note = notes_.find(path_ + std::string(key));
    text_.line(key, note == notes_.end() ? value : value + "  # " + oneLine(note->second));
  }
  void line(std::string_view key, double value) { line(key, canonicalNumber(value)); }
  void line(std::string_view key, int value) { line(key, std::to_string(value)); }
  void line(std::string_view key, std::uint64_t value) { line(key, std::to_string(value)); }
  void line(std::string_view key, const std::optional<double>& value) {
    if (value) line(key, *value);
  }
  void line(std::string_view key, std::span<const double> values) {
    std::vector<double> unsigned_zeros(values.begin(), values.end());  // the reader reads -0 as 0
    for (double& value : unsigned_zeros) value += 0.0;
    line(key, canonicalList(unsigned_zeros));
  }

  template <std::size_t N, typename Enum>
  void word(std::string_view key, const std::array<std::string_view, N>& words, Enum value) {
    line(key, std::string(words[static_cast<std::size_t>(value)]));
  }

  // write() writes the lines below `key`.
  template <typename Function>
  void block(std::string_view key, Function write) {
    const std::string outer = path_;
    path_ += std::string(key) + ".";
    text_.open(key);
    write();
    text_.close();
    path_ = outer;
  }
  template <typename Function>
  void item(Function write) {
    text_.openItem();
    write();
    text_.close();
  }

  const std::string& text() const { return text_.text(); }

 private:
  const std::map<std::string, std::string>& notes_;
  std::string path_;
  Canonical text_;
};

template <typename Settings>
void writeFields(std::span<const Field<std::type_identity_t<Settings>>> table, const Settings& settings, Writer& out) {
  for (const Field<Settings>& field : table) {
    std::visit([&](const auto* value) { out.line(field.name(), *value); }, field.in(settings));
  }
}

void writePatches(const Sensor& sensor, Writer& out) {
  std::set<std::string> names;
  for (const GridPatch& patch : sensor.patches) names.insert(patch.name);
  const bool named = names.size() == sensor.patches.size() && names.count("") == 0;
  out.block("patches", [&] {
    for (const GridPatch& patch : sensor.patches) {
      out.item([&] {
        if (named) out.line("name", canonicalText(patch.name));
        writeFields(kGridPatchFields, patch, out);
        out.line("pitch", patch.pitch);
        out.block("pose", [&] {
          out.line("position", patch.X_SP.position);
          out.line("rotation", patch.X_SP.rotation);
        });
      });
    }
  });
}

template <typename Term, std::size_t N>
void writeTerms(std::string_view key, const std::vector<Term>& terms, const std::array<Field<Term>, N>& table, Writer& out) {
  if (terms.empty()) return;
  out.block(key, [&] {
    for (const Term& term : terms) out.item([&] { writeFields(table, term, out); });
  });
}

template <typename Law>
void writeLaw(const Law& law, Writer& out) {
  visitFields(law, [&](const auto& table) { writeFields(table, law, out); });
}

void writeLaw(const ElasticLayer& law, Writer& out) {
  writeFields(kElasticLayerFields, law, out);
  out.word("base", kBaseNames, law.base);
  writeFields(kLayerSolverFields, law, out);
}

void writeSkin(const Skin& skin, Writer& out) {
  writeFields(kSkinFields, skin, out);
  out.line("law", std::string(kLawNames[skin.law.index()]));
  std::visit([&](const auto& law) { writeLaw(law, out); }, skin.law);
  if (std::holds_alternative<ElasticLayer>(skin.law)) writeFields(kMarginFields, skin, out);
  if (skin.friction.friction_coefficient > 0) {
    writeFields(kFrictionFields, skin.friction, out);
  }
  writeTerms("relaxation", skin.relaxation, kRelaxationFields, out);
}

void writePsf(const Psf& psf, Writer& out) {
  if (psf.sigma > 0) {
    out.block("skin_gaussian", [&] {
      out.line("sigma", psf.sigma);
      if (psf.reach > 0) out.line("reach", psf.reach);
    });
  } else {
    std::string rows;
    for (int a = 0; a < psf.size; ++a) {
      const auto row = std::span(psf.kernel).subspan(static_cast<std::size_t>(a * psf.size), static_cast<std::size_t>(psf.size));
      rows += (rows.empty() ? "" : ", ") + canonicalList(row);
    }
    out.line("kernel", "[" + rows + "]");
  }
  out.word("normalization", kNormalizationNames, psf.normalization);
}

void writeThreeAxis(const ThreeAxisReadout& axes, Writer& out) {
  out.line("gain", "[" + canonicalList(axes.gain[0]) + ", " + canonicalList(axes.gain[1]) + ", " + canonicalList(axes.gain[2]) + "]");
  writeFields(kThreeAxisFields, axes, out);
}

void writeReadout(const Readout& readout, Writer& out) {
  out.block("curve", [&] {
    if (!readout.curve_points.empty()) {
      std::string points;
      for (const CurvePoint& point : readout.curve_points) {
        points += (points.empty() ? "" : ", ") + canonicalList(std::array{point.force, point.counts});
      }
      out.line("points", "[" + points + "]");
    } else if (readout.curve.size() == 1) {
      out.line("counts_per_newton", readout.curve.front());
    } else {
      out.line("coefficients", readout.curve);
    }
    if (readout.curve_limit > 0) out.line("limit", readout.curve_limit);
  });
  writeFields(kOutputFields, readout, out);
  out.line("saturation", readout.saturation);
  writeFields(kNoiseFields, readout, out);
  if (!readout.taxel_gain.empty()) out.line("taxel_gain", readout.taxel_gain);
  if (!readout.taxel_trigger.empty()) out.line("taxel_trigger", readout.taxel_trigger);
  if (!readout.calibrated_gain.empty()) out.line("calibrated_gain", readout.calibrated_gain);
  if (!readout.hysteresis_strength.empty()) {
    out.line("hysteresis_strength", readout.hysteresis_strength);
    out.line("hysteresis_width", readout.hysteresis_width);
  }
  writeTerms("creep", readout.creep, kCreepFields, out);
  writeFields(kTimeFields, readout, out);
  writeFields(kImperfectionFields, readout, out);
  if (readout.three_axis) out.block("three_axis", [&] { writeThreeAxis(*readout.three_axis, out); });
}

}  // namespace

std::string skinText(const Skin& skin) {
  const std::map<std::string, std::string> no_notes;
  Writer out(no_notes);
  out.block("skin", [&] { writeSkin(skin, out); });
  return out.text();
}

std::string sensorText(const Sensor& sensor, const std::map<std::string, std::string>& notes) {
  Writer out(notes);
  out.line("format_version", static_cast<int>(kFormatVersion));
  out.line("name", canonicalText(sensor.name));
  writePatches(sensor, out);
  writeFields(kSensorFields, sensor, out);
  out.word("depth_sampling", kDepthSamplingNames, sensor.depth_sampling);
  writeFields(kFrameRateFields, sensor, out);
  out.block("skin", [&] { writeSkin(sensor.skin, out); });
  out.block("psf", [&] { writePsf(sensor.psf, out); });
  out.block("readout", [&] { writeReadout(sensor.readout, out); });
  const auto head = notes.find("");
  return (head == notes.end() ? "" : "# " + oneLine(head->second) + "\n") + out.text();
}

}  // namespace taxelsim
