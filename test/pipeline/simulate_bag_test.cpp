// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "allan_lio/io/tum.h"
#include "child_process.h"
#include "temporary_directory.h"

namespace allan_lio {
namespace {

class SimulateBag : public ::testing::Test {
 protected:
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(directory_.file(name)) << text;
    return directory_.file(name);
  }

  Outcome run(const std::string& arguments) const {
    return run_tool("simulate_bag " + arguments + " --out " + directory_.file("x.bag"));
  }

  void expect_refusal(const std::string& arguments, const std::string& sentence) const {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.status, 2) << arguments;
    EXPECT_NE(outcome.text.find(sentence), std::string::npos) << arguments << ": " << outcome.text;
    EXPECT_EQ(std::count(outcome.text.begin(), outcome.text.end(), '\n'), 1) << outcome.text;
  }

  /// A box of 20 m x 12 m x 4 m around the origin, as an OBJ.
  std::string box() const {
    return write("box.obj",
                 "v -10 -6 0\nv 10 -6 0\nv 10 6 0\nv -10 6 0\nv -10 -6 4\nv 10 -6 4\nv 10 6 4\nv -10 6 4\n"
                 "f 1 2 3 4\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n");
  }

  /// 10 s ahead at 0.3 m/s, 20 Hz.
  std::string record() const {
    Trajectory record;
    for (TimeNs i = 0; i <= 200; ++i)
      record.push_back({kFirst + i * 50000000,
                        {Eigen::Quaterniond::Identity(), {100.0 + 0.015 * static_cast<double>(i), -7.0, 3.0}}});
    write_tum(directory_.file("record.tum"), record);
    return directory_.file("record.tum");
  }

  static constexpr TimeNs kFirst = 1403715273262142976;
  TemporaryDirectory directory_;
};

TEST_F(SimulateBag, AMeshIsTravelledAlongAPath) {
  const std::string way = write("way.csv", "x,y,z\n-7,-3,1.2\n0,1,1.3\n7,2,1.2,0.5\n");
  const Outcome outcome = run("--scene mesh:" + box() + " --path " + way + " --profile driving --duration 1.5");
  ASSERT_EQ(outcome.status, 0) << outcome.text;
  const Trajectory truth = read_tum(directory_.file("x.tum"));
  EXPECT_EQ(truth.size(), 301u);
  EXPECT_LT((truth[0].pose.translation - Eigen::Vector3d(-7, -3, 1.2)).norm(), 1e-9) << "in the file's own frame";
}

TEST_F(SimulateBag, ARecordedTrajectoryKeepsItsStampsAndItsShape) {
  const Outcome outcome =
      run("--scene mesh:" + box() + " --trajectory " + record() + " --place -5,1,1.5,90 --standstill 2");
  ASSERT_EQ(outcome.status, 0) << outcome.text;
  EXPECT_NE(outcome.text.find("fitted within 0.00 mm"), std::string::npos) << outcome.text;
  const Trajectory truth = read_tum(directory_.file("x.tum"));
  const TimeNs last = kFirst + 10 * kNsPerSecond;
  EXPECT_NEAR(seconds_between(truth.back().stamp, last), 0.0, 0.006) << "one IMU sample at most";
  EXPECT_GT(seconds_between(truth.front().stamp, kFirst), 2.0);
  const auto at_first = std::min_element(truth.begin(), truth.end(), [](const StampedPose& a, const StampedPose& b) {
    return std::abs(a.stamp - kFirst) < std::abs(b.stamp - kFirst);
  });
  EXPECT_LT((at_first->pose.translation - Eigen::Vector3d(-5, 1, 1.5)).norm(), 0.002);
  EXPECT_LT((truth.back().pose.translation - Eigen::Vector3d(-5, 4, 1.5)).norm(), 0.004) << "turned by 90 degrees";
}

TEST_F(SimulateBag, WhatCannotBeDoneIsSaidInOneLine) {
  const std::string mesh = "--scene mesh:" + box();
  expect_refusal(mesh, "needs a --path or a --trajectory");
  expect_refusal(mesh + " --trajectory " + record(), "needs a --place");
  expect_refusal(mesh + " --path " + write("a.csv", "0,0,1\n0,9,1\n"), "meets a surface");
  expect_refusal(mesh + " --path " + write("b.csv", "0,0,1\n0,x,1\n"), "b.csv:2: 'x'");
  expect_refusal("--scene mesh:/nowhere.stl --path " + write("c.csv", "0,0,1\n0,2,1\n"), "/nowhere.stl");
  expect_refusal("--scene rooms --profile swimming", "walking, driving, flying");
  expect_refusal("--scene rooms --place 1,2,3,4", "--place is for a --trajectory");
  expect_refusal("--scene tunnel --trajectory " + record() + " --profile flying", "--profile does not apply");
  expect_refusal("--scene tunnel --trajectory " + directory_.file("absent.tum"), "absent.tum");
  expect_refusal("--scene rooms --standstill -1", "--standstill");
  expect_refusal("--scene rooms --stand 1", "--stand");
}

}  // namespace
}  // namespace allan_lio
