// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "allan_lio/sim/lidar_simulator.h"
#include "allan_lio/sim/ray_caster.h"
#include "allan_lio/sim/scene.h"

namespace allan_lio {
namespace {

/// All beams of a LiDAR at `place` of the drawing, as hits whose normals are turned back to the drawing's frame.
std::vector<RayHit> look_around(const Scene& scene, const RayCaster& caster, const Eigen::Vector3d& place) {
  std::vector<RayHit> hits;
  for (int azimuth = 0; azimuth < 360; ++azimuth) {
    for (int elevation = -15; elevation <= 15; ++elevation) {
      const Eigen::Vector3d direction =
          Eigen::AngleAxisd(azimuth * 0.0174533, Eigen::Vector3d::UnitZ()) *
          (Eigen::AngleAxisd(elevation * 0.0174533, Eigen::Vector3d::UnitY()) * Eigen::Vector3d::UnitX());
      auto hit =
          caster.cast(scene.T_world_drawing * place, scene.T_world_drawing.rotation * direction, scene.max_range);
      if (!hit) continue;
      hit->normal = scene.T_world_drawing.rotation.conjugate() * hit->normal;
      hits.push_back(*hit);
    }
  }
  return hits;
}

/// Largest component of any seen normal along the drawing's x axis.
double axial_structure(const std::vector<RayHit>& hits) {
  double most = 0.0;
  for (const RayHit& hit : hits) most = std::max(most, std::abs(hit.normal.x()));
  return most;
}

TEST(SimScene, TheCorridorHasNoAxialStructureBetweenItsEnds) {
  const Scene scene = make_scene("corridor");
  const RayCaster caster(scene.mesh);
  constexpr double kRounding = 1e-12;
  for (double x = scene.max_range + 1.0; x < kCorridorLength - scene.max_range; x += 4.7) {
    const std::vector<RayHit> hits = look_around(scene, caster, {x, 0.21, 1.3});
    ASSERT_GT(hits.size(), 10000u);
    EXPECT_LT(axial_structure(hits), kRounding) << "at " << x;
  }
  EXPECT_GT(axial_structure(look_around(scene, caster, {20.0, 0.21, 1.3})), 0.9) << "the near hall must be seen";
}

TEST(SimScene, TheCorridorIsStraightAndOfItsWidth) {
  const Scene scene = make_scene("corridor");
  const RayCaster caster(scene.mesh);
  for (double x = 1.0; x < kCorridorLength; x += 13.3) {
    for (const double side : {-1.0, 1.0}) {
      const Eigen::Vector3d direction = scene.T_world_drawing.rotation * Eigen::Vector3d(0, side, 0);
      const auto hit = caster.cast(scene.T_world_drawing * Eigen::Vector3d(x, 0.0, 1.3), direction, 10.0);
      ASSERT_TRUE(hit);
      EXPECT_NEAR(hit->range, 0.5 * kCorridorWidth, 1e-9);
    }
  }
}

TEST(SimScene, AllSixDirectionsAreSeenEverywhereInTheRooms) {
  const Scene scene = make_scene("rooms");
  const RayCaster caster(scene.mesh);
  const SimTrajectory trajectory(scene.plan);
  constexpr int kFewest = 60;  // of 11,160 beams
  for (double t = 0.0; t < trajectory.duration(); t += 1.0) {
    const Eigen::Vector3d place = scene.T_world_drawing.inverse() * trajectory.at(t).T_world_imu.translation;
    int seen[6] = {};
    for (const RayHit& hit : look_around(scene, caster, place + Eigen::Vector3d(0, 0, 0.1)))
      for (int axis = 0; axis < 3; ++axis)
        if (std::abs(hit.normal[axis]) > 0.9) ++seen[2 * axis + (hit.normal[axis] > 0)];
    EXPECT_GE(*std::min_element(seen, seen + 6), kFewest)
        << "at " << t << " s, place " << place.transpose() << ", direction " << std::min_element(seen, seen + 6) - seen;
  }
}

TEST(SimScene, TheWayKeepsClearOfEverything) {
  constexpr double kClearance = 0.3;  // [m]
  for (const std::string& name : scene_names()) {
    const Scene scene = make_scene(name);
    const RayCaster caster(scene.mesh);
    const SimTrajectory trajectory(scene.plan);
    for (double t = 0.0; t < trajectory.duration(); t += 0.2) {
      const Eigen::Vector3d here = trajectory.at(t).T_world_imu.translation;
      for (const double height : {-0.6, 0.0, 0.1}) {
        for (int azimuth = 0; azimuth < 24; ++azimuth) {
          const Eigen::Vector3d direction(std::cos(azimuth * 0.2618), std::sin(azimuth * 0.2618), 0.0);
          const auto hit = caster.cast(here + Eigen::Vector3d(0, 0, height), direction, kClearance);
          ASSERT_FALSE(hit) << name << " at " << t << " s: " << hit->range << " m to the next surface, "
                            << (scene.T_world_drawing.inverse() * here).transpose();
        }
      }
    }
  }
}

TEST(SimScene, TheWaysHaveTheirLengthsAndComeBack) {
  const auto duration = [](const char* name) { return SimTrajectory(make_scene(name).plan).duration(); };
  EXPECT_NEAR(duration("rooms"), 160.0, 8.0);
  EXPECT_NEAR(duration("corridor"), 250.0, 10.0);
  EXPECT_NEAR(duration("tunnel"), 130.0, 10.0);
  for (const std::string& name : scene_names()) {
    const SimTrajectory trajectory(make_scene(name).plan);
    const Eigen::Vector3d start = trajectory.at(0.0).T_world_imu.translation;
    EXPECT_LT((trajectory.at(trajectory.duration()).T_world_imu.translation - start).norm(), 12.0) << name;
  }
}

TEST(SimScene, TheAccelerationsAreThoseOfAPersonOrACar) {
  for (const std::string& name : scene_names()) {
    const SimTrajectory trajectory(make_scene(name).plan);
    for (double t = 0.0; t < trajectory.duration(); t += 0.02) {
      const MotionState state = trajectory.at(t);
      ASSERT_LT(state.acceleration_world.norm(), 5.0) << name << " at " << t;
      ASSERT_LT(state.rate_imu.norm(), 2.5) << name << " at " << t;
    }
  }
}

TEST(SimScene, NoWallIsParallelToTheStartingPose) {
  for (const std::string& name : scene_names()) {
    const Scene scene = make_scene(name);
    const SimTrajectory trajectory(scene.plan);
    const Eigen::Vector3d ahead = trajectory.at(0.0).T_world_imu.rotation * Eigen::Vector3d::UnitX();
    for (const Eigen::Vector3d& axis : {ahead, Eigen::Vector3d(Eigen::Vector3d::UnitX())}) {
      const Eigen::Vector3d drawn = scene.T_world_drawing.rotation.conjugate() * axis;
      EXPECT_GT(std::min(std::abs(drawn.x()), std::abs(drawn.y())), 0.05) << name;
    }
  }
}

TEST(SimScene, AnUnknownNameIsAnsweredWithTheKnownOnes) {
  try {
    make_scene("cave");
    FAIL() << "not refused";
  } catch (const std::invalid_argument& error) {
    const std::string sentence = error.what();
    EXPECT_NE(sentence.find("cave"), std::string::npos);
    for (const std::string& name : scene_names()) EXPECT_NE(sentence.find(name), std::string::npos);
  }
}

TEST(SimScene, NoTriangleIsDegenerate) {
  for (const std::string& name : scene_names()) {
    const TriangleMesh mesh = make_scene(name).mesh;
    for (const auto& triangle : mesh.triangles) {
      const Eigen::Vector3d a = mesh.vertices[triangle[1]] - mesh.vertices[triangle[0]];
      const Eigen::Vector3d b = mesh.vertices[triangle[2]] - mesh.vertices[triangle[0]];
      ASSERT_GT(a.cross(b).norm(), 1e-6) << name;
    }
  }
}

}  // namespace
}  // namespace allan_lio
