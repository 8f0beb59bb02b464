// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/ros/lio_wrapper.h"

#include <ros/console.h>
#include <ros/init.h>
#include <ros/this_node.h>

#include <iostream>
#include <utility>

namespace allan_lio {
namespace {

constexpr double kTfPatience = 10.0;  // [s]
constexpr double kMapPeriod = 3.0;    // [s]
constexpr int kImuQueue = 4000;
constexpr int kLidarQueue = 20;

}  // namespace

LioWrapper::LioWrapper(ros::NodeHandle handle, ros::NodeHandle private_handle)
    : parameters_(read_node_parameters(private_handle)),
      T_base_imu_(resolve_extrinsics(parameters_.config, kTfPatience)),
      publisher_(std::make_unique<LioPublisher>(private_handle, parameters_.config, T_base_imu_)) {
  const LioConfig& config = parameters_.config;
  show_in_force(private_handle, to_source(config));
  session_ = std::make_unique<LioSession>(config, parameters_.out, [this](const LioResult& r) { on_result(r); });
  monitor_ = std::make_unique<LioMonitor>(handle, private_handle, *session_);
  tuning_ = std::make_unique<LiveTuning>(private_handle, parameters_,
                                         [this](const LioConfig& wanted) { session_->reconfigure(wanted); });
  services_ = std::make_unique<LioServices>(
      private_handle, LioServices::Context{*session_, T_base_imu_, parameters_.out, [this] { return R_world_imu_; },
                                           [this] { start_again(); }});
  ROS_INFO("imu: %s, lidar: %s, k_g %g, k_a %g, k_gb %g, k_ab %g, configuration %s", config.topics.imu.c_str(),
           config.topics.lidar.c_str(), config.imu.scale.k_g, config.imu.scale.k_a, config.imu.scale.k_gb,
           config.imu.scale.k_ab, config_hash(config).c_str());
  map_timer_ = handle.createWallTimer(ros::WallDuration(kMapPeriod), &LioWrapper::on_map_timer, this);
  const ros::TransportHints hints = ros::TransportHints().tcpNoDelay();
  imu_subscriber_ = handle.subscribe(config.topics.imu, kImuQueue, &LioWrapper::on_imu, this, hints);
  lidar_subscriber_ = handle.subscribe(config.topics.lidar, kLidarQueue, &LioWrapper::on_cloud, this, hints);
  // After the subscribers: who finds the service can count on them.
  finish_service_ = private_handle.advertiseService("finish", &LioWrapper::on_finish, this);
}

LioWrapper::~LioWrapper() {
  try {
    session_->finish("interrupted");
  } catch (const std::exception& error) {
    // The console of ROS is silent from the moment on that the node begins to shut down.
    if (ros::isShuttingDown())
      std::cerr << ros::this_node::getName() << ": " << error.what() << std::endl;
    else
      ROS_ERROR_STREAM(error.what());
  }
}

void LioWrapper::on_imu(const sensor_msgs::ImuConstPtr& message) {
  ++imu_received_;
  monitor_->saw_imu(message->header.seq);
  if (!finished_) session_->add(*message);
}

void LioWrapper::on_cloud(const topic_tools::ShapeShifter::ConstPtr& message) {
  ++scans_received_;
  if (finished_) return;
  tuning_->poll();
  const RawCloud cloud = to_raw_cloud(*message, cloud_bytes_);
  const std::string error = session_->add(cloud);
  monitor_->saw_cloud(number_of(cloud), error);
  if (!error.empty()) ROS_ERROR_STREAM_THROTTLE(2.0, "scan refused: " << error);
  tell_news();
}

void LioWrapper::on_result(const LioResult& result) {
  R_world_imu_ = result.state.nav.T_world_imu.rotation;
  publisher_->publish(result, *session_);
  monitor_->saw_result(result);
}

void LioWrapper::start_again() {
  R_world_imu_.reset();
  publisher_->clear_path();
  monitor_->clear();
}

void LioWrapper::tell_news() {
  if (session_->restarts() != told_restarts_) ROS_WARN_STREAM(session_->restarted());
  told_restarts_ = session_->restarts();
  if (session_->relocated() != told_relocated_) ROS_WARN_STREAM(session_->relocated());
  told_relocated_ = session_->relocated();
  if (!session_->output_trouble().empty() && !std::exchange(told_output_trouble_, true))
    ROS_ERROR_STREAM(session_->output_trouble() << "; the odometry goes on, results are lost");
  const std::string clocks = session_->clock_trouble();
  if (!clocks.empty()) ROS_ERROR_STREAM_THROTTLE(5.0, clocks);
  if (session_->verdict() != told_verdict_) ROS_INFO_STREAM(session_->verdict());
  told_verdict_ = session_->verdict();
  for (; told_remarks_ < session_->remarks().size(); ++told_remarks_)
    ROS_INFO_STREAM(session_->remarks()[told_remarks_]);
  if (told_noise_) return;
  for (const std::string& line : session_->noise_report()) ROS_INFO_STREAM(line);
  told_noise_ = !session_->noise_report().empty();
}

void LioWrapper::on_map_timer(const ros::WallTimerEvent&) { publisher_->publish_map(*session_); }

bool LioWrapper::on_finish(Finish::Request& request, Finish::Response& response) {
  if (!finished_) session_->set_inputs(request.inputs);
  const bool all_here = imu_received_ >= request.imu_sent && scans_received_ >= request.scans_sent;
  if (request.end && all_here && !finished_) finish(request);
  response.imu_received = imu_received_;
  response.scans_received = scans_received_;
  response.finished = finished_;
  response.success = finished_ && trouble_.empty();
  response.message = finished_ ? trouble_ : session_->hopeless();
  response.node = ros::this_node::getName();
  response.imu_topic = imu_subscriber_.getTopic();
  response.lidar_topic = lidar_subscriber_.getTopic();
  return true;
}

void LioWrapper::finish(const Finish::Request& request) {
  finished_ = true;
  for (const std::string& note : request.notes) session_->add_note(note);
  try {
    session_->end_of_data();
    trouble_ = session_->why_nothing();
    const std::string why = trouble_.empty() && !request.notes.empty() ? request.notes.front() : trouble_;
    session_->finish(why.empty() ? "complete" : "incomplete: " + why);
  } catch (const std::exception& error) {
    trouble_ = error.what();
  }
  publisher_->publish_map(*session_);
  if (!trouble_.empty()) ROS_ERROR_STREAM(trouble_);
}

}  // namespace allan_lio
