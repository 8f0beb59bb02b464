// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace allan_lio {

/// df/dx at x = 0 by central differences of fourth order: `f` takes a vector of `size` entries and returns one.
template <class Function>
Eigen::MatrixXd central_differences(const Function& f, int size, double step) {
  Eigen::MatrixXd jacobian;
  for (int i = 0; i < size; ++i) {
    const auto at = [&](double s) {
      Eigen::VectorXd d = Eigen::VectorXd::Zero(size);
      d[i] = s * step;
      return Eigen::VectorXd(f(d));
    };
    const Eigen::VectorXd column = (8.0 * (at(1) - at(-1)) - (at(2) - at(-2))) / (12.0 * step);
    if (i == 0) jacobian.resize(column.size(), size);
    jacobian.col(i) = column;
  }
  return jacobian;
}

/// A named range of rows or columns of a state.
struct StateBlock {
  std::string name;
  int begin, size;
};

/// The blocks in which two matrices differ by more than `tolerance`, as "velocity/gyro bias differs by 0.1; ..."
inline std::string differing_blocks(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b,
                                    const std::vector<StateBlock>& blocks, double tolerance) {
  std::string report;
  for (const StateBlock& row : blocks)
    for (const StateBlock& col : blocks) {
      const double difference =
          (a.block(row.begin, col.begin, row.size, col.size) - b.block(row.begin, col.begin, row.size, col.size))
              .cwiseAbs()
              .maxCoeff();
      if (!(difference <= tolerance))
        report += row.name + "/" + col.name + " differs by " + std::to_string(difference) + "; ";
    }
  return report;
}

}  // namespace allan_lio
