#include "characterize/covariance.h"
#include "base/constants.h"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>
#include <utility>

namespace taxelsim {
namespace {

constexpr double kLeastEigenvalue = 1e-11;
constexpr double kLeastComponent = 1e-6;  // squared: a parameter with less of a null direction counts as identifiable

struct PseudoInverse {
  Eigen::MatrixXd matrix;
  std::vector<bool> identifiable;  // (parameters): has no component in the null space
};

// Pseudo-inverse of a symmetric matrix, which is scaled to columns of unit length before small eigenvalues are cut off.
PseudoInverse pseudoInverse(const Eigen::MatrixXd& normal, const Eigen::VectorXd& lengths) {
  const Eigen::Index count = normal.rows();
  PseudoInverse result{normal, std::vector<bool>(static_cast<std::size_t>(count), true)};
  if (count == 0) return result;
  Eigen::VectorXd inverse_length(count);
  for (Eigen::Index p = 0; p < count; ++p) inverse_length[p] = lengths[p] > 0 ? 1 / lengths[p] : 0;
  const Eigen::MatrixXd unit = inverse_length.asDiagonal() * normal * inverse_length.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(unit);
  Eigen::MatrixXd inverse = Eigen::MatrixXd::Zero(count, count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const Eigen::VectorXd direction = eigen.eigenvectors().col(k);
    if (eigen.eigenvalues()[k] >= kLeastEigenvalue) {
      inverse += direction * direction.transpose() / eigen.eigenvalues()[k];
      continue;
    }
    for (Eigen::Index p = 0; p < count; ++p) {
      if (direction[p] * direction[p] > kLeastComponent) result.identifiable[static_cast<std::size_t>(p)] = false;
    }
  }
  result.matrix = inverse_length.asDiagonal() * inverse * inverse_length.asDiagonal();
  return result;
}

Eigen::VectorXd scalesOf(const std::vector<FitParameter>& parameters) {
  Eigen::VectorXd scales(static_cast<Eigen::Index>(parameters.size()));
  for (std::size_t p = 0; p < parameters.size(); ++p) scales[static_cast<Eigen::Index>(p)] = parameters[p].scale;
  return scales;
}

// One group with its own parameters eliminated, in scaled parameters.
struct EliminatedGroup {
  PseudoInverse own;        // (B^T B)^-1
  Eigen::MatrixXd gain;     // W
  Eigen::MatrixXd by_row;   // (A^T - W B^T) diag(weights): (shared x rows)
  Eigen::VectorXd squares;  // of the columns of A
};

// Adds the group's part of S to `schur`.
EliminatedGroup eliminateOwn(const GroupedProblem& problem, std::size_t g, const std::vector<double>& weights,
                             const ParameterValues& values, Eigen::MatrixXd& schur) {
  const auto [a, b] = jacobiansOf(problem, g, weights, values);
  const Eigen::MatrixXd normal = b.transpose() * b, mixed = a.transpose() * b;
  EliminatedGroup group;
  group.own = pseudoInverse(normal, b.colwise().norm().transpose());
  group.gain = mixed * group.own.matrix;
  const Eigen::Map<const Eigen::VectorXd> weight(weights.data(), a.rows());
  group.by_row = (a.transpose() - group.gain * b.transpose()) * weight.asDiagonal();
  group.squares = a.colwise().squaredNorm().transpose();
  schur += a.transpose() * a - group.gain * mixed.transpose();
  return group;
}

void setOwn(const EliminatedGroup& group, const std::vector<FitParameter>& parameters, const Eigen::VectorXd& shared_scale, double variance,
            GroupedFit& fit) {
  const Eigen::MatrixXd own = group.own.matrix + group.gain.transpose() * fit.covariance * group.gain;
  std::vector<double> variances;
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    const auto at = static_cast<Eigen::Index>(p);
    const double scale = parameters[p].scale;
    variances.push_back(group.own.identifiable[p] ? variance * scale * scale * own(at, at) : kInfinity);
  }
  fit.own_variance.push_back(std::move(variances));
  const Eigen::VectorXd own_scale = scalesOf(parameters);
  fit.own_covariance.emplace_back(variance * (own_scale.asDiagonal() * group.own.matrix * own_scale.asDiagonal()));
  fit.own_by_shared.emplace_back(own_scale.asDiagonal() * group.gain.transpose() * shared_scale.cwiseInverse().asDiagonal());
}

}  // namespace

void setCovariances(const GroupedProblem& problem, const RowWeights& weights, const ParameterValues& values, double variance,
                    GroupedFit& fit) {
  const auto num_shared = static_cast<Eigen::Index>(problem.shared.size());
  const Eigen::VectorXd shared_scale = scalesOf(problem.shared);
  Eigen::MatrixXd schur = Eigen::MatrixXd::Zero(num_shared, num_shared);
  Eigen::VectorXd squares = Eigen::VectorXd::Zero(num_shared);
  std::vector<EliminatedGroup> groups;
  for (std::size_t g = 0; g < problem.own.size(); ++g) {
    groups.push_back(eliminateOwn(problem, g, weights[g], values, schur));
    squares += groups.back().squares;
  }
  const PseudoInverse inverse = pseudoInverse(schur, squares.cwiseSqrt());
  fit.covariance = inverse.matrix;  // of the scaled parameters, for a variance of 1, up to the end
  for (std::size_t g = 0; g < groups.size(); ++g) {
    fit.response.emplace_back(shared_scale.asDiagonal() * (fit.covariance * groups[g].by_row));
    setOwn(groups[g], problem.own[g], shared_scale, variance, fit);
  }
  for (Eigen::Index p = 0; p < num_shared; ++p) {
    for (Eigen::Index q = 0; q < num_shared; ++q) {
      const auto i = static_cast<std::size_t>(p), j = static_cast<std::size_t>(q);
      const double scale = problem.shared[i].scale * problem.shared[j].scale;
      fit.covariance(p, q) = inverse.identifiable[i] && inverse.identifiable[j] ? variance * scale * fit.covariance(p, q) : kInfinity;
    }
  }
}

}  // namespace taxelsim
