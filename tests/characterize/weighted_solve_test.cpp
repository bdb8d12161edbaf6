// Weighted least squares against scipy.optimize.least_squares and closed forms.
#include "characterize/weighted_solve.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <array>
#include <cmath>
#include <string>

namespace taxelsim {
namespace {

constexpr SolveLimits kLimits{.tolerance = 1e-12, .max_iterations = 200};
// A share of a parameter's scale: the solver stops at a relative change of the cost of 1e-12, and a cost is flat to 1e-12 within 1e-6 of
// its minimum.
constexpr double kSame = 1e-6;

constexpr std::size_t kGroups = 5, kRows = 40;
using Parameters = std::array<double, 2 + kGroups>;  // rate, offset, amplitudes

// y = amplitude exp(-rate t) + offset + disturbance: groups share rate and offset and have amplitudes of their own.
struct Decays {
  Decays() {
    problem.shared = {{.start = 0.3, .scale = 1, .low = 0.01, .high = 10}, {.start = 0.1, .scale = 0.1, .low = -1, .high = 1}};
    values.shared = {0.3, 0.1};
    for (std::size_t g = 0; g < kGroups; ++g) {
      problem.own.push_back({{.start = 1, .scale = 2}});
      problem.num_rows.push_back(kRows);
      values.own.push_back({1});
      weights.emplace_back();
      for (std::size_t i = g * kRows; i < (g + 1) * kRows; ++i)
        weights[g].push_back(i % 7 == 0 ? 0 : 0.1 * static_cast<double>(1 + i % 10));
    }
    problem.residuals = [this](std::size_t g, const double* shared, const double* own, double* residuals) {
      const double rate = problem.shared.empty() ? kRate : shared[0], offset = problem.shared.empty() ? kOffset : shared[1];
      const double amplitude = problem.own[g].empty() ? amplitudeOf(g) : own[0];
      for (std::size_t r = 0; r < kRows; ++r) {
        const double t = 0.1 * static_cast<double>(r), i = static_cast<double>(g * kRows + r);
        const double y = amplitudeOf(g) * std::exp(-kRate * t) + kOffset + 0.02 * std::sin(7 * i * i);
        residuals[r] = amplitude * std::exp(-rate * t) + offset - y;
      }
    };
  }
  Decays(const Decays&) = delete;
  Decays& operator=(const Decays&) = delete;

  static double amplitudeOf(std::size_t group) { return 1 + static_cast<double>(group); }

  static constexpr double kRate = 1.3, kOffset = 0.2;
  GroupedProblem problem;
  RowWeights weights;
  ParameterValues values;
};

void hold(FitParameter& parameter, double& value, double at) {
  parameter.low = parameter.high = value = at;
}

struct Minimum {
  const char* name;
  Parameters values;
  void (*change)(Decays&);
};
// By scipy_minima.py.
const Minimum kMinima[] = {
    {"Free", {1.2957250093, 0.1991952897, 1.0171306760, 1.9881296112, 2.9881402388, 4.0071489202, 4.9857335149}, [](Decays&) {}},
    {"OffsetAtItsBound",
     {1.2086742362, 0.1500000000, 1.0927893937, 2.0097733654, 2.9497547025, 3.9165659104, 4.8426147402},
     [](Decays& decays) { decays.problem.shared[1].high = 0.15; }},
    {"ConstantOffsetAndAmplitude",
     {1.3827804480, 0.2500000000, 0.9301821508, 1.9556912752, 3.0000000000, 4.0845275167, 5.1166672412},
     [](Decays& decays) {
       hold(decays.problem.shared[1], decays.values.shared[1], 0.25);
       hold(decays.problem.own[2][0], decays.values.own[2][0], 3);
     }},
    {"NoOwnParameters",
     {1.2986529042, 0.2000763159, 1.0000000000, 2.0000000000, 3.0000000000, 4.0000000000, 5.0000000000},
     [](Decays& decays) {
       for (auto& own : decays.problem.own) own.clear();
       for (auto& own : decays.values.own) own.clear();
     }},
    {"NoSharedParameters",
     {1.3000000000, 0.2000000000, 1.0176317464, 1.9912509926, 2.9942610273, 4.0158244291, 4.9969095866},
     [](Decays& decays) {
       decays.problem.shared.clear();
       decays.values.shared.clear();
     }},
};

class ScipyMinima : public testing::TestWithParam<Minimum> {};

TEST_P(ScipyMinima, AreFound) {
  Decays decays;
  GetParam().change(decays);
  solveWeighted(decays.problem, decays.weights, kLimits, decays.values);
  const Parameters& expected = GetParam().values;
  for (std::size_t p = 0; p < decays.values.shared.size(); ++p) {
    EXPECT_NEAR(decays.values.shared[p], expected[p], kSame * decays.problem.shared[p].scale) << "shared " << p;
  }
  for (std::size_t g = 0; g < kGroups; ++g) {
    if (decays.values.own[g].empty()) continue;
    EXPECT_NEAR(decays.values.own[g][0], expected[2 + g], kSame * decays.problem.own[g][0].scale) << "group " << g;
  }
}
INSTANTIATE_TEST_SUITE_P(Decays, ScipyMinima, testing::ValuesIn(kMinima),
                         [](const auto& tested) { return std::string(tested.param.name); });

// Weighted lines y = intercept of the group + slope x, with a common slope.
struct Lines {
  Lines() {
    problem.shared = {{.start = 0, .scale = 1}};
    values.shared = {0};
    for (std::size_t g = 0; g < kGroups; ++g) {
      problem.own.push_back({{.start = 0, .scale = 1}});
      problem.num_rows.push_back(kRows);
      values.own.push_back({0});
      weights.emplace_back();
      for (std::size_t r = 0; r < kRows; ++r) weights[g].push_back(0.5 + 0.1 * static_cast<double>((r + g) % 6));
    }
    problem.residuals = [](std::size_t g, const double* shared, const double* own, double* residuals) {
      for (std::size_t r = 0; r < kRows; ++r) residuals[r] = own[0] + shared[0] * xOf(r) - yOf(g, r);
    };
  }

  static double xOf(std::size_t row) { return 0.1 * static_cast<double>(row); }
  static double yOf(std::size_t group, std::size_t row) {
    const auto i = static_cast<double>(group * kRows + row);
    return static_cast<double>(group) + 0.7 * xOf(row) + 0.1 * std::sin(3 * i * i);
  }

  GroupedProblem problem;
  RowWeights weights;
  ParameterValues values;
};

TEST(WeightedSolve, LinesAreThoseOfTheNormalEquations) {
  Lines lines;
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(1 + kGroups, 1 + kGroups);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(1 + kGroups);
  for (std::size_t g = 0; g < kGroups; ++g) {
    for (std::size_t r = 0; r < kRows; ++r) {
      Eigen::VectorXd row = Eigen::VectorXd::Zero(1 + kGroups);
      row[0] = Lines::xOf(r);
      row[static_cast<Eigen::Index>(1 + g)] = 1;
      row *= lines.weights[g][r];
      normal += row * row.transpose();
      right += row * lines.weights[g][r] * Lines::yOf(g, r);
    }
  }
  const Eigen::VectorXd expected = normal.ldlt().solve(right);
  solveWeighted(lines.problem, lines.weights, kLimits, lines.values);
  EXPECT_NEAR(lines.values.shared[0], expected[0], kSame);
  for (std::size_t g = 0; g < kGroups; ++g)
    EXPECT_NEAR(lines.values.own[g][0], expected[static_cast<Eigen::Index>(1 + g)], kSame) << "group " << g;
}

// The intercept is the weighted mean of what the bounded slope leaves.
TEST(WeightedSolve, ParametersStayAtABound) {
  constexpr double kSteepest = 0.5;  // 0.7 without the bound
  Lines lines;
  lines.problem.shared[0].high = kSteepest;
  solveWeighted(lines.problem, lines.weights, kLimits, lines.values);
  EXPECT_EQ(lines.values.shared[0], kSteepest);
  for (std::size_t g = 0; g < kGroups; ++g) {
    double sum = 0, weight = 0;
    for (std::size_t r = 0; r < kRows; ++r) {
      const double squared = lines.weights[g][r] * lines.weights[g][r];
      sum += squared * (Lines::yOf(g, r) - kSteepest * Lines::xOf(r));
      weight += squared;
    }
    EXPECT_NEAR(lines.values.own[g][0], sum / weight, kSame) << "group " << g;
  }
}

}  // namespace
}  // namespace taxelsim
