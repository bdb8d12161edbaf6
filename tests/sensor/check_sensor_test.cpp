

#include "sensor/example_sensor.h"
#include "support/input_error.h"
#include "support/test.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::string errorOf(const Sensor& sensor) {
  return support::refusal([&] { checkSensor(sensor); });
}

void expectRefused(const std::string& field, const std::function<void(Sensor&)>& change) {
  Sensor sensor = exampleSensor();
  change(sensor);
  const std::string line = errorOf(sensor);
  EXPECT_EQ(line.rfind(field + ": ", 0), 0u) << "expected " << field << ", got: " << line;
  EXPECT_NE(line.find(" is not allowed: "), std::string::npos) << line;
}

void expectAccepted(const std::function<void(Sensor&)>& change) {
  Sensor sensor = exampleSensor();
  change(sensor);
  EXPECT_EQ(errorOf(sensor), support::kNoRefusal);
}

Winkler& law(Sensor& sensor) {
  return std::get<Winkler>(sensor.skin.law);
}

TEST(CheckSensor, AcceptsTheExampleAndTheEndsOfRanges) {
  expectAccepted([](Sensor&) {});
  expectAccepted([](Sensor& s) { s.patches[0].num_rows = kMaxTaxelsPerSide; });
  expectAccepted([](Sensor& s) { s.samples_per_taxel = kMaxSamplesPerTaxel; });
  expectAccepted([](Sensor& s) { law(s).normal_exponent = 3; });
  expectAccepted([](Sensor& s) { s.readout.noise = 0; });
  expectAccepted([](Sensor& s) { s.readout.trigger = 0; });
  expectAccepted([](Sensor& s) { s.frame_rate = 0; });
  expectAccepted([](Sensor& s) { s.psf = Psf{}; });
  expectAccepted([](Sensor& s) { s.readout.taxel_gain.assign(84, 0.0); });
  expectAccepted([](Sensor& s) { s.patches[0].X_SP.rotation = {0.7071, 0.7071, 0, 0}; });
}

TEST(CheckSensor, LawsOnLists) {
  const auto list = [](Sensor& s) {
    s.skin.law = DeformationMask{};
    s.skin.friction = {};
    s.psf = {};
    s.readout.taxel_gain.clear();
    s.readout.taxel_trigger.clear();
    s.patches = {taxelPatch("a", {0, 0, 0}, {0, 0, 1}, {1e-3, 1e-3}), taxelPatch("b", {1e-3, 0, 0}, {0.1, 0, 1}, {1e-3, 1e-3})};
  };
  expectAccepted(list);
  expectRefused("patches", [&](Sensor& s) { list(s), s.skin.law = ElasticLayer{.elastic_modulus = 1e5}; });
  expectRefused("psf.sigma", [&](Sensor& s) {
    list(s), s.patches.pop_back(), s.skin.law = ElasticLayer{.elastic_modulus = 1e5};
    s.psf.sigma = 1e-3;
  });
  expectAccepted([&](Sensor& s) { list(s), s.skin.law = Proximity{.sensitivity = 1e8}; });
  expectAccepted([&](Sensor& s) { list(s), s.patches.pop_back(); });
}

TEST(CheckSensor, ReportsFieldValueAndAllowedNumbers) {
  Sensor sensor = exampleSensor();
  sensor.readout.noise = -1;
  try {
    checkSensor(sensor);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.field(), "readout.noise");
    EXPECT_EQ(error.reason(), "-1 is not allowed: a number >= 0 counts");
  }
  EXPECT_EQ(errorOf(sensor), "readout.noise: -1 is not allowed: a number >= 0 counts");
}

TEST(CheckSensor, Patches) {
  expectRefused("patches", [](Sensor& s) { s.patches.clear(); });
  for (const int bad : {0, -1, kMaxTaxelsPerSide + 1}) {
    expectRefused("patches[0].num_rows", [&](Sensor& s) { s.patches[0].num_rows = bad; });
    expectRefused("patches[0].num_cols", [&](Sensor& s) { s.patches[0].num_cols = bad; });
  }
  const auto many = [](Sensor& s) {
    s.patches.assign(kMaxTaxels / (128 * 128), {.name = "grid", .num_rows = 128, .num_cols = 128, .pitch = {1e-3, 1e-3}, .X_SP = {}});
  };
  expectAccepted(many);
  expectRefused("patches", [&](Sensor& s) { many(s), s.patches.push_back(s.patches[0]); });
  for (const double bad : {0.0, -1e-3, kNan, kInfinity}) {
    expectRefused("patches[0].pitch[1]", [&](Sensor& s) { s.patches[0].pitch[1] = bad; });
  }
  expectRefused("patches[1].pitch[0]",
                [](Sensor& s) { s.patches.push_back({.name = "bare", .num_rows = 1, .num_cols = 1, .pitch = {}, .X_SP = {}}); });
  expectRefused("patches[0].X_SP.position[2]", [](Sensor& s) { s.patches[0].X_SP.position[2] = kNan; });
  expectRefused("patches[0].X_SP.rotation", [](Sensor& s) { s.patches[0].X_SP.rotation = {1, 1, 0, 0}; });
  expectRefused("patches[0].X_SP.rotation", [](Sensor& s) { s.patches[0].X_SP.rotation = {0, 0, 0, 0}; });
  expectRefused("patches[0].X_SP.rotation", [](Sensor& s) { s.patches[0].X_SP.rotation = {kNan, 0, 0, 0}; });
}

TEST(CheckSensor, SamplesSkinAndLaw) {
  for (const int bad : {0, -3, kMaxSamplesPerTaxel + 1}) expectRefused("samples_per_taxel", [&](Sensor& s) { s.samples_per_taxel = bad; });
  for (const double bad : {0.0, -1.0, kNan, kInfinity}) {
    expectRefused("skin.thickness", [&](Sensor& s) { s.skin.thickness = bad; });
    expectRefused("skin.normal_contact_stiffness", [&](Sensor& s) { law(s).normal_contact_stiffness = bad; });
  }
  for (const double bad : {0.5, 3.5, kNan, kInfinity})
    expectRefused("skin.normal_exponent", [&](Sensor& s) { law(s).normal_exponent = bad; });
  for (const double bad : {-1.0, kNan, kInfinity}) expectRefused("skin.normal_damping", [&](Sensor& s) { law(s).normal_damping = bad; });
  expectRefused("skin", [](Sensor& s) { law(s).normal_contact_stiffness = 1e308, s.skin.thickness = 1e10; });
}

TEST(CheckSensor, Friction) {
  expectAccepted([](Sensor& s) { s.skin.friction = {1e8, 0.5}; });
  expectAccepted([](Sensor& s) { s.skin.friction = {kMaxTangentialStiffness, kMaxFrictionCoefficient}; });
  for (const double bad : {-0.1, 2 * kMaxFrictionCoefficient, kNan, kInfinity}) {
    expectRefused("skin.friction_coefficient", [&](Sensor& s) { s.skin.friction = {1e8, bad}; });
  }
  for (const double bad : {0.0, -1.0, 2 * kMaxTangentialStiffness, kNan, kInfinity}) {
    expectRefused("skin.tangential_stiffness", [&](Sensor& s) { s.skin.friction = {bad, 0.5}; });
  }
  for (const double bad : {1.0, -1.0, kNan}) {
    expectRefused("skin.tangential_stiffness", [&](Sensor& s) { s.skin.friction = {bad, 0}; });
  }
}

TEST(CheckSensor, ElasticLayer) {
  const auto with = [](const std::function<void(Sensor&, ElasticLayer&)>& change) {
    return [change](Sensor& s) {
      s.skin.law = ElasticLayer{.elastic_modulus = 1e6};
      change(s, std::get<ElasticLayer>(s.skin.law));
    };
  };
  expectAccepted(with([](Sensor&, ElasticLayer&) {}));
  expectAccepted(with([](Sensor& s, ElasticLayer& l) { l.poisson_ratio = 0.5, s.skin.margin = 0.01; }));
  for (const double bad : {0.0, -1.0, kNan, kInfinity}) {
    expectRefused("skin.elastic_modulus", with([&](Sensor&, ElasticLayer& l) { l.elastic_modulus = bad; }));
  }
  for (const double bad : {-0.1, 0.51, kNan}) {
    expectRefused("skin.poisson_ratio", with([&](Sensor&, ElasticLayer& l) { l.poisson_ratio = bad; }));
  }
  for (const int bad : {0, 1001}) expectRefused("skin.iterations", with([&](Sensor&, ElasticLayer& l) { l.iterations = bad; }));
  for (const double bad : {0.0, 1.0, kNan}) expectRefused("skin.tolerance", with([&](Sensor&, ElasticLayer& l) { l.tolerance = bad; }));
  for (const double bad : {-1.0, 2.0, kNan, kInfinity}) {
    expectRefused("skin.margin", with([&](Sensor& s, ElasticLayer&) { s.skin.margin = bad; }));
  }
  expectRefused("skin.margin", [](Sensor& s) { s.skin.margin = 0.001; });  // allowed for elastic_layer only
  expectRefused("patches", with([](Sensor& s, ElasticLayer&) { s.patches.push_back(s.patches[0]); }));
  expectRefused("patches[0].pitch", with([](Sensor& s, ElasticLayer&) { s.patches[0].pitch[1] = s.patches[0].pitch[0] / 20; }));
  expectRefused("skin.thickness", with([](Sensor& s, ElasticLayer&) { s.skin.thickness = 1e-5; }));
  expectRefused("skin.thickness", with([](Sensor& s, ElasticLayer&) { s.skin.thickness = 1; }));
  expectAccepted(with([](Sensor& s, ElasticLayer& l) { s.skin.thickness = 1e-5, l.base = ElasticLayer::Base::kHalfSpace; }));
  expectRefused("samples_per_taxel", with([](Sensor& s, ElasticLayer&) {
                  s.patches[0].num_rows = s.patches[0].num_cols = kMaxTaxelsPerSide;
                  s.samples_per_taxel = 8;
                }));
}

TEST(CheckSensor, LuGre) {
  const auto lugre = [](Sensor& s) -> LuGre& { return s.skin.law.emplace<LuGre>(LuGre{.normal_contact_stiffness = 1.73e8}); };
  expectAccepted([&](Sensor& s) { lugre(s); });
  expectAccepted([&](Sensor& s) { lugre(s).bristle_damping = 0; });
  expectAccepted([&](Sensor& s) { lugre(s).viscous_friction = 0; });
  expectAccepted([&](Sensor& s) {
    s.skin.law = LuGre{1.73e8, kMaxBristle, kMaxBristle, kMaxBristle, kMaxFrictionCoefficient, kMinLuGreFriction, 1e-30};
  });
  for (const double bad : {0.0, -1.0, 2 * kMaxBristle, kNan, kInfinity}) {
    expectRefused("skin.bristle_stiffness", [&](Sensor& s) { lugre(s).bristle_stiffness = bad; });
  }
  for (const double bad : {-1.0, 2 * kMaxBristle, kNan, kInfinity}) {
    expectRefused("skin.bristle_damping", [&](Sensor& s) { lugre(s).bristle_damping = bad; });
    expectRefused("skin.viscous_friction", [&](Sensor& s) { lugre(s).viscous_friction = bad; });
  }
  for (const double bad : {0.0, -1.0, 2 * kMaxFrictionCoefficient, kNan}) {
    expectRefused("skin.coulomb_friction", [&](Sensor& s) { lugre(s).coulomb_friction = bad; });
  }
  for (const double bad : {0.9, 2 * kMaxFrictionCoefficient, kNan}) {
    expectRefused("skin.static_friction", [&](Sensor& s) { lugre(s).static_friction = bad; });
  }
  for (const double bad : {0.0, -1.0, kNan, kInfinity}) {
    expectRefused("skin.normal_contact_stiffness", [&](Sensor& s) { lugre(s).normal_contact_stiffness = bad; });
    expectRefused("skin.stribeck_velocity", [&](Sensor& s) { lugre(s).stribeck_velocity = bad; });
  }
}

TEST(CheckSensor, AcceptsFrictionForThreeLaws) {
  for (const ContactLaw& law :
       std::vector<ContactLaw>{MassSpringDamper{.normal_contact_stiffness = 1e8}, ElasticLayer{.elastic_modulus = 1e6}}) {
    expectAccepted([&](Sensor& s) { s.skin.law = law, s.skin.friction = {1e8, 0.5}; });
  }
  for (const ContactLaw& law : std::vector<ContactLaw>{DeformationMask{}, Proximity{1e8}, LuGre{.normal_contact_stiffness = 1e8}}) {
    expectRefused("skin.friction_coefficient", [&](Sensor& s) { s.skin.law = law, s.skin.friction = {1e8, 0.5}; });
  }
}

TEST(CheckSensor, Relaxation) {
  expectAccepted([](Sensor& s) { s.skin.relaxation.assign(4, {.fraction = 0, .time = 1e-30}); });
  expectAccepted([](Sensor& s) { s.skin.relaxation = {{0.5, 1e6}, {0.499999, 1e-6}}; });
  expectAccepted([](Sensor& s) { s.skin.relaxation = {{0.5, 1}}, s.skin.law = DeformationMask{}; });
  expectAccepted([](Sensor& s) { s.skin.relaxation = {{0.5, 1}}, s.skin.law = ElasticLayer{.elastic_modulus = 1e6}; });
  expectAccepted([](Sensor& s) { s.skin.relaxation = {{0.5, 1}}, s.skin.friction = {1e8, 0.5}; });
  expectRefused("skin.relaxation", [](Sensor& s) { s.skin.relaxation.assign(5, {.fraction = 0.1, .time = 1}); });
  expectRefused("skin.relaxation", [](Sensor& s) { s.skin.relaxation = {{0.5, 1}, {0.5, 2}}; });
  expectRefused("skin.relaxation", [](Sensor& s) { s.skin.relaxation = {{0.5, 1}}, s.skin.law = Proximity{.sensitivity = 1e8}; });
  expectRefused("skin.relaxation", [](Sensor& s) { s.skin.relaxation = {{0.5, 1}}, law(s).normal_damping = 1; });
  for (const double bad : {-0.1, 1.0, kNan, kInfinity})
    expectRefused("skin.relaxation[0].fraction", [&](Sensor& s) { s.skin.relaxation = {{bad, 1}}; });
  for (const double bad : {-1.0, 0.0, kNan, kInfinity})
    expectRefused("skin.relaxation[1].time", [&](Sensor& s) { s.skin.relaxation = {{0, 1}, {0, bad}}; });
}

TEST(CheckSensor, Psf) {
  for (const int bad : {-1, 0, 2, 11}) expectRefused("psf.size", [&](Sensor& s) { s.psf.size = bad; });
  expectRefused("psf.kernel", [](Sensor& s) { s.psf.size = 5; });
  for (const double bad : {-0.1, kNan, kInfinity}) expectRefused("psf.kernel[3]", [&](Sensor& s) { s.psf.kernel[3] = bad; });
  expectRefused("psf.kernel", [](Sensor& s) { s.psf.kernel.assign(9, 0.0); });
}

TEST(CheckSensor, RefusesPsfWhoseNormalizationDividesByZero) {
  // The kernel moves all force one row up, so the last row keeps none.
  const auto shift = [](Sensor& s) { s.psf.kernel = {0, 0, 0, 0, 0, 0, 0, 1, 0}; };
  expectRefused("psf.kernel", shift);
  expectAccepted([&](Sensor& s) { shift(s), s.psf.normalization = Psf::Normalization::kNone; });
  // The four neighbours without the middle: valid on a grid, not for a single taxel, which has no neighbour.
  const auto ring = [](Sensor& s) { s.psf.kernel = {0, 1, 0, 1, 0, 1, 0, 1, 0}; };
  expectAccepted(ring);
  expectRefused("psf.kernel", [&](Sensor& s) { ring(s), s.patches[0].num_rows = s.patches[0].num_cols = 1; });
}

TEST(CheckSensor, Readout) {
  for (const double bad : {0.0, -1.0, kNan, kInfinity})
    expectRefused("readout.output_scale", [&](Sensor& s) { s.readout.output_scale = bad; });
  for (const double bad : {-1.0, kNan, kInfinity}) {
    expectRefused("readout.noise", [&](Sensor& s) { s.readout.noise = bad; });
    expectRefused("frame_rate", [&](Sensor& s) { s.frame_rate = bad; });
    expectRefused("readout.taxel_gain[83]", [&](Sensor& s) { s.readout.taxel_gain.assign(84, 1.0), s.readout.taxel_gain[83] = bad; });
  }
  for (const double bad : {kNan, kInfinity}) {
    expectRefused("readout.trigger", [&](Sensor& s) { s.readout.trigger = bad; });
    expectRefused("readout.taxel_trigger[0]",
                  [&](Sensor& s) { s.readout.taxel_trigger.assign(84, 0.0), s.readout.taxel_trigger[0] = bad; });
    expectRefused("readout.calibrated_gain[41]",
                  [&](Sensor& s) { s.readout.calibrated_gain.assign(84, 1.0), s.readout.calibrated_gain[41] = bad; });
  }
  expectAccepted([](Sensor& s) { s.readout.trigger = -1, s.readout.taxel_trigger.assign(84, -1.0); });
  for (const int bad : {0, 17, -1, 64}) expectRefused("readout.adc_bits", [&](Sensor& s) { s.readout.adc_bits = bad; });
  for (const int bad : {0, -1, 4096}) expectRefused("readout.saturation", [&](Sensor& s) { s.readout.saturation = bad; });
  expectAccepted([](Sensor& s) { s.readout.adc_bits = 16, s.readout.saturation = 65535; });
  expectRefused("readout.taxel_gain", [](Sensor& s) { s.readout.taxel_gain.assign(83, 1.0); });
  expectRefused("readout.taxel_trigger", [](Sensor& s) { s.readout.taxel_trigger.assign(85, 0.0); });
  expectRefused("readout.calibrated_gain", [](Sensor& s) { s.readout.calibrated_gain.assign(2, 1.0); });
}

TEST(CheckSensor, ThreeAxisTaxels) {
  const ThreeAxisReadout axes{.gain = {{{100, 0, 0}, {0, 100, 0}, {0, 0, 100}}}};
  const auto refused = [&](const char* field, const std::function<void(ThreeAxisReadout&)>& change) {
    expectRefused(field, [&](Sensor& s) { s.skin.friction = {1e9, 0.5}, s.readout.three_axis = axes, change(*s.readout.three_axis); });
  };
  expectAccepted([&](Sensor& s) { s.skin.friction = {1e9, 0.5}, s.readout.three_axis = axes; });
  expectRefused("readout.three_axis", [&](Sensor& s) { s.skin.friction = {}, s.readout.three_axis = axes; });
  refused("readout.three_axis.gain[1]", [](ThreeAxisReadout& a) { a.gain[1] = {0, 0, 0}; });
  for (const double bad : {-1.0, kNan, kInfinity}) {
    refused("readout.three_axis.noise[0]", [&](ThreeAxisReadout& a) { a.noise[0] = bad; });
    refused("readout.three_axis.hysteresis_width[2]", [&](ThreeAxisReadout& a) { a.hysteresis_width[2] = bad; });
    refused("readout.three_axis.hysteresis_strength[1]", [&](ThreeAxisReadout& a) { a.hysteresis_strength[1] = bad; });
  }
  refused("readout.three_axis.hysteresis_strength[0]", [](ThreeAxisReadout& a) { a.hysteresis_strength[0] = 1; });
  refused("readout.three_axis.gain[2][1]", [](ThreeAxisReadout& a) { a.gain[2][1] = kNan; });
  for (const int bad : {0, -1, kMaxAxisCounts + 1}) {
    refused("readout.three_axis.saturation", [&](ThreeAxisReadout& a) { a.saturation = bad; });
  }
}

TEST(CheckSensor, ReadoutOverTime) {
  expectAccepted([](Sensor& s) { s.readout.hysteresis_strength = {0.5, 0.4}, s.readout.hysteresis_width = {0, 1}; });
  expectRefused("readout.hysteresis_strength", [](Sensor& s) { s.readout.hysteresis_strength.assign(5, 0.1); });
  expectRefused("readout.hysteresis_width", [](Sensor& s) { s.readout.hysteresis_strength = {0.5}; });
  expectRefused("readout.hysteresis_strength", [](Sensor& s) {
    s.readout.hysteresis_strength = {0.5, 0.5}, s.readout.hysteresis_width = {1, 1};
  });
  expectAccepted([](Sensor& s) { s.readout.creep.assign(4, {.fraction = 0, .time = 1e-6}); });
  expectRefused("readout.creep", [](Sensor& s) { s.readout.creep.assign(5, {.fraction = 0, .time = 1}); });
  for (const double bad : {-1.0, kNan, kInfinity}) {
    expectRefused("readout.hysteresis_strength[0]",
                  [&](Sensor& s) { s.readout.hysteresis_strength = {bad}, s.readout.hysteresis_width = {1}; });
    expectRefused("readout.hysteresis_width[0]",
                  [&](Sensor& s) { s.readout.hysteresis_strength = {0.1}, s.readout.hysteresis_width = {bad}; });
    expectRefused("readout.creep[0].fraction", [&](Sensor& s) { s.readout.creep = {{bad, 1}}; });
    expectRefused("readout.creep[0].time", [&](Sensor& s) { s.readout.creep = {{1, bad}}; });
    expectRefused("readout.low_pass_time", [&](Sensor& s) { s.readout.low_pass_time = bad; });
    expectRefused("readout.delay", [&](Sensor& s) { s.readout.delay = bad; });
    expectRefused("readout.jitter", [&](Sensor& s) { s.readout.jitter = bad; });
  }
  expectRefused("readout.creep[0].time", [](Sensor& s) { s.readout.creep = {{1, 0}}; });
  // The sensor of the example has a frame rate of 100 Hz.
  expectAccepted([](Sensor& s) { s.readout.jitter = 0.01; });
  expectRefused("readout.jitter", [](Sensor& s) { s.readout.jitter = 0.011; });
  expectRefused("readout.jitter", [](Sensor& s) { s.readout.jitter = 1e-9, s.frame_rate = 0; });
}

TEST(CheckSensor, Imperfections) {
  expectAccepted([](Sensor& s) { s.readout.dead_taxel_probability = 1, s.readout.bias = 1e9, s.readout.gain_spread = 2; });
  for (const double bad : {-1e-9, 1.1e9, kNan, kInfinity}) {
    expectRefused("readout.bias", [&](Sensor& s) { s.readout.bias = bad; });
    expectRefused("readout.random_walk", [&](Sensor& s) { s.readout.random_walk = bad; });
    expectRefused("readout.gain_spread", [&](Sensor& s) { s.readout.gain_spread = bad; });
    expectRefused("readout.press_gain_spread", [&](Sensor& s) { s.readout.press_gain_spread = bad; });
    expectRefused("readout.dead_taxel_probability", [&](Sensor& s) { s.readout.dead_taxel_probability = bad; });
  }
}

TEST(CheckSensor, Curve) {
  expectRefused("readout.curve", [](Sensor& s) { s.readout.curve.clear(); });
  expectRefused("readout.curve", [](Sensor& s) { s.readout.curve.assign(6, 1.0); });
  expectRefused("readout.curve[1]", [](Sensor& s) { s.readout.curve = {1, kNan}; });
  expectRefused("readout.curve", [](Sensor& s) { s.readout.curve = {0}; });
  expectRefused("readout.curve", [](Sensor& s) { s.readout.curve = {-100}; });
  // The force at full depth is 1.73e8 x 1.45e-3 x (3.4e-3)^2 = 2.9 N. This curve has its maximum at 2 N
  // (2400 counts), the next one at 3 N (5400 counts).
  expectRefused("readout.curve", [](Sensor& s) { s.readout.curve = {2400, -600}; });
  expectAccepted([](Sensor& s) { s.readout.curve = {3600, -600}; });
  // Valid as well: it saturates below its maximum.
  expectAccepted([](Sensor& s) { s.readout.curve = {2400, -600}, s.readout.saturation = 2399; });
  expectRefused("readout.curve", [](Sensor& s) { s.readout.curve = {2400, -600}, s.readout.saturation = 2401; });
  // A higher gain gives forces further along the curve.
  expectRefused("readout.curve", [](Sensor& s) {
    s.readout.curve = {1200, -200};  // maximum 1800 counts at 3 N
    s.readout.taxel_gain.assign(84, 1.0);
    s.readout.taxel_gain[7] = 1.1;
  });
  expectAccepted([](Sensor& s) { s.readout.curve = {1200, -200}; });
  // Creep increases the force as well.
  expectRefused("readout.curve", [](Sensor& s) { s.readout.curve = {1200, -200}, s.readout.creep = {{0.1, 1}}; });
}

TEST(CheckSensor, CurvePoints) {
  const auto points = [](std::vector<CurvePoint> all) {
    return [all](Sensor& s) {
      s.readout.curve = {1};
      s.readout.curve_points = all;
    };
  };
  expectAccepted(points({{0.5, 800}, {1, 1900}}));
  std::vector<CurvePoint> many;
  for (int k = 1; k <= 16; ++k) many.push_back({0.1 * k, 100.0 * k * k});
  expectAccepted(points(many));
  many.push_back({2, 1e5});
  expectRefused("readout.curve_points", points(many));
  expectRefused("readout.curve_points[0].force", points({{0, 800}}));
  expectRefused("readout.curve_points[0].counts", points({{0.5, 0}}));
  expectRefused("readout.curve_points[1].force", points({{0.5, 800}, {0.5, 900}}));
  expectRefused("readout.curve_points[1].counts", points({{0.5, 800}, {0.6, 800}}));
  expectRefused("readout.curve_points[1].counts", points({{0.5, 800}, {0.6, 700}}));
  expectRefused("readout.curve_points[1].force", points({{0.5, 800}, {kNan, 900}}));
  expectRefused("readout.curve_points[0].counts", points({{0.5, kNan}}));
  expectRefused("readout.curve_points[0].counts", points({{0.5, kInfinity}}));
  expectRefused("readout.curve_points[0]", points({{1e-20, 1e20}}));
  expectRefused("readout.curve_points", [](Sensor& s) { s.readout.curve = {2400}, s.readout.curve_points = {{1, 2}}; });
  expectRefused("readout.curve_limit", [](Sensor& s) {
    s.readout.curve = {1}, s.readout.curve_points = {{1, 2}};
    s.readout.curve_limit = 5000;
  });
}

}  // namespace
}  // namespace taxelsim
