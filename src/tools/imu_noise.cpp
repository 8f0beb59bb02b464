// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "allan_lio/io/imu_yaml.h"
#include "allan_lio/io/noise_lint.h"
#include "allan_lio/io/noise_text.h"
#include "allan_lio/io/yaml_source.h"
#include "allan_lio/ros/config_dirs.h"

namespace {

namespace fs = std::filesystem;
using allan_lio::NoiseFile;
using allan_lio::NoiseFormat;

constexpr int kFine = 0, kSuspicious = 1, kUnreadable = 2;

struct Options {
  std::string in, out = "-", from = "auto", to, against;
  double rate = 0.0, bias_time = 0.0;
};

std::string contents_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  if (file) text << file.rdbuf();
  if (!file || fs::is_directory(path)) throw std::runtime_error(path + ": cannot be read");
  return text.str();
}

/// A file, or one of our own configurations by its name ("imu/mti600").
NoiseFile load(const Options& options) {
  const std::string& in = options.in;
  NoiseFile file;
  const bool is_name = !fs::exists(in) && (options.from == "auto" || options.from == "allan_lio");
  const std::string text = is_name ? "" : contents_of(in);
  NoiseFormat format = NoiseFormat::kAllanLio;
  if (options.from != "auto") {
    format = allan_lio::noise_format_by_name(options.from);
  } else if (!is_name) {
    format = allan_lio::detect_noise_format(text, in);
  }
  if (format != NoiseFormat::kAllanLio) return allan_lio::read_noise_file(text, in, format, options.rate);
  file = allan_lio::read_noise_config(allan_lio::load_yaml(in, allan_lio::config_search_dirs()), in);
  file.rate = options.rate;
  return file;
}

/// Under another name until it is whole.
void write(const std::string& path, const std::string& text) {
  const bool replace = !fs::exists(path) || fs::is_regular_file(path);  // not a pipe or a device
  const std::string unfinished = replace ? path + ".part" : path;
  std::ofstream out(unfinished, std::ios::binary);
  out << text;
  out.close();
  std::error_code failed;
  if (out && replace) fs::rename(unfinished, path, failed);
  if (out && !failed) return;
  std::error_code ignored;
  if (replace) fs::remove(unfinished, ignored);
  throw std::runtime_error(path + ": cannot be written");
}

int convert(const Options& options) {
  const NoiseFormat to = allan_lio::noise_format_by_name(options.to);
  const NoiseFile file = load(options);
  std::vector<std::string> notes = file.notes;
  std::string text;
  try {
    text = allan_lio::write_noise(file.spec, to, {file.rate, options.bias_time}, &notes);
  } catch (const std::exception& error) {
    throw std::runtime_error(options.in + ": " + error.what());
  }
  if (options.out == "-") {
    std::cout << text;
  } else {
    write(options.out, text);
  }
  for (const std::string& note : notes) std::cerr << "note: " << note << '\n';
  return kFine;
}

int lint(const Options& options) {
  std::vector<allan_lio::KnownImu> known = allan_lio::load_known_imus(allan_lio::config_search_dirs());
  const auto same = [&options](const allan_lio::KnownImu& imu) { return imu.name == options.against; };
  if (!options.against.empty() && std::none_of(known.begin(), known.end(), same)) {
    Options other;
    other.in = options.against;
    other.rate = options.rate;
    known.push_back({options.against, load(other).spec});
  }
  const allan_lio::LintReport report = allan_lio::lint_noise(load(options), known, options.against);
  std::cout << options.in << '\n' << allan_lio::lint_text(report);
  return report.suspicious() ? kSuspicious : kFine;
}

int show(const Options& options) {
  std::cout << options.in << '\n' << allan_lio::show_text(load(options), options.bias_time);
  return kFine;
}

std::string format_help() {
  std::string text;
  for (const std::string& name : allan_lio::noise_format_names()) text += (text.empty() ? "" : ", ") + name;
  return text;
}

void declare_input(CLI::App& app, Options& options) {
  app.add_option("file", options.in, "the file; of our own also a name in config/, such as imu/mti600")->required();
  app.add_option("--from", options.from, "its format: auto (default), " + format_help());
  app.add_option("--rate", options.rate, "of the IMU [Hz]; goes before what the file says")
      ->check(CLI::Range(1e-3, 1e6));
}

void declare_bias_time(CLI::App& app, Options& options) {
  app.add_option("--bias-time", options.bias_time,
                 "T_b where the file has none: the averaging time of the flat part over 1.8926 [s]")
      ->check(CLI::Range(1e-6, 1e9));
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Reads, compares and converts the noise of an IMU in the files of this and of other packages.");
  app.require_subcommand(1);
  Options options;
  CLI::App* to_other = app.add_subcommand("convert", "Writes the same noise as a file of another package");
  declare_input(*to_other, options);
  declare_bias_time(*to_other, options);
  to_other->add_option("--to", options.to, "the format to write: " + format_help())->required();
  to_other->add_option("out", options.out, "file to write; - (default): standard output");
  CLI::App* check = app.add_subcommand(
      "lint",
      "Tells each figure in SI, in data-sheet units and as the k against known IMUs, and names known slips.\n"
      "Exit status: 0 fine, 1 suspicious, 2 unreadable");
  declare_input(*check, options);
  check->add_option("--against", options.against, "IMU to tell the k's of: a name such as imu/mti600, or a file");
  CLI::App* print =
      app.add_subcommand("show", "Tells the noise in all four ways: Allan, random walk, Gauss-Markov, samples");
  declare_input(*print, options);
  declare_bias_time(*print, options);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);
    std::cerr << "imu_noise: " << error.what() << '\n';
    return kUnreadable;
  }
  try {
    const int status = to_other->parsed() ? convert(options) : check->parsed() ? lint(options) : show(options);
    std::cout.flush();
    if (!std::cout) throw std::runtime_error("standard output: cannot be written");
    return status;
  } catch (const std::exception& error) {
    std::cerr << "imu_noise: " << error.what() << '\n';
    return kUnreadable;
  }
}
