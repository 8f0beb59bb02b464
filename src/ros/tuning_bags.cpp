// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/ros/tuning_bags.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "allan_lio/calib/noise_trial_run.h"
#include "allan_lio/calib/trial_pool.h"
#include "allan_lio/calib/tuning_text.h"
#include "allan_lio/io/config_source.h"
#include "allan_lio/io/content_hash.h"
#include "allan_lio/io/run_program.h"
#include "allan_lio/io/yaml_source.h"
#include "allan_lio/ros/config_dirs.h"
#include "allan_lio/ros/prepared_bag.h"
#include "allan_lio/ros/program_files.h"

namespace allan_lio {
namespace {

namespace fs = std::filesystem;

constexpr double kFreeDisk = 3e9;  // [bytes] that a simulated bag may take

bool stopped(const PreparationOptions& options) { return options.stop != nullptr && *options.stop; }

/// One line of scripts/bench --list.
void take_line(const std::string& key, const std::string& value, std::vector<TuningSource>& sources,
               std::vector<ConfigChoice>& choices) {
  if (key == "bag") {
    sources.emplace_back();
    choices.emplace_back();
    sources.back().name = value;
  } else if (!sources.empty() && key == "config") {
    choices.back().name = value;
  } else if (!sources.empty() && key == "param") {
    choices.back().overrides.push_back(value);
  } else if (!sources.empty() && key == "argument") {
    sources.back().simulation.push_back(value);
  } else {
    throw std::runtime_error("scripts/bench --list: the line '" + key + "' is not understood");
  }
}

void hash_file(const fs::path& path, std::string& hashes) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream bytes;
  bytes << in.rdbuf();
  hashes += hash_text(bytes.str());
}

/// Of the simulator's words and build and of the configuration that the bag is read with.
std::string identity_of(const TuningSource& source, const std::string& simulator) {
  std::string text = build_hash() + print_config(with_setting(source.config, {}));
  for (const std::string& word : source.simulation) text += word + '\n';
  hash_file(simulator, text);
  std::vector<fs::path> libraries;
  for (const auto& entry : fs::directory_iterator(fs::path(simulator).parent_path().parent_path()))
    if (entry.path().filename().string().rfind("liballan_lio_", 0) == 0) libraries.push_back(entry.path());
  std::sort(libraries.begin(), libraries.end());
  for (const fs::path& library : libraries) hash_file(library, text);
  return hash_text(text);
}

TuningBag read_bag(const TuningSource& source, const PreparationOptions& options) {
  try {
    PreparedBag bag = prepare_bag(source.files, source.config, source.reference, [&](double part) {
      if (options.on_progress) options.on_progress("reading " + source.name, part);
      return !stopped(options);
    });
    if (options.on_note)
      for (const std::string& note : bag.notes) options.on_note(source.name + ": " + note);
    return {source.name, source.config, std::move(bag.record)};
  } catch (const std::runtime_error&) {
    if (stopped(options)) throw TrialsStopped(0, 0);
    throw;
  }
}

/// The files that simulate_bag writes for one bag, removed when they have been read.
class SimulatedFiles {
 public:
  SimulatedFiles(std::string directory, std::string stem) : directory_(std::move(directory)), stem_(std::move(stem)) {}
  ~SimulatedFiles() {
    std::error_code ignored;
    std::vector<fs::path> ours;
    for (const auto& entry : fs::directory_iterator(directory_, ignored))
      if (entry.path().filename().string().rfind(stem_, 0) == 0) ours.push_back(entry.path());
    for (const fs::path& path : ours) fs::remove(path, ignored);
  }
  SimulatedFiles(const SimulatedFiles&) = delete;
  SimulatedFiles& operator=(const SimulatedFiles&) = delete;
  std::string file(const char* ending) const { return directory_ + "/" + stem_ + ending; }

 private:
  std::string directory_, stem_;
};

TuningBag simulate(TuningSource source, const PreparationOptions& options) {
  const std::string simulator = sibling_program("simulate_bag"), identity = identity_of(source, simulator);
  const std::string record = options.records + "/" + source.name + "_" + identity + ".bin";
  if (fs::exists(record)) return {source.name, source.config, PreparedRecord::load(record)};
  fs::create_directories(options.records);
  if (static_cast<double>(fs::space(options.records).available) < kFreeDisk)
    throw std::runtime_error(options.records + ": less than 3 GB are free, which a simulated bag may take");
  const SimulatedFiles files(options.records, "making_" + source.name + "_" + identity);
  source.files = {files.file(".bag")};
  source.reference = files.file(".tum");
  if (options.on_progress) options.on_progress("simulating " + source.name, 0.0);
  std::vector<std::string> words = {simulator};
  words.insert(words.end(), source.simulation.begin(), source.simulation.end());
  words.insert(words.end(), {"--out", source.files[0]});
  const ProgramOutcome outcome = run_program(words, options.stop);
  if (stopped(options)) throw TrialsStopped(0, 0);
  if (outcome.status != 0) throw std::runtime_error(source.name + ": simulate_bag failed: " + outcome.errors);
  TuningBag bag = read_bag(source, options);
  bag.record.save(record);
  return bag;
}

}  // namespace

TuningSource bag_source(const std::string& files, const std::string& reference, const LioConfig& config) {
  TuningSource source;
  source.files = parts_of(files);
  source.name = fs::path(source.files[0]).filename().string();
  source.reference = reference;
  source.config = config;
  return source;
}

LioConfig read_choice(const ConfigChoice& choice) {
  ConfigSource source = load_yaml(choice.name, config_search_dirs());
  for (const std::string& text : choice.overrides) source = merge(source, parse_override(text));
  return read_config(source);
}

std::vector<TuningSource> suite_sources(const std::string& suite, const std::string& seeds, const std::string& only,
                                        const ConfigChoice& choice) {
  std::vector<std::string> words = {package_script("bench"), "--list", "--suite", suite, "--seeds", seeds};
  if (!only.empty()) words.insert(words.end(), {"--only", only});
  const ProgramOutcome outcome = run_program(words);
  if (outcome.status != 0)
    throw std::invalid_argument("--suite: " + outcome.errors.substr(0, outcome.errors.find_last_not_of('\n') + 1));
  std::vector<TuningSource> sources;
  std::vector<ConfigChoice> choices;
  std::istringstream lines(outcome.output);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t tab = std::min(line.find('\t'), line.size());
    take_line(line.substr(0, tab), line.substr(std::min(tab + 1, line.size())), sources, choices);
  }
  for (std::size_t i = 0; i < sources.size(); ++i) {
    if (!choice.name.empty()) choices[i].name = choice.name;
    choices[i].overrides.insert(choices[i].overrides.end(), choice.overrides.begin(), choice.overrides.end());
    sources[i].config = read_choice(choices[i]);
  }
  return sources;
}

TuningBag prepare(const TuningSource& source, const PreparationOptions& options) {
  if (stopped(options)) throw TrialsStopped(0, 0);
  return source.simulation.empty() ? read_bag(source, options) : simulate(source, options);
}

}  // namespace allan_lio
