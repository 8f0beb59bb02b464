// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "changed_bag.h"
#include "simulated_bag.h"

namespace allan_lio {
namespace {

constexpr double kShort = 4.0;        // [s] of the bag, enough for most checks
constexpr double kGravity = 9.80665;  // [m/s^2]

/// A changed copy of the simulated bag, and what check_bag says of it.
class CheckedBag {
 public:
  explicit CheckedBag(BagChange change, double duration = kShort) {
    change.duration = duration;
    change_bag(SimulatedBag::get().bag(), bag(), change);
    run();
  }
  CheckedBag(const CheckedBag&) = delete;

  void run(const std::string& more = "") {
    const Outcome outcome = run_tool("check_bag " + bag() + " --out " + config() + " " + more);
    status = outcome.status;
    text = outcome.text;
  }
  bool says(const std::string& words) const { return text.find(words) != std::string::npos; }
  std::string bag() const { return directory_.file("changed.bag"); }
  std::string config() const { return directory_.file("suggested.yaml"); }
  std::string results() const { return directory_.file("results"); }

  int status = -1;
  std::string text;

 private:
  TemporaryDirectory directory_;
};

TEST(CheckBag, AGoodRecordingIsUsableAndLioOfflineTakesTheSuggestion) {
  const CheckedBag good({}, 20.0);
  EXPECT_EQ(good.status, 0) << good.text;
  for (const char* words :
       {"topics:\n  /imu/data: sensor_msgs/Imu\n", "  /points: sensor_msgs/PointCloud2\n",
        "4001 messages, 200 Hz, jitter 0 ms, no gaps", "200 messages, 10 Hz, jitter 0 ms, no gaps",
        "accelerometer: reads in m/s^2, 9.8", " m/s^2 at rest\n", "; scatter at rest: N_g ",
        "standstill at the start: ", "float32 in s since the sweep's start", "clocks: scans arrive",
        "no saturation seen", "nothing that this check knows", "settings of config/lidar/velodyne16"})
    EXPECT_TRUE(good.says(words)) << words << "\n" << good.text;
  const Outcome run =
      run_tool("lio_offline --bag " + good.bag() + " --config " + good.config() + " --out " + good.results());
  EXPECT_EQ(run.status, 0) << run.text;
  EXPECT_NE(run.text.find("200 of 200 scans used"), std::string::npos) << run.text;
}

TEST(CheckBag, AnImuInGIsTold) {
  const CheckedBag in_g({[](sensor_msgs::Imu& imu) {
    imu.linear_acceleration.x /= kGravity;
    imu.linear_acceleration.y /= kGravity;
    imu.linear_acceleration.z /= kGravity;
    return true;
  }});
  EXPECT_EQ(in_g.status, 0) << in_g.text;
  EXPECT_TRUE(in_g.says("accelerometer: reads in g, 9.")) << in_g.text;
  EXPECT_TRUE(in_g.says("accel_unit: g\n")) << in_g.text;
}

TEST(CheckBag, GapsAreMeasured) {
  int imu_count = 0, cloud_count = 0;
  const CheckedBag gaps({[&](sensor_msgs::Imu&) { return ++imu_count < 400 || imu_count >= 500; },
                         [&](sensor_msgs::PointCloud2&) { return ++cloud_count % 20 != 0; }});
  EXPECT_EQ(gaps.status, 0) << gaps.text;
  EXPECT_TRUE(gaps.says("the IMU is silent for up to 0.505 s (1 gaps)")) << gaps.text;
  EXPECT_TRUE(gaps.says("scans are missing: ")) << gaps.text;
}

TEST(CheckBag, AMissingSensorIsFatal) {
  const CheckedBag no_lidar({{}, [](sensor_msgs::PointCloud2&) { return false; }});
  EXPECT_EQ(no_lidar.status, 1);
  EXPECT_TRUE(no_lidar.says("FATAL: there is no topic of point clouds")) << no_lidar.text;
  EXPECT_FALSE(std::filesystem::exists(no_lidar.config()));
  const CheckedBag no_imu({[](sensor_msgs::Imu&) { return false; }});
  EXPECT_EQ(no_imu.status, 1);
  EXPECT_TRUE(no_imu.says("FATAL: there is no topic of sensor_msgs/Imu")) << no_imu.text;
}

TEST(CheckBag, ClocksThatHaveNothingInCommonAreFatalAndBothRangesArePrinted) {
  const CheckedBag apart({[](sensor_msgs::Imu& imu) {
    imu.header.stamp += ros::Duration(1000.0);
    return true;
  }});
  EXPECT_EQ(apart.status, 1);
  EXPECT_TRUE(apart.says("nothing in common: the IMU's stamps go 1700001000.000 to 1700001004.000 s")) << apart.text;
  EXPECT_TRUE(apart.says("the LiDAR's 1700000000.000 to")) << apart.text;
}

TEST(CheckBag, AClockThatIsALittleOffIsTold) {
  const CheckedBag late({[](sensor_msgs::Imu& imu) {
    imu.header.stamp += ros::Duration(0.4);
    return true;
  }});
  EXPECT_EQ(late.status, 0);
  EXPECT_TRUE(late.says("scans arrive 400 ms later after their end")) << late.text;
  EXPECT_TRUE(late.says("lidar/time_offset")) << late.text;
}

TEST(CheckBag, CloudsWithoutTimesGetAConfigurationWithoutDeskewing) {
  const CheckedBag timeless({{}, [](sensor_msgs::PointCloud2& cloud) {
                               cloud.fields.pop_back();
                               return true;
                             }});
  EXPECT_EQ(timeless.status, 0) << timeless.text;
  EXPECT_TRUE(timeless.says("no field for the points' times")) << timeless.text;
  EXPECT_TRUE(timeless.says("deskew: false")) << timeless.text;
  EXPECT_TRUE(timeless.says("  # point_time: azimuth_clockwise ")) << timeless.text;
  EXPECT_EQ(run_tool("lio_parameters --config " + timeless.config()).status, 0);
}

/// From back to front, so that the points come in the order of a LiDAR that turns the other way.
void turn_round(sensor_msgs::PointCloud2& cloud) {
  const std::vector<std::uint8_t> forward = cloud.data;
  for (std::size_t at = 0, step = cloud.point_step; at + step <= forward.size(); at += step)
    std::copy_n(&forward[forward.size() - step - at], step, &cloud.data[at]);
}

TEST(CheckBag, TheAzimuthIsSuggestedOnlyWhereThePointsComeInItsOrder) {
  const CheckedBag other_way({{}, [](sensor_msgs::PointCloud2& cloud) {
                                cloud.fields.pop_back();
                                turn_round(cloud);
                                return true;
                              }});
  EXPECT_TRUE(other_way.says("  # point_time: azimuth_counterclockwise ")) << other_way.text;
  const CheckedBag no_order({{}, [](sensor_msgs::PointCloud2& cloud) {
                               cloud.fields.pop_back();
                               // Half a turn twice.
                               const std::size_t half = cloud.data.size() / 2;
                               std::copy_n(&cloud.data[half], half, &cloud.data[0]);
                               return true;
                             }});
  EXPECT_EQ(no_order.status, 0) << no_order.text;
  EXPECT_FALSE(no_order.says("# point_time: azimuth")) << no_order.text;
}

TEST(CheckBag, TimesOfAnotherClockGetAConfigurationThatAnchorsThem) {
  const CheckedBag other({{}, [](sensor_msgs::PointCloud2& cloud) {
                            cloud = in_layout(cloud, layout_of("hesai"), 7000.0, 1.0);
                            return true;
                          }});
  EXPECT_EQ(other.status, 0) << other.text;
  EXPECT_TRUE(other.says("of another clock")) << other.text;
  EXPECT_TRUE(other.says("point_time: start")) << other.text;
  EXPECT_EQ(run_tool("lio_parameters --config " + other.config()).status, 0);
}

TEST(CheckBag, SaturationAndAMovingStartAreTold) {
  const CheckedBag rough({[](sensor_msgs::Imu& imu) {
    const double t = imu.header.stamp.toSec() - 1.7e9;
    imu.angular_velocity.x = std::max(-1.0, std::min(1.0, 1.2 * std::pow(std::sin(6.0 * t), 5)));
    return true;
  }});
  EXPECT_EQ(rough.status, 0) << rough.text;
  EXPECT_TRUE(rough.says("the gyro saturates at 1 rad/s")) << rough.text;
  EXPECT_TRUE(rough.says("gyro_range: 1 ")) << rough.text;
  EXPECT_TRUE(rough.says("begins in motion")) << rough.text;
}

TEST(CheckBag, LivoxCustomMsgIsReadAndItsSettingsSuggested) {
  BagChange change;
  change.livox_custom = true;
  const CheckedBag livox(change);
  EXPECT_EQ(livox.status, 0) << livox.text;
  EXPECT_TRUE(livox.says("livox_ros_driver2/CustomMsg, frame 'livox_frame'")) << livox.text;
  EXPECT_TRUE(livox.says("'offset_time' uint32 in ns")) << livox.text;
  EXPECT_TRUE(livox.says("lidar/livox]")) << livox.text;
}

/// The first point's ring: that of the last beam tells how many there are.
void set_first_ring(sensor_msgs::PointCloud2& cloud, std::uint16_t ring) {
  for (const sensor_msgs::PointField& field : cloud.fields)
    if (field.name == "ring") std::memcpy(&cloud.data[field.offset], &ring, sizeof ring);
}

TEST(CheckBag, EveryDriversSettingsAreSuggested) {
  struct Recording {
    const char* driver;
    const char* frame;
    std::uint16_t ring;
    const char* settings;
  };
  constexpr Recording kRecordings[] = {
      {"velodyne", "velodyne", 15, "velodyne16"}, {"velodyne", "velodyne", 31, "velodyne32"},
      {"velodyne", "velodyne", 63, "velodyne64"}, {"ouster", "os_sensor", 63, "ouster"},
      {"hesai", "PandarQT", 31, "hesai"},         {"robosense", "rslidar", 15, "robosense"},
      {"livox", "livox_frame", 3, "livox"},
  };
  for (const Recording& recording : kRecordings) {
    SCOPED_TRACE(recording.settings);
    const std::string driver = recording.driver;
    const CheckedBag checked({{}, [&](sensor_msgs::PointCloud2& cloud) {
                                const bool clock = driver != "velodyne" && driver != "ouster";
                                const double per_second = driver == "ouster" || driver == "livox" ? 1e9 : 1.0;
                                const double zero = clock ? per_second * cloud.header.stamp.toSec() : 0.0;
                                cloud = in_layout(cloud, layout_of(driver), zero, per_second);
                                cloud.header.frame_id = recording.frame;
                                if (driver != "livox") set_first_ring(cloud, recording.ring);
                                return true;
                              }});
    EXPECT_EQ(checked.status, 0) << checked.text;
    const std::string settings = recording.settings;
    EXPECT_TRUE(checked.says("settings of config/lidar/" + settings + "\n")) << checked.text;
    EXPECT_TRUE(checked.says("lidar/" + settings + "]")) << checked.text;
    EXPECT_EQ(run_tool("lio_parameters --config " + checked.config()).status, 0);
  }
}

TEST(CheckBag, ABagThatIsCutOffIsCheckedAsFarAsItGoes) {
  CheckedBag cut({});
  std::filesystem::resize_file(cut.bag(), std::filesystem::file_size(cut.bag()) / 2);
  cut.run();
  EXPECT_EQ(cut.status, 0) << cut.text;
  EXPECT_TRUE(cut.says("has no usable index")) << cut.text;
  EXPECT_TRUE(cut.says("\nusable")) << cut.text;
}

TEST(CheckBag, BadCallsAreToldFromBadBags) {
  CheckedBag good({});
  EXPECT_EQ(run_tool("check_bag").status, 2);
  EXPECT_EQ(run_tool("check_bag /no/such.bag").status, 2);
  EXPECT_EQ(run_tool("check_bag --help").status, 0);
  std::ofstream(good.config()) << "no bag at all, but long enough";
  const Outcome no_bag = run_tool("check_bag " + good.config());
  EXPECT_EQ(no_bag.status, 1);
  EXPECT_NE(no_bag.text.find("is not a bag"), std::string::npos) << no_bag.text;
  good.run("--imu /other");
  EXPECT_EQ(good.status, 1);
  EXPECT_TRUE(good.says("no topic /other; its topics of type sensor_msgs/Imu: /imu/data")) << good.text;
}

}  // namespace
}  // namespace allan_lio
