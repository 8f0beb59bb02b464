// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "spline_fit.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <stdexcept>

#include "quintic_spline.h"

namespace allan_lio {
namespace {

constexpr double kStiffness = 1e-6;  // against a sample's weight of 1

using Values = Eigen::Matrix<double, Eigen::Dynamic, 7>;

/// The normal equations, of which only the lower half is filled.
class NormalEquations {
 public:
  explicit NormalEquations(int size)
      : right_(Values::Zero(size, 7)), band_(Eigen::MatrixXd::Zero(kSplineOrder, size)) {}

  /// A row with `count` coefficients from column `begin` on.
  void add(int begin, const double* coefficients, int count, const Eigen::Matrix<double, 7, 1>& value, double weight) {
    for (int i = 0; i < count; ++i) {
      for (int j = 0; j <= i; ++j) band_(i - j, begin + j) += weight * coefficients[i] * coefficients[j];
      right_.row(begin + i) += weight * coefficients[i] * value.transpose();
    }
  }

  Values solve() const {
    const int size = static_cast<int>(right_.rows());
    std::vector<Eigen::Triplet<double>> entries;
    for (int column = 0; column < size; ++column)
      for (int below = 0; below < kSplineOrder && column + below < size; ++below)
        entries.emplace_back(column + below, column, band_(below, column));
    Eigen::SparseMatrix<double> matrix(size, size);
    matrix.setFromTriplets(entries.begin(), entries.end());
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower, Eigen::NaturalOrdering<int>> solver(matrix);
    if (solver.info() != Eigen::Success) throw std::runtime_error("recorded trajectory: the spline cannot be fitted");
    return solver.solve(right_);
  }

 private:
  Values right_;
  Eigen::MatrixXd band_;  ///< row k: the k-th diagonal below the main one
};

}  // namespace

Values fit_quintic_spline(const std::vector<SplineSample>& samples, int segments) {
  const int size = segments + kSplineOrder - 1;
  NormalEquations equations(size);
  for (const SplineSample& sample : samples) {
    const int segment = std::max(0, std::min(static_cast<int>(sample.knots), segments - 1));
    const QuinticBasis basis = quintic_basis(sample.knots - segment);
    equations.add(segment, basis.value, kSplineOrder, sample.value, 1.0);
  }
  constexpr double kThirdDifference[] = {-1.0, 3.0, -3.0, 1.0};
  for (int i = 0; i + 4 <= size; ++i)
    equations.add(i, kThirdDifference, 4, Eigen::Matrix<double, 7, 1>::Zero(), kStiffness);
  return equations.solve();
}

}  // namespace allan_lio
