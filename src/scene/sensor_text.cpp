// A sensor as the text of a sensor file. Every setting that sensor_file.cpp reads is written here.
#include <array>
#include <set>
#include <span>
#include <string>
#include <variant>

#include "base/text.h"
#include "scene/canonical.h"
#include "scene/sensor_file.h"
#include "taxelsim/sensor.h"

namespace taxelsim {
namespace {

// Lines of a file, each with what the notes say of its key.
class Writer {
 public:
  explicit Writer(const std::map<std::string, std::string>& notes) : notes_(notes) {}

  void line(std::string_view key, const std::string& value) {
    const auto note = notes_.find(path_ + std::string(key));
    text_.line(key, note == notes_.end() ? value : value + "  # " + oneLine(note->second));
  }
  void line(std::string_view key, double value) { line(key, canonicalNumber(value)); }
  void line(std::string_view key, int value) { line(key, std::to_string(value)); }
  void line(std::string_view key, std::span<const double> values) {
    std::vector<double> unsigned_zeros(values.begin(), values.end());  // the reader makes 0 of -0 in a quaternion
    for (double& value : unsigned_zeros) value += 0.0;
    line(key, canonicalList(unsigned_zeros));
  }

  // write() gives what stands below `key`.
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

void writePatches(const Sensor& sensor, Writer& out) {
  std::set<std::string> names;
  for (const GridPatch& patch : sensor.patches) names.insert(patch.name);
  const bool named = names.size() == sensor.patches.size() && names.count("") == 0;
  out.block("patches", [&] {
    for (const GridPatch& patch : sensor.patches) {
      out.item([&] {
        if (named) out.line("name", canonicalText(patch.name));
        out.line("num_rows", patch.num_rows);
        out.line("num_cols", patch.num_cols);
        out.line("pitch", patch.pitch);
        out.block("pose", [&] {
          out.line("position", patch.X_SP.position);
          out.line("rotation", patch.X_SP.rotation);
        });
      });
    }
  });
}

template <typename Term>
void writeTerms(std::string_view key, const std::vector<Term>& terms, Writer& out) {
  if (terms.empty()) return;
  out.block(key, [&] {
    for (const Term& term : terms) {
      out.item([&] {
        out.line("fraction", term.fraction);
        out.line("time", term.time);
      });
    }
  });
}

void writeLaw(const ContactLaw& law, Writer& out) {
  if (const auto* winkler = std::get_if<Winkler>(&law)) {
    out.line("law", "winkler");
    out.line("normal_contact_stiffness", winkler->normal_contact_stiffness);
    out.line("normal_exponent", winkler->normal_exponent);
    out.line("normal_damping", winkler->normal_damping);
  } else if (const auto* mass = std::get_if<MassSpringDamper>(&law)) {
    out.line("law", "mass_spring_damper");
    out.line("normal_contact_stiffness", mass->normal_contact_stiffness);
    out.line("mass", mass->mass);
    out.line("stiffness", mass->stiffness);
    out.line("damping", mass->damping);
  } else if (const auto* mask = std::get_if<DeformationMask>(&law)) {
    out.line("law", "deformation_mask");
    out.line("normal_contact_stiffness", mask->normal_contact_stiffness);
    out.line("saturation_pressure", mask->saturation_pressure);
  } else if (const auto* proximity = std::get_if<Proximity>(&law)) {
    out.line("law", "proximity");
    out.line("sensitivity", proximity->sensitivity);
  } else if (const auto* layer = std::get_if<ElasticLayer>(&law)) {
    out.line("law", "elastic_layer");
    out.line("elastic_modulus", layer->elastic_modulus);
    out.line("poisson_ratio", layer->poisson_ratio);
    out.line("base", layer->base == ElasticLayer::Base::kBonded ? "bonded" : "half_space");
    out.line("iterations", layer->iterations);
    out.line("tolerance", layer->tolerance);
  } else if (const auto* lugre = std::get_if<LuGre>(&law)) {
    out.line("law", "lugre");
    out.line("normal_contact_stiffness", lugre->normal_contact_stiffness);
    out.line("bristle_stiffness", lugre->bristle_stiffness);
    out.line("bristle_damping", lugre->bristle_damping);
    out.line("viscous_friction", lugre->viscous_friction);
    out.line("static_friction", lugre->static_friction);
    out.line("coulomb_friction", lugre->coulomb_friction);
    out.line("stribeck_velocity", lugre->stribeck_velocity);
  }
}

void writeSkin(const Skin& skin, Writer& out) {
  out.line("thickness", skin.thickness);
  writeLaw(skin.law, out);
  if (std::holds_alternative<ElasticLayer>(skin.law)) out.line("margin", skin.margin);
  if (skin.friction.friction_coefficient > 0) {
    out.line("friction_coefficient", skin.friction.friction_coefficient);
    out.line("tangential_stiffness", skin.friction.tangential_stiffness);
  }
  writeTerms("relaxation", skin.relaxation, out);
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
  out.line("normalization", psf.normalization == Psf::Normalization::kPerSource ? "per_source" : "none");
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
  out.line("output_scale", readout.output_scale);
  out.line("trigger", readout.trigger);
  out.line("adc_bits", readout.adc_bits);
  out.line("saturation", readout.saturation);
  out.line("noise", readout.noise);
  if (!readout.taxel_gain.empty()) out.line("taxel_gain", readout.taxel_gain);
  if (!readout.taxel_trigger.empty()) out.line("taxel_trigger", readout.taxel_trigger);
  if (!readout.hysteresis_strength.empty()) {
    out.line("hysteresis_strength", readout.hysteresis_strength);
    out.line("hysteresis_width", readout.hysteresis_width);
  }
  writeTerms("creep", readout.creep, out);
  out.line("low_pass_time", readout.low_pass_time);
  out.line("delay", readout.delay);
  out.line("jitter", readout.jitter);
  out.line("bias", readout.bias);
  out.line("random_walk", readout.random_walk);
  out.line("gain_spread", readout.gain_spread);
  out.line("press_gain_spread", readout.press_gain_spread);
  out.line("dead_taxel_probability", readout.dead_taxel_probability);
}

}  // namespace

std::string sensorText(const Sensor& sensor, const std::map<std::string, std::string>& notes) {
  Writer out(notes);
  out.line("format_version", static_cast<int>(kFormatVersion));
  out.line("name", canonicalText(sensor.name));
  writePatches(sensor, out);
  out.line("samples_per_taxel", sensor.samples_per_taxel);
  out.line("frame_rate", sensor.frame_rate);
  out.block("skin", [&] { writeSkin(sensor.skin, out); });
  out.block("psf", [&] { writePsf(sensor.psf, out); });
  out.block("readout", [&] { writeReadout(sensor.readout, out); });
  const auto head = notes.find("");
  return (head == notes.end() ? "" : "# " + oneLine(head->second) + "\n") + out.text();
}

}  // namespace taxelsim
