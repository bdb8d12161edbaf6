// Least squares over groups: textbook intervals of a line, and results that do not depend on the history of the process.
#include "characterize/least_squares.h"
#include "support/test.h"

namespace taxelsim {
namespace {

// Groups of rows y = own + shared x^2 + noise.
GroupedFit parabolas(unsigned seed) {
  constexpr std::size_t kGroups = 12, kRows = 15;
  std::mt19937 random(seed);
  std::normal_distribution<double> gaussian;
  std::vector<std::vector<double>> y(kGroups);
  GroupedProblem problem;
  problem.shared = {{.start = 1, .scale = 1}};
  for (std::size_t g = 0; g < kGroups; ++g) {
    problem.own.push_back({{.start = 0, .scale = 1}});
    problem.num_rows.push_back(kRows);
    for (std::size_t r = 0; r < kRows; ++r) {
      y[g].push_back(static_cast<double>(g) + 0.5 * static_cast<double>(r * r) + 0.1 * gaussian(random));
    }
  }
  problem.residuals = [&](std::size_t g, const double* shared, const double* own, double* residuals) {
    for (std::size_t r = 0; r < kRows; ++r) residuals[r] = own[0] + shared[0] * static_cast<double>(r * r) - y[g][r];
  };
  return fitGroups(problem);
}

TEST(LeastSquares, LineFitHasTextbookIntervals) {
  constexpr std::size_t kRows = 30;
  std::mt19937 random(1);
  std::normal_distribution<double> gaussian;
  std::vector<double> y;
  double sum = 0, squares = 0, mixed = 0;
  for (std::size_t r = 0; r < kRows; ++r) y.push_back(3 + 2 * static_cast<double>(r) + gaussian(random));
  const double mean_x = (kRows - 1) / 2.0;
  for (std::size_t r = 0; r < kRows; ++r) {
    const double x = static_cast<double>(r) - mean_x;
    sum += y[r], squares += x * x, mixed += x * y[r];
  }
  const double slope = mixed / squares, mean_y = sum / kRows;
  double left = 0;
  for (std::size_t r = 0; r < kRows; ++r) left += std::pow(y[r] - mean_y - slope * (static_cast<double>(r) - mean_x), 2);
  const double sd = std::sqrt(left / (kRows - 2));
  const FitResult fit = fitRows(kRows, {{.start = 0, .scale = 1}, {.start = 0, .scale = 1}},
                                [&](std::size_t r, const double* p) { return p[0] + p[1] * static_cast<double>(r) - y[r]; });
  ASSERT_EQ(fit.num_outliers, 0u);
  constexpr double kSolved = 1e-6;  // numerical derivatives
  EXPECT_NEAR(fit.values[1], slope, kSolved);
  EXPECT_NEAR(fit.residual_sd, sd, kSolved);
  constexpr double kStudent28 = 2.0484;  // 97.5 %, 28 degrees of freedom
  EXPECT_NEAR(fit.halfWidth(1), kStudent28 * sd / std::sqrt(squares), 1e-4 * fit.halfWidth(1));
}

TEST(LeastSquares, UnidentifiableParametersHaveInfiniteIntervals) {
  const FitResult fit = fitRows(10, {{.start = 1, .scale = 1}, {.start = 1, .scale = 1}},
                                [](std::size_t r, const double* p) { return (p[0] + p[1]) * static_cast<double>(r) - 2; });
  EXPECT_TRUE(std::isinf(fit.halfWidth(0)));
}

TEST(LeastSquares, ResultDoesNotDependOnTheHeap) {
  const GroupedFit first = parabolas(7);
  EXPECT_NEAR(first.shared[0], 0.5, 1e-3);
  std::vector<std::unique_ptr<char[]>> holes;
  std::mt19937 random(3);
  for (int k = 0; k < 2000; ++k) holes.push_back(std::make_unique<char[]>(1 + random() % 300));
  for (std::size_t k = 0; k < holes.size(); k += 1 + random() % 3) holes[k].reset();
  const GroupedFit again = parabolas(7);
  EXPECT_EQ(first.shared, again.shared);
  EXPECT_EQ(first.own, again.own);
  EXPECT_EQ(first.residual_sd, again.residual_sd);
}

// Standard deviation of a mean over groups, against many random draws.
TEST(LeastSquares, IntervalsOfMeansOverGroupsAreRight) {
  std::vector<double> means;
  double reported = 0;
  for (unsigned seed = 0; seed < 200; ++seed) {
    const GroupedFit fit = parabolas(seed);
    double mean = 0;
    for (const std::vector<double>& own : fit.own) mean += own[0] / static_cast<double>(fit.own.size());
    means.push_back(mean);
    reported += fit.meanHalfWidth(std::vector<Eigen::VectorXd>(fit.own.size(), Eigen::VectorXd::Ones(1)), Eigen::VectorXd::Zero(1)) / 200;
  }
  double squares = 0;
  for (const double mean : means) squares += std::pow(mean - 5.5, 2);
  const double seen = 1.96 * std::sqrt(squares / static_cast<double>(means.size()));
  EXPECT_NEAR(reported / seen, 1, 0.2) << "four standard errors of a deviation from 200 draws";
}

}  // namespace
}  // namespace taxelsim
