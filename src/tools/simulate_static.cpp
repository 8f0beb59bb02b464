// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <iostream>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "allan_lio/io/config_source.h"
#include "allan_lio/io/yaml_source.h"
#include "allan_lio/ros/bag_writer.h"
#include "allan_lio/ros/config_dirs.h"
#include "allan_lio/sim/imu_simulator.h"

namespace {

using namespace allan_lio;

constexpr TimeNs kBagStart = 1700000000 * kNsPerSecond;

struct Options {
  std::string imu = "imu/mti600", out, topic = "/imu/data";
  std::vector<std::string> overrides;
  double hours = 6.0, rate = 400.0;
  std::int64_t seed = 1;
  ImuErrorConfig errors;
};

NoiseSpec load_imu(const Options& options) {
  std::vector<std::string> dirs;
  for (const std::string& dir : config_search_dirs()) dirs.insert(dirs.end(), {dir, dir + "/imu"});
  ConfigSource source = load_yaml(options.imu, dirs);
  for (const std::string& text : options.overrides) source = merge(source, parse_override(text));
  return read_config(source).imu.spec;
}

/// Where the samples go; their stamps count from the start of the record.
class Sink {
 public:
  virtual ~Sink() = default;
  virtual void write(const ImuSample& sample) = 0;
  virtual void close() = 0;
};

class BagSink : public Sink {
 public:
  BagSink(const std::string& path, const std::string& topic) : bag_(path), topic_(topic) {}
  void write(const ImuSample& sample) override {
    bag_.write_imu({kBagStart + sample.stamp, sample.gyro, sample.accel}, topic_);
  }
  void close() override { bag_.close(); }

 private:
  BagWriter bag_;
  std::string topic_;
};

/// Fixed-point numbers by hand: millions of rows in seconds, with a point whatever the locale.
class CsvSink : public Sink {
 public:
  explicit CsvSink(const std::string& path) : path_(path), file_(std::fopen(path.c_str(), "wb")) {
    if (file_ == nullptr) throw std::runtime_error(path + ": cannot be written");
    buffer_ = "t_s,gyro_x [rad/s],gyro_y [rad/s],gyro_z [rad/s],accel_x [m/s^2],accel_y [m/s^2],accel_z [m/s^2]\n";
  }
  ~CsvSink() override {
    if (file_ != nullptr) std::fclose(file_);
  }
  CsvSink(const CsvSink&) = delete;
  CsvSink& operator=(const CsvSink&) = delete;

  void write(const ImuSample& sample) override {
    constexpr int kStampDecimals = 9, kDecimals = 10;
    constexpr double kScale = 1e10, kLargest = 9e8;
    append_fixed(sample.stamp, kStampDecimals);
    for (const Eigen::Vector3d* vector : {&sample.gyro, &sample.accel}) {
      if (!(vector->cwiseAbs().maxCoeff() < kLargest))
        throw std::invalid_argument("the IMU's errors are too large to be written");
      for (int axis = 0; axis < 3; ++axis) {
        buffer_ += ',';
        append_fixed(std::llround(kScale * (*vector)[axis]), kDecimals);
      }
    }
    buffer_ += '\n';
    if (buffer_.size() > kBufferSize) flush();
  }

  void close() override {
    flush();
    const bool good = std::fclose(file_) == 0;
    file_ = nullptr;
    if (!good) throw std::runtime_error(path_ + ": cannot be written");
  }

 private:
  static constexpr std::size_t kBufferSize = 1 << 20;

  /// value / 10^decimals.
  void append_fixed(std::int64_t value, int decimals) {
    char digits[32];
    char* const end = digits + sizeof digits;
    char* at = end;
    std::uint64_t left = value < 0 ? 0 - static_cast<std::uint64_t>(value) : static_cast<std::uint64_t>(value);
    for (int written = 0; left > 0 || written <= decimals; ++written) {
      if (written == decimals) *--at = '.';
      *--at = static_cast<char>('0' + left % 10);
      left /= 10;
    }
    if (value < 0) *--at = '-';
    buffer_.append(at, end);
  }

  void flush() {
    if (std::fwrite(buffer_.data(), 1, buffer_.size(), file_) != buffer_.size())
      throw std::runtime_error(path_ + ": cannot be written");
    buffer_.clear();
  }

  std::string path_;
  std::FILE* file_;
  std::string buffer_;
};

std::unique_ptr<Sink> make_sink(const std::string& extension, const std::string& path, const std::string& topic) {
  if (extension == ".bag") return std::make_unique<BagSink>(path, topic);
  if (extension == ".csv") return std::make_unique<CsvSink>(path);
  throw std::invalid_argument("--out: ends neither in .csv nor in .bag");
}

void simulate(const Options& options) {
  ImuErrorModel model(load_imu(options), options.errors, options.rate, static_cast<std::uint64_t>(options.seed));
  // Under another name until it is whole, so that a run that is cut short does not leave half a log behind.
  const std::string unfinished = options.out + ".part";
  const auto sink = make_sink(std::filesystem::path(options.out).extension().string(), unfinished, options.topic);
  const auto count = static_cast<std::int64_t>(options.hours * 3600.0 * options.rate + 1e-6);
  const Eigen::Vector3d gravity(0, 0, kSimGravity);
  for (std::int64_t k = 0; k < count; ++k) {
    const ImuErrorModel::Errors errors = model.next();
    sink->write({to_ns(static_cast<double>(k) / options.rate), errors.gyro_bias + errors.gyro_white,
                 gravity + errors.accel_bias + errors.accel_white});
  }
  sink->close();
  std::filesystem::rename(unfinished, options.out);
  std::printf("%s: %lld samples at %g Hz\n", options.out.c_str(), static_cast<long long>(count), options.rate);
}

void declare(CLI::App& app, Options& options) {
  app.add_option("--imu", options.imu, "a name in config/imu or a file (default imu/mti600)");
  app.add_option("--param", options.overrides, "key=value over the IMU's configuration; may be given again")
      ->take_all();
  app.add_option("--hours", options.hours, "length of the log [h] (default 6)")->check(CLI::Range(1e-6, 1e3));
  app.add_option("--rate", options.rate, "[Hz] (default 400)")->check(CLI::Range(1e-2, 1e5));
  app.add_option("--seed", options.seed, "of all random numbers (default 1)")->check(CLI::NonNegativeNumber);
  app.add_option("--out", options.out, "F.csv (seconds from 0, rad/s, m/s^2) or F.bag (sensor_msgs/Imu)")->required();
  app.add_option("--topic", options.topic, "in a bag (default /imu/data)");
  app.add_flag("!--no-white-noise", options.errors.white, "leave out the white noise");
  app.add_flag("!--no-bias-walk", options.errors.bias_walk, "leave out the wandering of the biases");
  app.add_flag("!--no-turn-on-bias", options.errors.turn_on, "leave out the constant part of the biases");
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Simulates the log of an IMU at rest, z up: white noise, wandering and turn-on bias of its\n"
      "configuration, as a CSV or a bag.");
  Options options;
  declare(app, options);
  CLI11_PARSE(app, argc, argv);
  try {
    simulate(options);
  } catch (const std::exception& error) {
    std::cerr << "simulate_static: " << error.what() << '\n';
    return 1;
  }
  return 0;
}
