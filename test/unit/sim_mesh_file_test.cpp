// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cstring>
#include <fstream>

#include "allan_lio/sim/mesh_file.h"
#include "allan_lio/sim/waypoints.h"
#include "shared_data.h"
#include "temporary_directory.h"

namespace allan_lio {
namespace {

using Eigen::Vector3d;

template <typename Number>
std::string bytes_of(Number value) {
  std::string bytes(sizeof value, '\0');
  std::memcpy(&bytes[0], &value, sizeof value);  // the machines that we know are little-endian
  return bytes;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

/// One triangle (0,0,0) (2,0,0) (0,3,1), after `count` has been claimed.
std::string binary_stl(std::uint32_t count) {
  std::string bytes = "solid in spite of its name";
  bytes.resize(80, ' ');
  bytes += bytes_of(count);
  for (const float number : {0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 2.f, 0.f, 0.f, 0.f, 3.f, 1.f}) bytes += bytes_of(number);
  return bytes + std::string(2, '\0');
}

const char kAsciiStl[] =
    "solid a\r\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 2 0 +0.0\n   vertex 0 3e0 1\n"
    "  endloop\n endfacet\nendsolid a\n";
const char kObj[] =
    "# one\nmtllib x.mtl\nv 0 0 0 1\nv 2 0 0\nv 2 3 1\nvt 0 0\nv 0 3 1\nusemtl y\nf 1/1 2//4 3/2/1 -1\nf -4 -3 -2\n";
const char kAsciiPly[] =
    "ply\nformat ascii 1.0\ncomment one\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    "property uchar red\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 0 9\n2 0 0 9\n0 3 1 9\n3 0 1 2\n";

std::string binary_ply(std::uint32_t last_index = 2) {
  std::string bytes =
      "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty float z\n"
      "property list uchar short more\nelement face 1\nproperty list uint8 uint32 vertex_index\nend_header\n";
  for (const auto& p : {Vector3d(0, 0, 0), Vector3d(2, 0, 0), Vector3d(0, 3, 1)})
    bytes +=
        bytes_of(p.x()) + bytes_of(p.y()) + bytes_of(static_cast<float>(p.z())) + '\1' + bytes_of(std::int16_t{-7});
  return bytes + '\3' + bytes_of(0u) + bytes_of(1u) + bytes_of(last_index);
}

class MeshFile : public ::testing::Test {
 protected:
  TriangleMesh read(const std::string& name, const std::string& bytes) {
    std::ofstream(directory_.file(name), std::ios::binary) << bytes;
    return read_mesh(directory_.file(name));
  }

  void expect_one_triangle(const std::string& name, const std::string& bytes) {
    const TriangleMesh mesh = read(name, bytes);
    ASSERT_EQ(mesh.triangles.size(), 1u) << name;
    const Vector3d corners[] = {{0, 0, 0}, {2, 0, 0}, {0, 3, 1}};
    for (int i = 0; i < 3; ++i) EXPECT_EQ(mesh.vertices[mesh.triangles[0][i]], corners[i]) << name;
  }

  void expect_refusal(const std::string& name, const std::string& bytes, const std::string& sentence) {
    try {
      read(name, bytes);
      ADD_FAILURE() << "not refused: " << sentence;
    } catch (const std::runtime_error& error) {
      const std::string text = error.what();
      EXPECT_NE(text.find(name), std::string::npos) << text;
      EXPECT_NE(text.find(sentence), std::string::npos) << text;
      EXPECT_EQ(text.find('\n'), std::string::npos) << text;
    }
  }

  TemporaryDirectory directory_;
};

TEST_F(MeshFile, ReadsTheSameTriangleFromEveryFormat) {
  expect_one_triangle("a.stl", binary_stl(1));
  expect_one_triangle("b.STL", kAsciiStl);
  expect_one_triangle("c.ply", kAsciiPly);
  expect_one_triangle("d.ply", binary_ply());
}

TEST_F(MeshFile, CutsPolygonsIntoFansAndCountsBackwards) {
  const TriangleMesh mesh = read("a.obj", kObj);
  ASSERT_EQ(mesh.triangles.size(), 3u);
  EXPECT_EQ(mesh.triangles[1], (std::array<std::uint32_t, 3>{0, 2, 3}));
  EXPECT_EQ(mesh.triangles[2], (std::array<std::uint32_t, 3>{0, 1, 2}));
}

TEST_F(MeshFile, DropsTrianglesWithoutAnArea) {
  EXPECT_EQ(read("a.obj", std::string(kObj) + "f 1 1 2\nv 4 0 0\nf 1 2 5\n").triangles.size(), 3u);
}

TEST_F(MeshFile, ACountThatLiesIsRefusedAtOnce) {
  expect_refusal("a.stl", binary_stl(4000000000u).replace(0, 5, "other"), "claims 4000000000 triangles");
  expect_refusal("a.ply", replaced(kAsciiPly, "vertex 3", "vertex 900000000000000"), "a.ply:15");
  expect_refusal("a.ply", replaced(kAsciiPly, "face 1", "face 900000000000000"), "ends before its last face");
  expect_refusal("b.ply", replaced(binary_ply(), "face 1", "face 99999999999"), "ends within an element");
  expect_refusal("c.ply", replaced(kAsciiPly, "3 0 1 2", "2000000000 0 1 2"), "list claims");
}

TEST_F(MeshFile, BrokenFilesAreNamedWithTheirPlace) {
  expect_refusal("a.stl", binary_stl(1).substr(0, 100).replace(0, 5, "other"), "byte 84: the file claims 1 triangles");
  expect_refusal("a.stl", "other", "byte 0: the file ends within the header");
  expect_refusal("b.stl", replaced(kAsciiStl, "3e0", "three"), "b.stl:6: 'three' is not a number");
  expect_refusal("b.stl", replaced(kAsciiStl, "vertex 2 0 +0.0", "vertex 2 0"), "b.stl:5: a vertex has three");
  expect_refusal("b.stl", replaced(kAsciiStl, "endsolid a\n", ""), "ends before 'endsolid'");
  expect_refusal("b.stl", replaced(kAsciiStl, "   vertex 0 0 0\n", ""), "2 vertices, not 3");
  expect_refusal("a.obj", std::string(kObj) + "f 1 2 9\n", "a.obj:11: the face names vertex 9, there are 4");
  expect_refusal("a.obj", std::string(kObj) + "f 1 2 0\n", "names vertex 0");
  expect_refusal("a.obj", replaced(kObj, "v 2 0 0", "v 2 nan 0"), "a.obj:4: 'nan'");
  expect_refusal("a.obj", "v 0 0 0\n", "holds no triangle");
  expect_refusal("a.obj", replaced(kObj, "v 2 0 0", "v 2e6 0 0"), "within 100 km");
  expect_refusal("a.ply", replaced(kAsciiPly, "3 0 1 2", "3 0 1 7"), "a.ply:15: a face names a vertex beyond");
  expect_refusal("a.ply", replaced(kAsciiPly, "2 0 0 9", "2 0 0"), "a.ply:13: the line holds less");
  expect_refusal("a.ply", replaced(kAsciiPly, "2 0 0 9", "2 0 0 9 9"), "holds more");
  expect_refusal("a.ply", replaced(kAsciiPly, "property float z\n", ""), "x, y and z");
  expect_refusal("a.ply", replaced(kAsciiPly, "ascii", "binary_big_endian"), "a.ply:2: the format 'binary_big_endian'");
  expect_refusal("a.ply", "plx\n", "not a PLY");
  expect_refusal("d.ply", binary_ply(3), "a face names a vertex beyond the 3");
  expect_refusal("d.ply", binary_ply().substr(0, binary_ply().size() - 2), "ends within an element");
  expect_refusal("a.dae", "", "ends in .stl, .obj or .ply");
  EXPECT_THROW(read_mesh(directory_.file("absent.stl")), std::runtime_error);
  EXPECT_THROW(read_mesh(directory_.path() + ".stl/"), std::runtime_error);
}

TEST_F(MeshFile, NoTruncationOfAGoodFileCrashes) {
  for (const auto& file : {std::pair<std::string, std::string>{"a.stl", binary_stl(1)},
                           {"b.stl", kAsciiStl},
                           {"c.ply", kAsciiPly},
                           {"d.ply", binary_ply()},
                           {"e.obj", kObj}}) {
    int refused = 0;
    for (std::size_t length = 0; length < file.second.size(); ++length) {
      try {
        read(file.first, file.second.substr(0, length));
      } catch (const std::runtime_error&) {
        ++refused;
      }
    }
    EXPECT_GT(refused, 50) << file.first;
  }
}

TEST_F(MeshFile, TheMeshesOfTheSharedDataAreWhole) {
  const std::string data = shared_data("meshes");
  if (data.empty()) GTEST_SKIP() << "shared/data/meshes is not here";
  EXPECT_EQ(read_mesh(data + "/edgar_mine.stl").triangles.size(), 22545u);
  EXPECT_EQ(read_mesh(data + "/cave_straight_03.stl").triangles.size(), 16033u);
  EXPECT_EQ(read_waypoints(data + "/edgar_mine_path.csv", 1.0).size(), 464u);
}

TEST_F(MeshFile, AWayIsReadWithOrWithoutHeadingAndSpeed) {
  const auto way = [&](const std::string& text) {
    std::ofstream(directory_.file("way.csv")) << text;
    return read_waypoints(directory_.file("way.csv"), 1.5);
  };
  const std::vector<Waypoint> points = way("x_m,y_m,z_m\n# here\n1,2,3\n4 5 6 0.7\n");
  ASSERT_EQ(points.size(), 2u);
  EXPECT_EQ(points[0].speed, 1.5);
  EXPECT_EQ(points[1].speed, 0.7);
  EXPECT_EQ(points[1].position, Vector3d(4, 5, 6));
  const auto refused = [&](const std::string& text, const std::string& sentence) {
    try {
      way(text);
      ADD_FAILURE() << "not refused: " << sentence;
    } catch (const std::runtime_error& error) {
      EXPECT_NE(std::string(error.what()).find("way.csv" + sentence), std::string::npos) << error.what();
    }
  };
  refused("1,2,3\nx,y,z\n", ":2: 'x' is not");
  refused("1,2,3\n4,5\n", ":2: a waypoint is");
  refused("1,2,3\n4,5,6,-1\n", ":2: the speed");
  refused("1,2,3\n1,2,3\n", ":2: the waypoint lies where");
  refused("1,2,3\n", ": a way needs two");
}

}  // namespace
}  // namespace allan_lio
