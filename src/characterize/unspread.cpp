#include "characterize/unspread.h"

#include <Eigen/Sparse>
#include <Eigen/SparseCholesky>
#include <cstddef>

#include "reference/psf.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

// Smallest pivot / largest entry of G^T G; below it, forces would be rounding noise.
constexpr double kLeastPivot = 1e-12;
constexpr double kRounding = 1e-12;  // of the largest force or gradient: smaller values count as 0
constexpr int kBlockTries = 3;       // block swaps without progress before single swaps

}  // namespace

struct Unspread::Impl {
  explicit Impl(const Sensor& sensor);

  // Least squares over the free taxels; 0 for the others.
  Eigen::VectorXd solveFree(const Eigen::VectorXd& right) const;
  std::vector<double> forceOf(std::span<const double> image);

  Eigen::SparseMatrix<double> spread;  // G, (taxels x sources)
  Eigen::SparseMatrix<double> normal;  // G^T G
  std::vector<bool> is_free;
};

Unspread::Impl::Impl(const Sensor& sensor) : is_free(static_cast<std::size_t>(numTaxels(sensor)), true) {
  const auto count = static_cast<Eigen::Index>(is_free.size());
  std::vector<Eigen::Triplet<double>> entries;
  for (const reference::Share& share : reference::spreadMatrix(sensor)) {
    entries.emplace_back(static_cast<int>(share.taxel), static_cast<int>(share.source), share.share);
  }
  spread.resize(count, count);
  spread.setFromTriplets(entries.begin(), entries.end());
  normal = spread.transpose() * spread;
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factors(normal);
  if (factors.info() != Eigen::Success || factors.vectorD().minCoeff() < kLeastPivot * normal.coeffs().maxCoeff()) {
    throw Error(ErrorKind::kInput, "psf: cannot be inverted: different loads give the same image");
  }
}

Eigen::VectorXd Unspread::Impl::solveFree(const Eigen::VectorXd& right) const {
  std::vector<Eigen::Index> place(is_free.size(), -1);
  Eigen::Index count = 0;
  for (std::size_t t = 0; t < is_free.size(); ++t) {
    if (is_free[t]) place[t] = count++;
  }
  Eigen::VectorXd force = Eigen::VectorXd::Zero(right.size());
  if (count == 0) return force;
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::VectorXd free_right(count);
  for (Eigen::Index source = 0; source < right.size(); ++source) {
    const Eigen::Index column = place[static_cast<std::size_t>(source)];
    if (column < 0) continue;
    free_right[column] = right[source];
    for (Eigen::SparseMatrix<double>::InnerIterator entry(normal, source); entry; ++entry) {
      const Eigen::Index row = place[static_cast<std::size_t>(entry.row())];
      if (row >= 0) entries.emplace_back(static_cast<int>(row), static_cast<int>(column), entry.value());
    }
  }
  Eigen::SparseMatrix<double> matrix(count, count);
  matrix.setFromTriplets(entries.begin(), entries.end());
  const Eigen::VectorXd solved = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>(matrix).solve(free_right);
  for (std::size_t t = 0; t < place.size(); ++t) {
    if (place[t] >= 0) force[static_cast<Eigen::Index>(t)] = solved[place[t]];
  }
  return force;
}

std::vector<double> Unspread::Impl::forceOf(std::span<const double> image) {
  const Eigen::VectorXd right =
      spread.transpose() * Eigen::Map<const Eigen::VectorXd>(image.data(), static_cast<Eigen::Index>(image.size()));
  const double least_slope = kRounding * right.cwiseAbs().maxCoeff();
  std::size_t fewest = is_free.size() + 1;
  int tries = kBlockTries;
  for (int pivot = 0; pivot < kMaxPivots; ++pivot) {
    const Eigen::VectorXd force = solveFree(right), slope = normal * force - right;
    const double least_force = kRounding * force.cwiseAbs().maxCoeff();
    std::vector<std::size_t> wrong;
    for (std::size_t t = 0; t < is_free.size(); ++t) {
      const auto i = static_cast<Eigen::Index>(t);
      if (is_free[t] ? force[i] < -least_force : slope[i] < -least_slope) wrong.push_back(t);
    }
    if (wrong.empty()) {
      const Eigen::VectorXd result = force.cwiseMax(0);
      return {result.begin(), result.end()};
    }
    if (wrong.size() < fewest) {
      fewest = wrong.size();
      tries = kBlockTries;
    } else if (tries-- <= 0) {
      wrong.erase(wrong.begin(), wrong.end() - 1);
    }
    for (const std::size_t t : wrong) is_free[t] = !is_free[t];
  }
  throw Error(ErrorKind::kInput, "psf: cannot be inverted: no convergence in " + std::to_string(kMaxPivots) + " steps");
}

Unspread::Unspread(const Sensor& sensor) : impl_(std::make_unique<Impl>(sensor)) {}

Unspread::~Unspread() = default;

std::vector<double> Unspread::forceOf(std::span<const double> image) {
  return impl_->forceOf(image);
}

}  // namespace taxelsim
