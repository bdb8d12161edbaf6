// Stiffness of a skin: moduli, flat punch on a bonded layer, Shore A hardness, parameters of the laws.
#include "taxelsim/stiffness.h"

#include "sensor/flat_punch.h"
#include "support/test.h"
#include "taxelsim/error.h"
#include "taxelsim/object.h"

namespace taxelsim {
namespace {

constexpr double kPi = std::numbers::pi;

// F / (2 E* a delta) of a flat punch of radius / thickness `ratio`.
struct Punch {
  double poisson_ratio, ratio, factor;
};

// Digits of an independent program (80 Gauss nodes); five significant digits.
TEST(PunchFactor, MatchesTheFredholmTable) {
  for (const Punch& punch : {Punch{0.5, 0.1, 1.1260}, {0.5, 0.2, 1.2806}, {0.5, 0.5, 1.9329},  {0.5, 1, 3.6187},    {0.5, 2, 9.1495},
                             {0.5, 3, 18.157},        {0.5, 5, 50.140},   {0.49, 0.1, 1.1234}, {0.49, 0.5, 1.9028}, {0.49, 1, 3.4840},
                             {0.49, 2, 8.3370},       {0.49, 3, 15.462},  {0.49, 5, 36.263},   {0.45, 0.2, 1.2523}, {0.45, 1, 3.0914},
                             {0.45, 3, 10.365},       {0.45, 5, 19.156},  {0.3, 0.1, 1.0954},  {0.3, 1, 2.4835},    {0.3, 5, 10.100}}) {
    EXPECT_NEAR(punchFactor(punch.ratio, punch.poisson_ratio) / punch.factor, 1, 5e-5) << punch.poisson_ratio << " " << punch.ratio;
  }
}

// W. C. Hayes, L. M. Keer, G. Herrmann, L. F. Mockros, "A mathematical analysis for indentation tests of articular cartilage", J. Biomech.
// 5, 1972, table of kappa for the plane-ended indenter. Their solution is within 1 % of the exact one.
TEST(PunchFactor, MatchesTheTableOfHayes) {
  for (const Punch& punch : {Punch{0.3, 0.2, 1.207},
                             {0.3, 0.4, 1.472},
                             {0.3, 0.6, 1.784},
                             {0.3, 0.8, 2.124},
                             {0.3, 1, 2.480},
                             {0.5, 0.2, 1.281},
                             {0.5, 0.4, 1.683},
                             {0.5, 0.6, 2.211},
                             {0.5, 0.8, 2.855},
                             {0.5, 1, 3.609}}) {
    EXPECT_NEAR(punchFactor(punch.ratio, punch.poisson_ratio) / punch.factor, 1, 0.01) << punch.poisson_ratio << " " << punch.ratio;
  }
}

TEST(PunchFactor, HasThickAndThinLimits) {
  // Half-space, approached linearly in the ratio.
  for (const double nu : {0.0, 0.3, 0.49, 0.5}) EXPECT_NEAR(punchFactor(1e-6, nu), 1, 2e-6) << nu;
  // Confined layer, p = M delta / h under the punch; the rim adds a length of the order of the thickness.
  for (const double nu : {0.0, 0.3}) {
    const double confined = kPi * kMaxPunchRatio * (1 - nu) * (1 - nu) / (2 * (1 - 2 * nu));
    EXPECT_NEAR(punchFactor(kMaxPunchRatio, nu) / confined, 1, 1 / kMaxPunchRatio) << nu;
    EXPECT_GT(punchFactor(kMaxPunchRatio, nu), confined) << nu;
  }
  // Incompressible layer, F = 3 pi G a^4 delta / (8 h^3) in lubrication theory: factor 3 pi (a / h)^3 / 64, E* = 4 G.
  const double lubrication = 3 * kPi * std::pow(kMaxPunchRatio, 3) / 64;
  EXPECT_NEAR(punchFactor(kMaxPunchRatio, 0.5) / lubrication, 1, 0.1);
}

TEST(PunchFactor, GrowsWithRatioAndPoissonRatio) {
  for (const double nu : {0.0, 0.45, 0.49}) {
    double previous = 1;
    for (double ratio = 0.01; ratio <= kMaxPunchRatio; ratio *= 1.7) {
      const double factor = punchFactor(ratio, nu);
      EXPECT_GT(factor, previous);
      EXPECT_GT(punchFactor(ratio, nu + 0.005), factor);
      previous = factor;
    }
  }
}

TEST(Stiffness, ModuliOfAMaterial) {
  EXPECT_DOUBLE_EQ(shearModulus({3e6, 0.5 - 1e-16}), 1e6);
  EXPECT_DOUBLE_EQ(confinedModulus({1e6, 0}), 1e6);
  for (const auto& [nu, ratio] : {std::pair{0.3, 1.346}, {0.4, 2.143}, {0.45, 3.793}, {0.49, 17.11}}) {
    EXPECT_NEAR(confinedModulus({1, nu}), ratio, 5e-4 * ratio) << nu;
  }
}

// The type A durometer itself (ASTM D2240): a spring of 0.55 N + 0.075 N per unit presses a truncated cone, 0.79 mm wide at the tip and
// 1.27 mm at the shaft, (100 - S) 0.0254 mm deep. A flat punch of their mean radius on an incompressible half-space has
// E = 3 F / (8 a delta).
TEST(Stiffness, ShoreAFollowsFromTheDurometer) {
  constexpr double kRadius = (0.79e-3 + 1.27e-3) / 4;
  for (double shore_a = kMinShoreA; shore_a <= kMaxShoreA; shore_a += 5) {
    const double force = 0.55 + 0.075 * shore_a, depth = (100 - shore_a) * 0.0254e-3;
    EXPECT_NEAR(shoreAModulus(shore_a) / (3 * force / (8 * kRadius * depth)), 1, 0.01) << shore_a;
  }
}

TEST(Stiffness, ShoreAByHand) {
  EXPECT_NEAR(shoreAModulus(30), 1.1424e6, 50);  // 27.9287 / 24.4484
  EXPECT_NEAR(shoreAModulus(50), 2.4558e6, 50);  // 42.8862 / 17.4631
  EXPECT_NEAR(shoreAModulus(70), 5.5205e6, 50);  // 57.8432 / 10.4779
}

// Figure 6b of the paper.
TEST(Stiffness, PinOnSprings) {
  const SkinStiffness stiffness = skinStiffness({.thickness = 0.002, .stiffness = PinPress{2, 0.001, 0.001}});
  EXPECT_NEAR(stiffness.area_stiffness, 2.546e9, 1e6);
  const std::vector<Skin> skins = skinsOf(stiffness);
  EXPECT_NEAR(pinForce(skins[0], 0.001, 0.001), 2, 1e-12);
  EXPECT_NEAR(pinForce(skins[0], 0.002, 0.001), 8, 1e-12);
  const double hexagon = 2 * std::sqrt(124e-6 / kPi);
  EXPECT_NEAR(pinDepth(skins[0], hexagon, 4.905), 15.5e-6, 0.05e-6);
}

// Layers fitted to figure 6b by an independent program, which solves pins and hexagon on grids of cells.
TEST(Stiffness, PinOnLayers) {
  constexpr double kGridError = 0.04;
  struct Row {
    double thickness, poisson_ratio, modulus, second_pin, hexagon_um;
  };
  for (const Row& row : {Row{0.002, 0.49, 1.08e6, 5.4, 16.4},
                         {0.002, 0.45, 1.16e6, 5.3, 24},
                         {0.002, 0.3, 1.40e6, 5.0, 39},
                         {0.004, 0.49, 1.30e6, 4.8, 37},
                         {0.004, 0.45, 1.38e6, 4.7, 45}}) {
    const SkinStiffness stiffness =
        skinStiffness({.thickness = row.thickness, .poisson_ratio = row.poisson_ratio, .stiffness = PinPress{2, 0.001, 0.001}});
    EXPECT_NEAR(stiffness.material.elastic_modulus / row.modulus, 1, kGridError);
    const Skin layer = skinsOf(stiffness)[4];
    EXPECT_NEAR(pinForce(layer, 0.001, 0.001), 2, 1e-12);
    EXPECT_NEAR(pinForce(layer, 0.002, 0.001) / row.second_pin, 1, kGridError);
    EXPECT_NEAR(pinDepth(layer, 2 * std::sqrt(124e-6 / kPi), 4.905) / (1e-6 * row.hexagon_um), 1, kGridError);
  }
}

TEST(Stiffness, MaterialToPinAndBack) {
  for (const double nu : {0.0, 0.3, 0.49, 0.4999}) {
    for (const double diameter : {0.0005, 0.002, 0.02}) {
      const Material material{1.3e6, nu};
      const double force = layerPinStiffness(material, 0.0015, diameter) * 0.0007;
      const SkinStiffness back = skinStiffness({.thickness = 0.0015, .poisson_ratio = nu, .stiffness = PinPress{force, 0.0007, diameter}});
      EXPECT_NEAR(back.material.elastic_modulus, 1.3e6, 1e-3) << nu << " " << diameter;
      // The same pin on springs that match it.
      const SkinStiffness matched = skinStiffness({.thickness = 0.0015, .poisson_ratio = nu, .stiffness = KnownModulus{1.3e6, diameter}});
      EXPECT_NEAR(matched.area_stiffness / back.area_stiffness, 1, 1e-12);
      EXPECT_NEAR(pinForce(skinsOf(matched)[0], diameter, 0.0007), force, 1e-9 * force);
    }
  }
}

TEST(Stiffness, AreaAndTaxelAndConfinedLayer) {
  const SkinStiffness area = skinStiffness({.thickness = 0.002, .poisson_ratio = 0.4, .stiffness = AreaStiffness{1.73e8}});
  EXPECT_EQ(area.area_stiffness, 1.73e8);
  EXPECT_NEAR(confinedModulus(area.material) / 0.002, 1.73e8, 1e-3);
  EXPECT_NEAR(area.tangential_stiffness, area.material.elastic_modulus / 2.8 / 0.002, 1e-3);
  // 2 N/mm over a taxel of 3.4 mm is 1.73e8 N/m^3; half as wide, twice as much.
  const SkinStiffness taxel =
      skinStiffness({.thickness = 0.002, .poisson_ratio = 0.4, .stiffness = TaxelStiffness{2000, {0.0034, 0.0017}}});
  EXPECT_NEAR(taxel.area_stiffness, 2 * 1.73e8, 1e5);
  const SkinStiffness back =
      skinStiffness({.thickness = 0.002, .poisson_ratio = 0.4, .stiffness = KnownModulus{area.material.elastic_modulus}});
  EXPECT_NEAR(back.area_stiffness, 1.73e8, 1e-3);
  EXPECT_NEAR(back.tangential_stiffness, area.tangential_stiffness, 1e-3);
}

TEST(Stiffness, EveryLawHasTheStiffness) {
  const SkinStiffness stiffness = skinStiffness({.thickness = 0.002, .stiffness = KnownModulus{1e6, 0.001}});
  const std::vector<Skin> skins = skinsOf(stiffness, 0.8);
  ASSERT_EQ(skins.size(), std::variant_size_v<ContactLaw>);
  for (std::size_t n = 0; n < skins.size(); ++n) {
    EXPECT_EQ(skins[n].law.index(), n);
    EXPECT_EQ(skins[n].thickness, 0.002);
    const bool is_layer = std::holds_alternative<ElasticLayer>(skins[n].law);
    EXPECT_EQ(skins[n].margin, is_layer ? 0.004 : 0) << n;
    if (!is_layer) {
      EXPECT_EQ(foundationOf(skins[n]).normal_contact_stiffness, stiffness.area_stiffness) << n;
    }
    // Springs that match the layer under the pin: all laws carry the same.
    EXPECT_NEAR(pinForce(skins[n], 0.001, 0.0005), layerPinStiffness({1e6}, 0.002, 0.001) * 0.0005, 1e-9) << n;
    const bool has_friction = is_layer || n < 2;
    EXPECT_EQ(skins[n].friction.friction_coefficient, has_friction ? 0.8 : 0) << n;
    EXPECT_EQ(skins[n].friction.tangential_stiffness, has_friction ? stiffness.tangential_stiffness : 0) << n;
  }
  EXPECT_EQ(std::get<ElasticLayer>(skins[4].law), (ElasticLayer{.elastic_modulus = 1e6, .poisson_ratio = 0.49}));
}

TEST(Stiffness, PinOnExponentsAndHalfSpaces) {
  const Skin cubic{.thickness = 0.002, .law = Winkler{.normal_contact_stiffness = 1e11, .normal_exponent = 2}};
  EXPECT_NEAR(pinForce(cubic, 0.002, 0.001), kPi * 1e-6 * 1e11 * 1e-6, 1e-12);
  EXPECT_NEAR(pinDepth(cubic, 0.002, pinForce(cubic, 0.002, 0.0007)), 0.0007, 1e-12);
  const Skin deep{.thickness = 0.002,
                  .law = ElasticLayer{.elastic_modulus = 1e6, .poisson_ratio = 0.3, .base = ElasticLayer::Base::kHalfSpace}};
  EXPECT_NEAR(pinForce(deep, 0.002, 0.001), 1e6 / 0.91 * 0.002 * 0.001, 1e-9);
}

void expectRefused(const SkinData& data, const std::string& field) {
  try {
    skinStiffness(data);
    FAIL() << field;
  } catch (const Error& error) {
    EXPECT_EQ(error.field(), field);
    EXPECT_NE(std::string(error.what()).find("is not allowed: "), std::string::npos) << error.what();
  }
}

TEST(Stiffness, RefusesValuesOutOfRange) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kInfinity = std::numeric_limits<double>::infinity();
  for (const double bad : {0.0, -1.0, kNan, kInfinity}) {
    expectRefused({.thickness = bad, .stiffness = KnownModulus{1e6}}, "thickness");
    expectRefused({.thickness = 0.002, .stiffness = KnownModulus{bad}}, "elastic_modulus");
    expectRefused({.thickness = 0.002, .stiffness = KnownModulus{1e6, bad}}, "match_pin_diameter");
    expectRefused({.thickness = 0.002, .stiffness = PinPress{bad, 0.001, 0.001}}, "pin_force");
    expectRefused({.thickness = 0.002, .stiffness = PinPress{1, bad, 0.001}}, "pin_depth");
    expectRefused({.thickness = 0.002, .stiffness = PinPress{1, 0.001, bad}}, "pin_diameter");
    expectRefused({.thickness = 0.002, .stiffness = TaxelStiffness{bad, {1, 1}}}, "taxel_stiffness");
    expectRefused({.thickness = 0.002, .stiffness = TaxelStiffness{1, {1, bad}}}, "pitch[1]");
    expectRefused({.thickness = 0.002, .stiffness = AreaStiffness{bad}}, "area_stiffness");
  }
  for (const double bad : {-0.01, 0.5, 0.6, kNan})
    expectRefused({.thickness = 0.002, .poisson_ratio = bad, .stiffness = KnownModulus{1e6}}, "poisson_ratio");
  for (const double bad : {9e-5, 0.11}) expectRefused({.thickness = bad, .stiffness = KnownModulus{1e6}}, "thickness");
  expectRefused({.thickness = 0.002, .stiffness = PinPress{1, 0.0021, 0.001}}, "pin_depth");
  expectRefused({.thickness = 0.002, .stiffness = PinPress{1, 0.001, 0.257}}, "pin_diameter");
  expectRefused({.thickness = 0.002, .stiffness = PinPress{1e300, 1e-300, 0.001}}, "the elastic modulus that follows");
  expectRefused({.thickness = 0.002, .stiffness = KnownModulus{1e300}}, "the tangential stiffness that follows");
  for (const double bad : {19.9, 90.1, -5.0, kNan}) EXPECT_THROW(shoreAModulus(bad), Error) << bad;
  EXPECT_THROW(skinsOf(skinStiffness({.thickness = 0.002, .stiffness = KnownModulus{1e6}}), -0.1), Error);
  const Skin skin{.thickness = 0.002, .law = Winkler{.normal_contact_stiffness = 1e8}};
  EXPECT_THROW(pinForce(skin, 0.001, 0.0021), Error);
  EXPECT_THROW(pinForce(skin, 0, 0.001), Error);
  EXPECT_THROW(pinDepth(skin, 0.001, -1), Error);
  EXPECT_THROW(layerPinStiffness({1e6, 0.5}, 0.002, 0.001), Error);
}

// An error in depth may change the pressure by kMaxPressureError, wherever on the curve p = k d^e the skin is pressed.
TEST(MaxDepthError, BoundsTheErrorOfThePressure) {
  constexpr double kRounding = 1e-9;  // of pressures up to 2e8 Pa in double precision, relative to kMaxPressureError
  for (const double exponent : {1.0, 1.5, 2.0}) {
    for (const double stiffness : {1.73e8, 2.546e9, 1e11}) {
      const Skin skin{.thickness = 2e-3, .law = Winkler{.normal_contact_stiffness = stiffness, .normal_exponent = exponent}};
      const double error = maxDepthErrorOf(skin);
      EXPECT_LE(error, MeshOptions{}.max_depth_error);
      double largest = 0;
      for (double depth = error; depth <= skin.thickness; depth += skin.thickness / 64) {
        largest = std::max(largest, stiffness * (std::pow(depth, exponent) - std::pow(depth - error, exponent)));
      }
      EXPECT_LE(largest, kMaxPressureError * (1 + kRounding));
      const double tightest = stiffness * exponent * std::pow(skin.thickness, exponent - 1) * error;
      EXPECT_TRUE(error == MeshOptions{}.max_depth_error || std::abs(tightest / kMaxPressureError - 1) < kRounding)
          << "smaller than needed";
    }
  }
}

}  // namespace
}  // namespace taxelsim
