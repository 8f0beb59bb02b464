// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/sim/motion_profile.h"

#include <stdexcept>

#include "allan_lio/sim/random.h"

namespace allan_lio {
namespace {

constexpr double kTwoPi = 6.28318530717958647692;
constexpr std::uint64_t kPhaseStream = 101;  // apart from those of the IMU and the LiDAR

/// Phases in the order in which they are asked for.
class Phases {
 public:
  explicit Phases(std::uint64_t seed) : bits_(hash_bits(seed ^ hash_bits(kPhaseStream))) {}
  double next() { return kTwoPi * static_cast<double>(hash_bits(bits_ + count_++) >> 11) / 9007199254740992.0; }

 private:
  std::uint64_t bits_, count_ = 0;
};

/// Body bounce is the gait; suspension about 2 to 5 Hz, wheel hop at 10 to 12 Hz, engine and road at 23 Hz.
void make_driving(TrajectoryPlan& plan) {
  plan.gait = {1.43, 0.008, 0.01, 0.006, 0.005, 0.002, 2.0};
  plan.lean = -0.006;  // about 3.4 degrees per g
  plan.wobbles = {{Wobble::kUp, 4.7, 0.20, 0},      {Wobble::kUp, 10.9, 0.45, 0},    {Wobble::kUp, 23.3, 0.30, 0},
                  {Wobble::kLeft, 3.1, 0.10, 0},    {Wobble::kLeft, 9.7, 0.20, 0},   {Wobble::kForward, 22.1, 0.15, 0},
                  {Wobble::kRoll, 2.3, 0.012, 0},   {Wobble::kRoll, 10.3, 0.015, 0}, {Wobble::kPitch, 1.9, 0.010, 0},
                  {Wobble::kPitch, 11.7, 0.015, 0}, {Wobble::kYaw, 1.1, 0.003, 0}};
}

/// The gait is the slow wandering about the way in gusts; the wobbles are the controller's hunting and the frame.
void make_flying(TrajectoryPlan& plan) {
  plan.gait = {0.62, 0.02, 0.03, 0.02, 0.015, 0.03, 0.3};
  plan.lean = 1.0 / 9.80665;
  plan.wobbles = {{Wobble::kUp, 7.3, 0.30, 0},       {Wobble::kUp, 31.1, 0.80, 0},   {Wobble::kForward, 13.1, 0.30, 0},
                  {Wobble::kForward, 28.7, 0.40, 0}, {Wobble::kLeft, 11.9, 0.30, 0}, {Wobble::kLeft, 29.9, 0.40, 0},
                  {Wobble::kRoll, 5.3, 0.05, 0},     {Wobble::kRoll, 17.2, 0.04, 0}, {Wobble::kPitch, 6.1, 0.05, 0},
                  {Wobble::kPitch, 18.8, 0.04, 0},   {Wobble::kYaw, 2.9, 0.03, 0}};
}

}  // namespace

std::vector<std::string> motion_profile_names() { return {"walking", "driving", "flying"}; }

void apply_motion_profile(const std::string& name, std::uint64_t seed, TrajectoryPlan& plan) {
  if (name == "walking") {
    plan.gait = Gait();
    plan.lean = 0.0;
    plan.wobbles.clear();
  } else if (name == "driving") {
    make_driving(plan);
  } else if (name == "flying") {
    make_flying(plan);
  } else {
    std::string known;
    for (const std::string& one : motion_profile_names()) known += (known.empty() ? "" : ", ") + one;
    throw std::invalid_argument("there is no motion profile '" + name + "'; there are " + known);
  }
  Phases phases(seed);
  for (Wobble& wobble : plan.wobbles) wobble.phase = phases.next();
}

}  // namespace allan_lio
