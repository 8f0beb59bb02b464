// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/calib/innovation_whiteness.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace allan_lio {
namespace {

constexpr int kScans = 200000;
constexpr double kScatter = 0.1;  ///< relative: some 3 sigma of the longest time by so many scans (Sokal 1997, (3.19))

/// The share of a single component that goes on from scan to scan by `memory`.
double share_of(double memory, double size) {
  std::mt19937_64 bits(7);
  std::normal_distribution<double> normal;
  InnovationWhiteness whiteness;
  double z = normal(bits);
  for (int i = 0; i < kScans; ++i) {
    z = memory * z + std::sqrt(1.0 - memory * memory) * normal(bits);
    PoseInnovation innovation;
    innovation.dof = 1;
    innovation.nis = size * z * z;
    whiteness.add(innovation);
  }
  return whiteness.independent_share();
}

TEST(InnovationWhiteness, WhiteOnesCountInFullWhateverTheirSize) {
  EXPECT_NEAR(share_of(0.0, 1.0), 1.0, kScatter);
  EXPECT_NEAR(share_of(0.0, 30.0), 1.0, kScatter);
}

TEST(InnovationWhiteness, OfAutoregressiveOnesTheSquaresTimeIsFound) {
  for (const double memory : {0.5, 0.9}) {
    const double squares = memory * memory;  // the squares' autocorrelation falls by this a scan
    const double expected = (1.0 - squares) / (1.0 + squares);
    EXPECT_NEAR(share_of(memory, 4.0), expected, kScatter * expected) << memory;
  }
}

TEST(InnovationWhiteness, FewScansAreTakenForWhite) {
  InnovationWhiteness whiteness;
  for (std::size_t i = 1; i < InnovationWhiteness::kFewest; ++i) {
    PoseInnovation innovation;
    innovation.dof = 6;
    innovation.nis = static_cast<double>(i);
    whiteness.add(innovation);
    whiteness.add(PoseInnovation());  // no update: passed over
  }
  EXPECT_EQ(whiteness.independent_share(), 1.0);
}

}  // namespace
}  // namespace allan_lio
