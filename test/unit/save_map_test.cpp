// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/ros/save_map.h"

#include <gtest/gtest.h>
#include <pcl/io/pcd_io.h>
#include <pcl/point_types.h>
#include <signal.h>
#include <sys/resource.h>

#include <filesystem>
#include <fstream>

#include "temporary_directory.h"

namespace allan_lio {
namespace {

std::string why_not(const std::string& path, const std::vector<WorldPoint>& points) {
  try {
    save_map(path, points);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(SaveMap, reads_back_bit_for_bit) {
  const TemporaryDirectory directory;
  std::vector<WorldPoint> points;
  for (int i = 0; i < 1000; ++i) points.push_back({0.1F * i, -0.3F * i, 7.0F / (i + 1), 1.0F * (i % 256)});
  save_map(directory.file("map.pcd"), points);
  pcl::PointCloud<pcl::PointXYZI> read;
  ASSERT_EQ(pcl::io::loadPCDFile(directory.file("map.pcd"), read), 0);
  ASSERT_EQ(read.size(), points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(read[i].x, points[i].x);
    EXPECT_EQ(read[i].y, points[i].y);
    EXPECT_EQ(read[i].z, points[i].z);
    EXPECT_EQ(read[i].intensity, points[i].intensity);
  }
}

TEST(SaveMap, says_which_file_cannot_be_written) {
  const std::string path = "/nowhere/at/all/map.pcd";
  EXPECT_NE(why_not(path, {{1, 2, 3, 4}}).find(path), std::string::npos);
}

/// While it lives no file grows beyond so many bytes, as on a full disk.
class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) : signal_(signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FullDisk() {
    setrlimit(RLIMIT_FSIZE, &before_);
    signal(SIGXFSZ, signal_);
  }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;

 private:
  void (*signal_)(int);
  rlimit before_{};
};

TEST(SaveMap, what_cannot_be_written_leaves_what_was_there_and_no_part_of_it) {
  const TemporaryDirectory directory;
  const std::string path = directory.file("map.pcd"), taken = directory.file("taken");
  std::ofstream(path) << "the map of before";
  std::string sentence;
  {
    const FullDisk full(100);
    sentence = why_not(path, std::vector<WorldPoint>(1000, WorldPoint{1, 2, 3, 4}));
  }
  EXPECT_NE(sentence.find("cannot write " + path), std::string::npos) << sentence;
  EXPECT_FALSE(std::filesystem::exists(path + ".part"));
  EXPECT_EQ(std::filesystem::file_size(path), 17U);

  std::filesystem::create_directories(taken + "/by a directory");
  EXPECT_NE(why_not(taken, {{1, 2, 3, 4}}).find("cannot write " + taken), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(taken + ".part"));
}

TEST(SaveMap, says_that_the_map_is_empty) {
  const TemporaryDirectory directory;
  EXPECT_NE(why_not(directory.file("map.pcd"), {}).find("empty"), std::string::npos);
}

}  // namespace
}  // namespace allan_lio
