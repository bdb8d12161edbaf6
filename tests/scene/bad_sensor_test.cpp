// Errors in the settings of a sensor: position, key, value found, what is allowed.
#include "bad_scene.h"

namespace taxelsim {
namespace {

TEST(BadSensors, SkinAndLaw) {
  expectRefusals(
      {BadScene{kSkin, "{thickness: 0, normal_contact_stiffness: 1}", ":9:21: sensor.skin.thickness: 0 is not allowed: a number > 0 m"},
       BadScene{kSkin, "{thickness: 1, law: honey, normal_contact_stiffness: 1}", ":9:29: sensor.skin.law: honey is not allowed: winkler"},
       BadScene{kSkin, "{thickness: 1, law: deformation_mask, mass: 1}",
                ":9:53: sensor.skin.mass: not a key of law deformation_mask but of mass_spring_damper"},
       BadScene{kSkin, "{thickness: 1, law: proximity, normal_contact_stiffness: 1}",
                ":9:66: sensor.skin.normal_contact_stiffness: not a key of law proximity but of winkler"},
       BadScene{kSkin, "{thickness: 1, law: proximity}", ":9:9: sensor.skin: sensitivity is missing: a number > 0 N/m^3"},
       BadScene{kSkin, "{thickness: 1, law: proximity, sensitivity: 1e8}",
                ":24:9: randomization.load: the sensor's law proximity has no forces: give depth[_mm] instead"},
       BadScene{kSkin, "{thickness: 1, law: mass_spring_damper, normal_contact_stiffness: 1, mass: 0}",
                ":9:84: sensor.skin.mass: 0 is not allowed: a number > 0 kg"},
       BadScene{kSkin, "{thickness: 1, law: mass_spring_damper, normal_contact_stiffness: 1, damping: -1}",
                ":9:87: sensor.skin.damping: -1 is not allowed: a number >= 0 N s/m"},
       BadScene{kSkin, "{thickness: 1, law: deformation_mask, saturation_pressure: 0}",
                ":9:68: sensor.skin.saturation_pressure: 0 is not allowed: a number > 0 Pa"},
       BadScene{kSkin, "soft", ":9:9: sensor.skin: soft is not allowed: a mapping of thickness[_mm], law"}});
}

TEST(BadSensors, DepthSampling) {
  expectRefusals({BadScene{"  pitch_mm: 3.4\n", "  pitch_mm: 3.4\n  depth_sampling: mean\n",
                           ":9:19: sensor.depth_sampling: mean is not allowed: point | area"}});
}

TEST(BadSensors, TaxelsOfAllPatches) {
  std::string patches = "  patches:\n";
  for (int i = 0; i < 20'000; ++i) patches += "    - {num_rows: 128, num_cols: 128, pitch_mm: 1}\n";
  expectRefusals({BadScene{"  num_rows: 3\n  num_cols: 4\n  pitch_mm: 3.4\n", patches,
                           ":23:7: sensor.patches[16]: more than 262144 taxels with those of the earlier patches"}});
}

TEST(BadSensors, FrictionAndLuGre) {
  expectRefusals(
      {BadScene{kSkin, "{thickness: 1, normal_contact_stiffness: 1, friction_coefficient: -0.5}",
                ":9:75: sensor.skin.friction_coefficient: -0.5 is not allowed: a number from 0 to 1000"},
       BadScene{kSkin, "{thickness: 1, normal_contact_stiffness: 1, friction_coefficient: 0.5}",
                ":9:9: sensor.skin: tangential_stiffness is missing: a number > 0 N/m^3"},
       BadScene{kSkin, "{thickness: 1, normal_contact_stiffness: 1, friction_coefficient: 0.5, tangential_stiffness: 0}",
                ":9:102: sensor.skin.tangential_stiffness: 0 is not allowed: a number > 0 N/m^3"},
       BadScene{kSkin, "{thickness: 1, normal_contact_stiffness: 1, tangential_stiffness: 1e8}",
                ":9:75: sensor.skin.tangential_stiffness: given without friction: needs friction_coefficient > 0"},
       BadScene{kSkin, "{thickness: 1, law: deformation_mask, friction_coefficient: 0.5, tangential_stiffness: 1e8}",
                ":9:69: sensor.skin.friction_coefficient: 0.5 is not allowed: 0 for a law other than winkler, mass_spring_damper and "
                "elastic_layer"},
       BadScene{kSkin, "{thickness: 1, law: lugre, normal_contact_stiffness: 1, friction_coefficient: 0.5, tangential_stiffness: 1e8}",
                ":9:87: sensor.skin.friction_coefficient: 0.5 is not allowed: 0 with the law lugre, which has its own friction"},
       BadScene{kSkin, "{thickness: 1, law: pasternak, normal_contact_stiffness: 1, shear_stiffness: 1, iterations: 0}",
                ":9:29: sensor.skin.law: pasternak is not allowed: removed; use elastic_layer, or winkler with depth_sampling: area"},
       BadScene{kSkin, "{thickness: 1, law: lugre}", ":9:9: sensor.skin: normal_contact_stiffness is missing: a number > 0 N/m^3"},
       BadScene{kSkin, "{thickness: 1, law: lugre, normal_contact_stiffness: 1, mass: 1}",
                ":9:71: sensor.skin.mass: not a key of law lugre but of mass_spring_damper"},
       BadScene{kSkin, "{thickness: 1, normal_contact_stiffness: 1, static_friction: 1}",
                ":9:70: sensor.skin.static_friction: not a key of law winkler but of lugre"},
       BadScene{kSkin, "{thickness: 1, law: lugre, normal_contact_stiffness: 1, static_friction: 0.5}",
                ":9:82: sensor.skin.static_friction: 0.5 is not allowed: coulomb_friction (1) to 1000"},
       BadScene{kSkin, "{thickness: 1, law: lugre, normal_contact_stiffness: 1, coulomb_friction: 0}",
                ":9:83: sensor.skin.coulomb_friction: 0 is not allowed: a number from 1e-09 to 1000"},
       BadScene{kSkin, "{thickness: 1, law: lugre, normal_contact_stiffness: 1, bristle_stiffness: 2e12}",
                ":9:84: sensor.skin.bristle_stiffness: 2e12 is not allowed: a number > 0 and <= 1e+12 1/m"},
       BadScene{kSkin, "{thickness: 1, law: lugre, normal_contact_stiffness: 1, bristle_damping: -1}",
                ":9:82: sensor.skin.bristle_damping: -1 is not allowed: a number from 0 to 1e+12 s/m"},
       BadScene{kSkin, "{thickness: 1, law: lugre, normal_contact_stiffness: 1, viscous_friction: -1}",
                ":9:83: sensor.skin.viscous_friction: -1 is not allowed: a number from 0 to 1e+12 s/m"},
       BadScene{kSkin, "{thickness: 1, law: lugre, normal_contact_stiffness: 1, stribeck_velocity: 0}",
                ":9:84: sensor.skin.stribeck_velocity: 0 is not allowed: a number > 0 m/s"}});
}

TEST(BadSensors, ElasticLayer) {
  expectRefusals(
      {BadScene{kSkin, "{thickness: 0.002, law: elastic_layer, poisson_ratio: 0.49}", ":9:9: sensor.skin: elastic_modulus is missing"},
       BadScene{kSkin, "{thickness: 0.002, law: elastic_layer, elastic_modulus: 1e6}", ":9:9: sensor.skin: poisson_ratio is missing"},
       BadScene{kSkin, "{thickness: 0.002, law: elastic_layer, elastic_modulus: 0, poisson_ratio: 0.49}",
                ":9:65: sensor.skin.elastic_modulus: 0 is not allowed: a number > 0 Pa"},
       BadScene{kSkin, "{thickness: 0.002, law: elastic_layer, elastic_modulus: 1e6, poisson_ratio: 0.51}",
                ":9:85: sensor.skin.poisson_ratio: 0.51 is not allowed: a number from 0 to 0.5"},
       BadScene{kSkin, "{thickness: 0.002, law: elastic_layer, elastic_modulus: 1e6, poisson_ratio: 0.5, base: glued}",
                ":9:96: sensor.skin.base: glued is not allowed: half_space | bonded"},
       BadScene{kSkin, "{thickness: 0.002, law: elastic_layer, elastic_modulus: 1e6, poisson_ratio: 0.5, iterations: 0}",
                ":9:102: sensor.skin.iterations: 0 is not allowed: a whole number from 1 to 1000"},
       BadScene{kSkin, "{thickness: 0.002, law: elastic_layer, elastic_modulus: 1e6, poisson_ratio: 0.5, tolerance: 1e-6}",
                ":9:101: sensor.skin.tolerance: 1e-6 is not allowed: a number from 1e-05 to 0.1"},
       BadScene{kSkin, "{thickness: 0.002, law: elastic_layer, elastic_modulus: 1e6, poisson_ratio: 0.5, margin: -1}",
                ":9:98: sensor.skin.margin: -1 is not allowed: a number from 0 to 1 m"},
       BadScene{kSkin, "{thickness: 0.002, law: elastic_layer, elastic_modulus: 1e6, poisson_ratio: 0.5, margin: 1}",
                ":9:98: sensor.skin.margin: 1 is not allowed: at most 1024 samples"},
       BadScene{kSkin, "{thickness: 1e-6, law: elastic_layer, elastic_modulus: 1e6, poisson_ratio: 0.5}",
                ":9:21: sensor.skin.thickness: 1e-06 is not allowed: at least an eighth of the spacing of samples"},
       BadScene{kSkin, "{thickness: 0.002, law: elastic_layer, elastic_modulus: 1e6, poisson_ratio: 0.5, normal_damping: 1}",
                ":9:106: sensor.skin.normal_damping: not a key of law elastic_layer but of winkler"},
       BadScene{kSkin, "{thickness: 0.002, normal_contact_stiffness: 1, margin: 0.001}",
                ":9:65: sensor.skin.margin: not a key of law winkler but of elastic_layer"}});
}

TEST(BadSensors, Relaxation) {
  expectRefusals(
      {BadScene{kSkin, "{thickness: 1, normal_contact_stiffness: 1, relaxation: 0.5}",
                ":9:65: sensor.skin.relaxation: 0.5 is not allowed: a list of at most 4 of {fraction, time}"},
       BadScene{kSkin, "{thickness: 1, normal_contact_stiffness: 1, relaxation: [{fraction: 0.1}]}",
                ":9:66: sensor.skin.relaxation[0]: time is missing: a number > 0 s"},
       BadScene{kSkin, "{thickness: 1, normal_contact_stiffness: 1, relaxation: [{fraction: 1.1, time: 1}]}",
                ":9:77: sensor.skin.relaxation[0].fraction: 1.1 is not allowed: a number from 0 to 1 of the stiffness"},
       BadScene{kSkin, "{thickness: 1, normal_contact_stiffness: 1, relaxation: [{fraction: 0.1, time: 0}]}",
                ":9:88: sensor.skin.relaxation[0].time: 0 is not allowed: a number > 0 s"},
       BadScene{kSkin, "{thickness: 1, normal_contact_stiffness: 1, relaxation: [{fraction: 0.5, time: 1}, {fraction: 0.5, time: 2}]}",
                ":9:65: sensor.skin.relaxation: a sum of fractions of 1 is not allowed: less than 1"},
       BadScene{kSkin, "{thickness: 1, normal_contact_stiffness: 1, normal_damping: 2, relaxation: [{fraction: 0.5, time: 1}]}",
                ":9:84: sensor.skin.relaxation: 1 term is not allowed: none with normal_damping (2 Pa s / m), which is another model of "
                "energy loss"},
       BadScene{kSkin, "{thickness: 1, law: proximity, sensitivity: 1, relaxation: [{fraction: 0.5, time: 1}]}",
                ":9:68: sensor.skin.relaxation: 1 term is not allowed: none for the law proximity, under which nothing presses"}});
}

TEST(BadSensors, Psf) {
  expectRefusals(
      {BadScene{kPsf, "{gaussian: {sigma: 0, size: 3}}",
                ":10:27: sensor.psf.gaussian.sigma: 0 is not allowed: a number from 0.001 to 100 taxels"},
       BadScene{kPsf, "{gaussian: {sigma: 1, size: 4}}",
                ":10:36: sensor.psf.gaussian.size: 4 is not allowed: an odd whole number from 1 to 9"},
       BadScene{kPsf, "{gaussian: {sigma: 1}}", ":10:19: sensor.psf.gaussian: size is missing: an odd whole number from 1 to 9"},
       BadScene{kPsf, "{kernel: [[1, 2, 1], [1, 2], [1, 2, 1]]}",
                ":10:29: sensor.psf.kernel[1]: a list of 2 is not allowed: a list of 3 numbers"},
       BadScene{kPsf, "{kernel: [[0]]}", ":10:17: sensor.psf.kernel: the weights sum to 0: at least one must be > 0"},
       BadScene{kPsf, "{kernel: [[1, 1], [1, 1]]}", ":10:17: sensor.psf.kernel: a list of 2 is not allowed: a square list of rows"},
       BadScene{kPsf, "{kernel: [[1]], gaussian: {sigma: 1, size: 1}}",
                ":10:17: sensor.psf.kernel: conflicts with `gaussian`: give only one of them"},
       BadScene{kPsf, "{normalization: some}", ":10:24: sensor.psf.normalization: some is not allowed: per_source | none"}});
}

TEST(BadSensors, Curve) {
  expectRefusals(
      {BadScene{kCurve, "{}", ":12:12: sensor.readout.curve: coefficients is missing: a list of 1 to 5 numbers"},
       BadScene{kCurve, "{coefficients: [1, 2, 3, 4, 5, 6]}",
                ":12:27: sensor.readout.curve.coefficients: a list of 6 is not allowed: a list of 1 to 5"},
       BadScene{kCurve, "{coefficients: [-1]}", ":12:12: sensor.readout.curve: "},
       BadScene{kCurve, "{counts_per_newton: 1, coefficients: [1]}",
                ":12:49: sensor.readout.curve.coefficients: conflicts with `counts_per_newton`"},
       BadScene{kCurve, "{points: []}",
                ":12:21: sensor.readout.curve.points: a list of 0 is not allowed: a list of 1 to 16 points, [N, counts] each"},
       BadScene{kCurve,
                "{points: [[1, 1], [2, 2], [3, 3], [4, 4], [5, 5], [6, 6], [7, 7], [8, 8], [9, 9], [10, 10], [11, 11], [12, 12], [13, 13], "
                "[14, 14], [15, 15], [16, 16], [17, 17]]}",
                ":12:21: sensor.readout.curve.points: a list of 17 is not allowed: a list of 1 to 16 points, [N, counts] each"},
       BadScene{kCurve, "{points: [[0.5, 800, 1]]}",
                ":12:22: sensor.readout.curve.points[0]: a list of 3 is not allowed: a point, [N, counts]"},
       BadScene{kCurve, "{points: [[0.5, 800], [0.5, 900]]}",
                ":12:35: sensor.readout.curve.points[1][0]: 0.5 is not allowed: a number > 0.5 N"},
       BadScene{kCurve, "{points: [[0.5, 800], [0.6, 700]]}",
                ":12:40: sensor.readout.curve.points[1][1]: 700 is not allowed: a number > 800 counts"},
       BadScene{kCurve, "{points: [[-1, 800]]}", ":12:23: sensor.readout.curve.points[0][0]: -1 is not allowed: a number > 0 N"},
       BadScene{kCurve, "{points: [[.nan, 800]]}", ":12:23: sensor.readout.curve.points[0][0]: .nan is not allowed: a number > 0 N"},
       BadScene{kCurve, "{points: [[0.5, 800]], limit: 5000}", ":12:42: sensor.readout.curve.limit: conflicts with `points`"},
       BadScene{kCurve, "{coefficients: [1], points: [[0.5, 800]]}",
                ":12:27: sensor.readout.curve.coefficients: conflicts with `points`: give only one of them"},
       BadScene{kCurve, "{points: [[0.5, 800]], counts_per_newton: 3}",
                ":12:54: sensor.readout.curve.counts_per_newton: conflicts with `points`: give only one of them"}});
}

TEST(BadSensors, TaxelsAndCounts) {
  expectRefusals(
      {BadScene{"trigger: 0.02", "adc_bits: 17", ":13:15: sensor.readout.adc_bits: 17 is not allowed: a whole number from 1 to 16"},
       BadScene{"trigger: 0.02", "saturation: 4096",
                ":13:17: sensor.readout.saturation: 4096 is not allowed: a whole number from 1 to 4095"},
       BadScene{"trigger: 0.02", "taxel_gain: [1, 1]",
                ":13:17: sensor.readout.taxel_gain: 2 numbers are not allowed: one for each of the 12 taxels"},
       BadScene{"trigger: 0.02", "taxel_gain: [[1, 1], 1]", ":13:17: sensor.readout.taxel_gain: numbers and rows are mixed"},
       BadScene{"trigger: 0.02", "taxel_gain: [[1, 1, 1], [1, 1, 1], [1, 1, 1], [1, 1, 1]]",
                ":13:17: sensor.readout.taxel_gain: a row of 3 is not allowed: rows of 4 (num_cols)"},
       BadScene{"trigger: 0.02", "taxel_gain: [-1]", ":13:18: sensor.readout.taxel_gain[0]: -1 is not allowed: a number >= 0"},
       BadScene{"trigger: 0.02", "calibrated_gain: [1, 1]",
                ":13:22: sensor.readout.calibrated_gain: 2 numbers are not allowed: one for each of the 12 taxels"},
       BadScene{"trigger: 0.02", "calibrated_gain: [-1]", ":13:23: sensor.readout.calibrated_gain[0]: -1 is not allowed: a number >= 0"},
       BadScene{"trigger: 0.02", "calibrated_gain: all", ":13:22: sensor.readout.calibrated_gain: all is not allowed: a list of numbers"},
       BadScene{"  num_rows: 3\n", "  patches: []\n", ":7:13: sensor.num_cols: conflicts with `patches`"}});
}

TEST(BadSensors, ThreeAxisTaxels) {
  const auto axes = [](const std::string& keys) { return "three_axis: {" + keys + "}"; };
  const std::string gain = "gain: [[1, 0, 0], [0, 1, 0], [0, 0, 1]]";
  expectRefusals(
      {BadScene{"trigger: 0.02", axes("noise: [1, 1, 1]"), ":13:17: sensor.readout.three_axis: gain is missing: three rows"},
       BadScene{"trigger: 0.02", axes("gain: [[1, 0, 0], [0, 1, 0]]"),
                ":13:24: sensor.readout.three_axis.gain: a list of 2 is not allowed: three rows (x, y, normal) of three numbers, counts/N"},
       BadScene{"trigger: 0.02", axes("gain: [[1, 0], [0, 1, 0], [0, 0, 1]]"),
                ":13:25: sensor.readout.three_axis.gain[0]: a list of 2 is not allowed: a list of 3 numbers"},
       BadScene{"trigger: 0.02", axes(gain + ", hysteresis_strength: [0, 0, 1]"),
                ":13:87: sensor.readout.three_axis.hysteresis_strength[2]: 1 is not allowed: a number >= 0 and < 1"},
       BadScene{"trigger: 0.02", axes(gain + ", saturation: 0"),
                ":13:71: sensor.readout.three_axis.saturation: 0 is not allowed: a whole number from 1 to"},
       BadScene{"trigger: 0.02", axes(gain + ", colour: red"), ":13:59: sensor.readout.three_axis.colour: unknown key"},
       BadScene{"trigger: 0.02", axes(gain),
                ":13:17: sensor.readout.three_axis: a value is not allowed: none on a skin without friction, which has no shear"}});
}

TEST(BadSensors, ReadoutOverTimeAndImperfections) {
  constexpr std::string_view kTrigger = "trigger: 0.02";
  expectRefusals(
      {BadScene{kTrigger, "hysteresis_strength: 1.5",
                ":13:26: sensor.readout.hysteresis_strength: 1.5 is not allowed: a number from 0 to 1"},
       BadScene{kTrigger, "hysteresis_strength: 0.1",
                ":13:26: sensor.readout.hysteresis_strength: 1 of hysteresis_strength and 0 of hysteresis_width: as many"},
       BadScene{kTrigger, "hysteresis_width: [0.1]",
                ":13:23: sensor.readout.hysteresis_width: 0 of hysteresis_strength and 1 of hysteresis_width: as many"},
       BadScene{kTrigger, "hysteresis_width: -0.1", ":13:23: sensor.readout.hysteresis_width: -0.1 is not allowed: a number >= 0 N"},
       BadScene{kTrigger, "hysteresis_strength: [0, 0, 0, 0, 0]",
                ":13:26: sensor.readout.hysteresis_strength: a list of 5 is not allowed: a number, or a list of at most 4"},
       BadScene{kTrigger, "hysteresis_strength: [0.5, 0.5]\n    hysteresis_width: [1, 2]",
                ":13:26: sensor.readout.hysteresis_strength: a sum of 1 is not allowed: less than 1"},
       BadScene{kTrigger, "creep: 3", ":13:12: sensor.readout.creep: 3 is not allowed: a list of at most 4 of {fraction, time}"},
       BadScene{kTrigger, "creep: [{fraction: 0.1}]", ":13:13: sensor.readout.creep[0]: time is missing: a number > 0 s"},
       BadScene{kTrigger, "creep: [{fraction: -1, time: 1}]",
                ":13:24: sensor.readout.creep[0].fraction: -1 is not allowed: a number from 0"},
       BadScene{kTrigger, "creep: [{fraction: 1, time: 0}]", ":13:33: sensor.readout.creep[0].time: 0 is not allowed: a number > 0 s"},
       BadScene{kTrigger, "creep: [{fraction: 1, tau: 1}]", ":13:27: sensor.readout.creep[0].tau: unknown key"},
       BadScene{kTrigger, "low_pass_time: -1", ":13:20: sensor.readout.low_pass_time: -1 is not allowed: a number >= 0 s"},
       BadScene{kTrigger, "delay: soon", ":13:12: sensor.readout.delay: soon is not allowed: a number >= 0 s"},
       BadScene{kTrigger, "delay: 0.4",
                ":5:3: sensor: readout.delay 0.4 s is not allowed: at most 32 steps at a simulation_rate of 100 Hz (0.32 s)"},
       BadScene{kTrigger, "jitter: 0.001",
                ":13:13: sensor.readout.jitter: 0.001 is not allowed: s, 0 where frame_rate is 0 (a frame at every step)"},
       BadScene{kTrigger, "jitter: 0.1\n  frame_rate: 20",
                ":13:13: sensor.readout.jitter: 0.1 is not allowed: s, at most 1 / frame_rate (0.05 s)"},
       BadScene{kTrigger, "bias: -1", ":13:11: sensor.readout.bias: -1 is not allowed: a number from 0 to 1e+09 counts"},
       BadScene{kTrigger, "random_walk: 1e10",
                ":13:18: sensor.readout.random_walk: 1e10 is not allowed: a number from 0 to 1e+09 counts/sqrt(s)"},
       BadScene{kTrigger, "gain_spread: 3", ":13:18: sensor.readout.gain_spread: 3 is not allowed: a number from 0 to 2"},
       BadScene{kTrigger, "press_gain_spread: .nan", ":13:24: sensor.readout.press_gain_spread: .nan is not allowed"},
       BadScene{kTrigger, "dead_taxel_probability: 1.1",
                ":13:29: sensor.readout.dead_taxel_probability: 1.1 is not allowed: a number from 0 to 1"}});
}

}  // namespace
}  // namespace taxelsim
