// The two solvers of weighted least squares find the same minimum.
#include "characterize/solvers.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace taxelsim {
namespace {

constexpr SolveLimits kLimits{.tolerance = 1e-12, .max_iterations = 200};
// Of a parameter's scale: both stop at a relative change of the cost of 1e-12, and a cost is flat to 1e-12 within 1e-6 of its minimum.
constexpr double kSame = 1e-5;

// y = amplitude exp(-rate t) + offset + noise: groups share rate and offset and have amplitudes of their own.
struct Decays {
  static constexpr std::size_t kGroups = 5, kRows = 40;

  explicit Decays(unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> gaussian;
    std::uniform_real_distribution<double> uniform(0.1, 1);
    problem.shared = {{.start = 0.3, .scale = 1, .low = 0.01, .high = 10}, {.start = 0.5, .scale = 0.1, .low = -1, .high = 1}};
    for (std::size_t g = 0; g < kGroups; ++g) {
      problem.own.push_back({{.start = 1, .scale = 2}});
      problem.num_rows.push_back(kRows);
      values.own.push_back({1});
      for (std::size_t r = 0; r < kRows; ++r) {
        y[g][r] = (1 + static_cast<double>(g)) * std::exp(-1.3 * timeOf(r)) + 0.2 + 0.02 * gaussian(random);
      }
      weights.emplace_back(kRows);
      for (double& weight : weights.back()) weight = random() % 5 == 0 ? 0 : uniform(random);
    }
    values.shared = {0.3, 0.5};
    problem.residuals = [this](std::size_t g, const double* shared, const double* own, double* residuals) {
      for (std::size_t r = 0; r < kRows; ++r) residuals[r] = own[0] * std::exp(-shared[0] * timeOf(r)) + shared[1] - y[g][r];
    };
  }
  Decays(const Decays&) = delete;
  Decays& operator=(const Decays&) = delete;

  static double timeOf(std::size_t row) { return 0.1 * static_cast<double>(row); }

  void expectSame() const {
    ParameterValues by_ceres = values, by_eigen = values;
    solveWithCeres(problem, weights, kLimits, by_ceres);
    solveWithEigen(problem, weights, kLimits, by_eigen);
    for (std::size_t p = 0; p < problem.shared.size(); ++p) {
      EXPECT_NEAR(by_eigen.shared[p], by_ceres.shared[p], kSame * problem.shared[p].scale) << "shared " << p;
    }
    for (std::size_t g = 0; g < kGroups; ++g) {
      for (std::size_t p = 0; p < problem.own[g].size(); ++p) {
        EXPECT_NEAR(by_eigen.own[g][p], by_ceres.own[g][p], kSame * problem.own[g][p].scale) << "group " << g;
      }
    }
  }

  double y[kGroups][kRows];
  GroupedProblem problem;
  RowWeights weights;
  ParameterValues values;
};

TEST(Solvers, FindTheSameMinimum) {
  for (unsigned seed = 0; seed < 10; ++seed) Decays(seed).expectSame();
}

// Ceres projects its steps onto the bounds and may stop before the minimum there. The minimum is that of a parameter held at its bound.
TEST(Solvers, EigenFindsTheMinimumAtABound) {
  Decays bounded(3), held(3);
  constexpr double kBound = 0.15;  // the free minimum is at 0.2
  bounded.problem.shared[1].high = kBound;
  bounded.values.shared[1] = 0.1;
  held.problem.shared[1].low = held.problem.shared[1].high = kBound;
  held.values.shared[1] = kBound;
  solveWithEigen(bounded.problem, bounded.weights, kLimits, bounded.values);
  solveWithCeres(held.problem, held.weights, kLimits, held.values);
  EXPECT_NEAR(bounded.values.shared[1], kBound, 1e-15);
  EXPECT_NEAR(bounded.values.shared[0], held.values.shared[0], kSame);
  for (std::size_t g = 0; g < Decays::kGroups; ++g)
    EXPECT_NEAR(bounded.values.own[g][0], held.values.own[g][0], 2 * kSame) << "group " << g;
}

TEST(Solvers, KeepConstantParameters) {
  Decays decays(4);
  decays.problem.shared[1].low = decays.problem.shared[1].high = 0.25;
  decays.values.shared[1] = 0.25;
  decays.problem.own[2][0].low = decays.problem.own[2][0].high = 3;
  decays.values.own[2][0] = 3;
  decays.expectSame();
}

TEST(Solvers, WorkWithoutSharedOrOwnParameters) {
  Decays without_own(5);
  for (auto& own : without_own.problem.own) own.clear();
  for (auto& own : without_own.values.own) own.clear();
  without_own.problem.residuals = [&](std::size_t g, const double* shared, const double*, double* residuals) {
    for (std::size_t r = 0; r < Decays::kRows; ++r) {
      residuals[r] = std::exp(-shared[0] * Decays::timeOf(r)) + shared[1] - without_own.y[g][r];
    }
  };
  without_own.expectSame();
  Decays without_shared(6);
  without_shared.problem.shared.clear();
  without_shared.values.shared.clear();
  without_shared.problem.residuals = [&](std::size_t g, const double*, const double* own, double* residuals) {
    for (std::size_t r = 0; r < Decays::kRows; ++r) residuals[r] = own[0] * std::exp(-Decays::timeOf(r)) - without_shared.y[g][r];
  };
  without_shared.expectSame();
}

}  // namespace
}  // namespace taxelsim
