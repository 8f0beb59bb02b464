// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/sim/scenario.h"

#include <iomanip>
#include <locale>
#include <sstream>
#include <stdexcept>

#include "allan_lio/sim/mesh_file.h"
#include "allan_lio/sim/motion_profile.h"
#include "allan_lio/sim/recorded_trajectory.h"
#include "allan_lio/sim/waypoints.h"

namespace allan_lio {
namespace {

const std::string kMeshPrefix = "mesh:";

std::ostringstream text_stream(int decimals) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text << std::fixed << std::setprecision(decimals);
  return text;
}

void check(const ScenarioOptions& options) {
  const auto require = [](bool good, const char* sentence) {
    if (!good) throw std::invalid_argument(sentence);
  };
  const bool recorded = !options.trajectory.empty();
  require(options.path.empty() || !recorded, "--path and --trajectory exclude each other");
  require(options.place.empty() || recorded, "--place is for a --trajectory");
  require(options.place.empty() || options.place.size() == 4, "--place takes four numbers, x,y,z,yaw");
  require(!recorded || options.profile == "scene", "--profile does not apply to a --trajectory, which has its own");
  require(options.speed > 0, "--speed must be positive");
  require(options.standstill.value_or(0.0) >= 0, "--standstill cannot be negative");
}

Scene load_scene(const ScenarioOptions& options) {
  if (options.scene.compare(0, kMeshPrefix.size(), kMeshPrefix) != 0) return make_scene(options.scene);
  if (options.path.empty() && options.trajectory.empty())
    throw std::invalid_argument("--scene " + options.scene + " needs a --path or a --trajectory");
  if (!options.trajectory.empty() && options.place.empty())
    throw std::invalid_argument("--scene " + options.scene + " with a --trajectory needs a --place");
  Scene scene;
  scene.name = options.scene;
  scene.mesh = read_mesh(options.scene.substr(kMeshPrefix.size()));
  return scene;
}

std::unique_ptr<Motion> planned(const ScenarioOptions& options, Scene& scene) {
  if (!options.path.empty()) {
    scene.plan.waypoints = read_waypoints(options.path, options.speed);
    for (Waypoint& waypoint : scene.plan.waypoints) waypoint.position = scene.T_world_drawing * waypoint.position;
  }
  if (options.profile != "scene") apply_motion_profile(options.profile, options.seed, scene.plan);
  scene.plan.standstill_begin = options.standstill.value_or(scene.plan.standstill_begin);
  return std::make_unique<SimTrajectory>(scene.plan);
}

std::unique_ptr<Motion> recorded(const ScenarioOptions& options, Scenario& scenario) {
  const Trajectory record = read_tum(options.trajectory);
  const std::vector<double>& p = options.place;
  const RigidTransform T_drawing_record =
      p.empty() ? align_record(record, scenario.scene.record_centre, scenario.scene.record_heading)
                : place_record(record, {p[0], p[1], p[2]}, p[3]);
  RecordedOptions fit;
  fit.standstill = options.standstill.value_or(fit.standstill);
  auto motion = std::make_unique<RecordedTrajectory>(record, scenario.scene.T_world_drawing * T_drawing_record, fit);
  scenario.start = motion->first_stamp() - to_ns(motion->record_begin());
  std::ostringstream text = text_stream(2);
  constexpr double kDegrees = 180.0 / 3.14159265358979323846;
  text << options.trajectory << ": fitted within " << 1e3 * motion->position_misfit() << " mm and "
       << kDegrees * motion->rotation_misfit() << " deg rms; the record begins " << motion->record_begin()
       << " s after the start";
  scenario.remark = text.str();
  return motion;
}

/// A scene's own way keeps clear of its walls; one's own may not.
void refuse_collision(const Scenario& scenario) {
  const std::optional<double> time = first_collision(*scenario.motion, *scenario.caster);
  if (!time) return;
  const Eigen::Vector3d here =
      scenario.scene.T_world_drawing.inverse() * scenario.motion->at(*time).T_world_imu.translation;
  std::ostringstream text = text_stream(2);
  text << "the way meets a surface of scene " << scenario.scene.name << " at " << *time << " s, near x " << here.x()
       << ", y " << here.y() << ", z " << here.z() << " of its drawing";
  throw std::runtime_error(text.str());
}

}  // namespace

Scenario make_scenario(const ScenarioOptions& options) {
  check(options);
  Scenario scenario;
  scenario.scene = load_scene(options);
  scenario.motion = options.trajectory.empty() ? planned(options, scenario.scene) : recorded(options, scenario);
  scenario.caster = std::make_unique<RayCaster>(scenario.scene.mesh);
  const bool own = options.path.empty() && options.trajectory.empty() && options.profile == "scene";
  if (!own) refuse_collision(scenario);
  return scenario;
}

}  // namespace allan_lio
