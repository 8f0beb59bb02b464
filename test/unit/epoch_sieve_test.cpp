// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/map/epoch_sieve.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <random>
#include <utility>

namespace allan_lio {
namespace {

using Made = std::vector<std::pair<VoxelCoordinates, std::uint32_t>>;

/// Voxels in a cube of 60, a few of them negative; later epochs farther along x.
Made some_voxels(int count, std::mt19937& random) {
  std::uniform_int_distribution<int> coordinate(-20, 39);
  Made made;
  for (int i = 0; i < count; ++i) {
    const VoxelCoordinates c{coordinate(random), coordinate(random), coordinate(random)};
    made.push_back({c, static_cast<std::uint32_t>(c.x + 20)});
  }
  return made;
}

bool is_near(const Made& made, const VoxelCoordinates& c, std::uint32_t last_epoch) {
  for (const auto& [m, epoch] : made)
    if (epoch <= last_epoch && std::abs(m.x - c.x) <= 1 && std::abs(m.y - c.y) <= 1 && std::abs(m.z - c.z) <= 1)
      return true;
  return false;
}

TEST(EpochSieve, NeverDeniesWhatIsThereAndDeniesMostOfWhatIsNot) {
  std::mt19937 random(1);
  const Made made = some_voxels(1000, random);
  EpochSieve sieve;
  for (const auto& [c, epoch] : made) sieve.note(c, epoch);
  constexpr std::uint32_t kLast = 20;
  int far_ahead = 0, denied = 0;
  for (const auto& [c, epoch] : some_voxels(4000, random)) {
    if (is_near(made, c, kLast)) {
      EXPECT_TRUE(sieve.may_be_near(c, kLast));
    } else if (epoch > kLast + 8) {
      ++far_ahead;
      denied += sieve.may_be_near(c, kLast) ? 0 : 1;
    }
  }
  EXPECT_GT(far_ahead, 1000);
  EXPECT_GT(denied, far_ahead * 9 / 10);
  sieve.clear();
  EXPECT_FALSE(sieve.may_be_near(made.front().first, 100));
}

/// How many of the voxels it denies to be near at this epoch.
int denied(const EpochSieve& sieve, const Made& voxels, std::uint32_t last_epoch) {
  int count = 0;
  for (const auto& [c, epoch] : voxels) count += sieve.may_be_near(c, last_epoch) ? 0 : 1;
  return count;
}

TEST(EpochSieve, FollowsVoxelsThatAreSeenAgain) {
  std::mt19937 random(2);
  const Made made = some_voxels(300, random);
  EpochSieve sieve;
  for (const auto& [c, epoch] : made) sieve.note(c, 10);
  sieve.finish_renewal();
  for (std::size_t i = 0; i < made.size(); ++i) {
    sieve.renew(made[i].first, 50);
    ASSERT_EQ(denied(sieve, made, 10), 0) << "a renewal that is not finished denies nothing";
  }
  sieve.finish_renewal();
  EXPECT_EQ(denied(sieve, made, 49), 300);
  EXPECT_EQ(denied(sieve, made, 50), 0);
}

TEST(EpochSieve, KeepsWhatComesDuringARenewal) {
  EpochSieve sieve;
  const VoxelCoordinates first{0, 0, 0}, second{40, 0, 0};
  sieve.note(first, 5);
  sieve.finish_renewal();
  sieve.renew(first, 8);
  sieve.note(second, 9);
  sieve.finish_renewal();
  EXPECT_FALSE(sieve.may_be_near(first, 7));
  EXPECT_TRUE(sieve.may_be_near(first, 8));
  EXPECT_TRUE(sieve.may_be_near(second, 9));
  sieve.finish_renewal();
  EXPECT_FALSE(sieve.may_be_near(second, 100)) << "it was not renewed";
}

}  // namespace
}  // namespace allan_lio
