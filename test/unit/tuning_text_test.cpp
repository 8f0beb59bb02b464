// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/calib/tuning_text.h"

#include <gtest/gtest.h>

#include <functional>
#include <stdexcept>

#include "allan_lio/calib/noise_grid.h"

namespace allan_lio {
namespace {

using P = NoiseParameter;
using Lists = std::vector<std::vector<double>>;

std::string refusal(const std::function<void()>& read) {
  try {
    read();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(TuningText, AGridIsOneListOrOneForEachCoefficientInAnyOrder) {
  const std::vector<P> tuned = {P::kKgb, P::kKab};
  EXPECT_EQ(parse_grid("1, 10,50", tuned), (Lists{{1.0, 10.0, 50.0}}));
  EXPECT_EQ(parse_grid("k_ab=1,3;k_gb=5", tuned), (Lists{{5.0}, {1.0, 3.0}}));
  EXPECT_EQ(parse_grid("paper", tuned), Lists{paper_grid()});
}

TEST(TuningText, AStartIsOneNumberOrThoseNamedAndLeavesTheRest) {
  NoiseSetting configured;
  configured.imu.k_g = 2.0;
  EXPECT_TRUE(same_setting(parse_start("7", {P::kKa, P::kKr}, configured), {{2.0, 7.0, 1.0, 1.0}, 7.0}));
  EXPECT_TRUE(same_setting(parse_start("k_a=0.5", {P::kKa, P::kKr}, configured), {{2.0, 0.5, 1.0, 1.0}, 1.0}));
}

TEST(TuningText, AMistakeIsQuoted) {
  const std::vector<P> tuned = {P::kKgb, P::kKab};
  EXPECT_NE(refusal([&] { parse_grid("1,,3", tuned); }).find("1,,3"), std::string::npos);
  EXPECT_NE(refusal([&] { parse_grid("1,ten", tuned); }).find("'ten' is not a positive number"), std::string::npos);
  EXPECT_NE(refusal([&] { parse_grid("k_gb=1", tuned); }).find("no list for k_ab"), std::string::npos);
  EXPECT_NE(refusal([&] { parse_grid("k_gb=1;k_gb=2", tuned); }).find("two lists"), std::string::npos);
  EXPECT_NE(refusal([&] { parse_start("k_g=3", tuned, {}); }).find("k_g is not tuned"), std::string::npos);
  EXPECT_NE(refusal([&] { parse_parameters("k_gb,k_x"); }).find("k_x"), std::string::npos);
  NoiseProblem problem;
  EXPECT_NE(refusal([&] { parse_box("1", problem); }).find("LOW,HIGH"), std::string::npos);
}

}  // namespace
}  // namespace allan_lio
