// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include "allan_lio/sim/motion_profile.h"
#include "allan_lio/sim/random.h"
#include "allan_lio/sim/scene.h"
#include "scene_parts.h"

namespace allan_lio {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kBlockLength = 90.0, kBlockWidth = 60.0, kStreet = 14.0;  // [m]
constexpr double kPi = 3.14159265358979323846;

/// Numbers that are the same on every machine.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : bits_(hash_bits(seed)) {}
  double between(double low, double high) {
    return low + (high - low) * (static_cast<double>(hash_bits(bits_ + count_++) >> 11) / 9007199254740992.0);
  }

 private:
  std::uint64_t bits_, count_ = 0;
};

/// A row of houses from `begin` to `end`, whose fronts look to the left of that direction, onto the street.
class Row {
 public:
  Row(TriangleMesh& mesh, const Vector2d& begin, const Vector2d& end, std::uint64_t seed)
      : mesh_(mesh), begin_(begin), along_((end - begin).normalized()), length_((end - begin).norm()), dice_(seed) {}

  void build() {
    for (double s = 0.0; s < length_;) {
      double width = dice_.between(7.0, 13.0);
      if (length_ - s - width < 5.0) width = length_ - s;
      add_house(s, width);
      s += width;
    }
    for (double s = dice_.between(5.0, 8.0); s < length_ - 8.0; s += dice_.between(5.4, 11.0))
      add_car(mesh_, place(s, dice_.between(3.1, 3.4)), heading() + dice_.between(-0.06, 0.06));
    for (double s = dice_.between(1.0, 4.0); s < length_; s += dice_.between(7.0, 13.0))
      mesh_.add_pillar(place(s, 1.9), dice_.between(0.07, 0.2), 0.0, dice_.between(4.0, 7.0));
  }

 private:
  Vector2d place(double s, double out) const { return begin_ + s * along_ + out * Vector2d(-along_.y(), along_.x()); }
  double heading() const { return std::atan2(along_.y(), along_.x()); }

  /// A box from `s` on, `width` along the row, between two distances before the row's line and two heights.
  void box(double s, double width, double back, double front, double low, double high) {
    const Vector2d centre = place(s + 0.5 * width, 0.5 * (back + front));
    const Vector3d middle(centre.x(), centre.y(), 0.5 * (low + high));
    const Vector3d half(0.5 * width, 0.5 * (front - back), 0.5 * (high - low));
    mesh_.add_box(middle - half, middle + half, heading());
  }

  void add_house(double s, double width) {
    const double front = dice_.between(-1.2, 0.3), height = dice_.between(8.0, 17.0);
    box(s, width, -8.0, front, 0.0, height);
    for (double w = dice_.between(0.2, 0.9); w < width - 0.6; w += dice_.between(1.9, 3.4))  // pilasters
      box(s + w, dice_.between(0.3, 0.6), front, front + dice_.between(0.15, 0.3), 0.0, dice_.between(2.6, 5.0));
    const double porch = dice_.between(0.5, width - 2.2);
    box(s + porch, 1.4, front, front + 0.7, 0.0, dice_.between(0.3, 0.5));
    const double awning = dice_.between(0.4, width - 2.8);
    box(s + awning, 2.3, front, front + 1.1, 2.5, 2.62);
    box(s, width, front, front + 0.35, 3.4, 3.7);  // cornice
  }

  TriangleMesh& mesh_;
  Vector2d begin_, along_;
  double length_;
  Dice dice_;
};

void add_houses(TriangleMesh& mesh) {
  const auto ring = [&](double margin, bool outward, std::uint64_t seed) {
    const Vector2d corner[] = {{-margin, -margin},
                               {kBlockLength + margin, -margin},
                               {kBlockLength + margin, kBlockWidth + margin},
                               {-margin, kBlockWidth + margin}};
    for (int i = 0; i < 4; ++i) {
      const Vector2d &a = corner[i], &b = corner[(i + 1) % 4];
      Row(mesh, outward ? b : a, outward ? a : b, seed + i).build();
    }
  };
  ring(0.0, true, 11);
  ring(kStreet, false, 21);
}

/// Once round the block, counter-clockwise, `side` to the right of the street's middle.
void go_round(double side, TrajectoryPlan& plan) {
  constexpr double kCorner = 3.0, kDrive = 6.0, kBend = 5.0;  // [m/s], [m/s], radius [m]
  const double margin = 0.5 * kStreet + side;
  const Vector2d low(-margin, -margin), high(kBlockLength + margin, kBlockWidth + margin);
  const Vector2d centre[] = {{high.x() - kBend, low.y() + kBend},
                             {high.x() - kBend, high.y() - kBend},
                             {low.x() + kBend, high.y() - kBend},
                             {low.x() + kBend, low.y() + kBend}};
  for (int i = 0; i < 4; ++i) {
    for (int k = 0; k <= 4; ++k) {
      const double angle = 0.5 * kPi * (i - 1 + 0.25 * k);
      const Vector2d p = centre[i] + kBend * Vector2d(std::cos(angle), std::sin(angle));
      plan.waypoints.push_back({{p.x(), p.y(), kSceneImuHeight}, k == 0 ? kDrive : kCorner});
    }
  }
}

}  // namespace

Scene make_city() {
  Scene scene;
  add_houses(scene.mesh);
  constexpr double kReach = 40.0;
  add_ground(scene.mesh, {-kReach, -kReach}, {kBlockLength + kReach, kBlockWidth + kReach});
  scene.record_centre = Vector3d(30.0, -0.5 * kStreet, 1.6);
  scene.T_world_drawing.rotation = Eigen::AngleAxisd(-0.6713, Vector3d::UnitZ());
  scene.T_world_drawing.translation = Vector3d(-3.319, 8.127, 0.357);

  constexpr double kCrawl = 2.5, kDrive = 6.0;  // [m/s]
  const auto go = [&](double x, double y, double speed) {
    scene.plan.waypoints.push_back({{x, y, kSceneImuHeight}, speed});
  };
  go(12.0, -6.2, kCrawl);
  go(17.0, -7.2, kCrawl);
  go_round(0.6, scene.plan);
  go(40.0, -7.0, kDrive);
  go_round(0.0, scene.plan);
  go(6.0, -7.0, kDrive);
  scene.plan.acceleration = 1.5;
  scene.plan.knot_interval = 0.5;
  apply_motion_profile("driving", 1, scene.plan);
  return scene;
}

}  // namespace allan_lio
