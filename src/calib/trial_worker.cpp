// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/calib/trial_worker.h"

#include <cstdlib>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <stdexcept>
#include <utility>

#include "allan_lio/calib/tuning_text.h"
#include "allan_lio/io/config_source.h"
#include "allan_lio/io/content_hash.h"
#include "allan_lio/io/run_program.h"
#include "allan_lio/io/trial_files.h"
#include "allan_lio/io/whole_file.h"
#include "allan_lio/io/yaml_quoted.h"
#include "allan_lio/io/yaml_source.h"

namespace allan_lio {
namespace {

const std::string& scalar(const ConfigSource& source, const std::string& key, const std::string& file) {
  const auto found = source.find(key);
  if (found == source.end() || found->second.items.size() != 1)
    throw std::runtime_error(file + ": has no value of '" + key + "'");
  return found->second.items[0];
}

/// The same for the same trial, to the bit.
std::string identity_of(const NoiseTrial& trial) {
  return std::to_string(trial.bag) + " " + std::to_string(trial.run) + " " + text_of(trial.setting);
}

/// Without the records of the bags that no trial asks for: a task of a large problem needs few of them.
TrialProblem read_problem(const std::string& file, const std::set<std::uint32_t>& wanted) {
  const ConfigSource source = load_yaml(file, {});
  if (scalar(source, "build", file) != build_hash())
    throw std::runtime_error(file + ": was written by another build of the program than runs on this machine");
  const std::string directory = std::filesystem::path(file).parent_path().string() + "/";
  const std::uint64_t count = std::strtoull(scalar(source, "bags", file).c_str(), nullptr, 10);
  std::vector<TuningBag> bags(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::string key = "bag_" + std::to_string(i) + "/";
    bags[i].name = scalar(source, key + "name", file);
    bags[i].config = read_config(load_yaml(directory + scalar(source, key + "config", file), {}));
    if (wanted.count(i) > 0) bags[i].record = PreparedRecord::load(directory + scalar(source, key + "record", file));
  }
  return TrialProblem(std::move(bags), std::strtoull(scalar(source, "seed", file).c_str(), nullptr, 10));
}

}  // namespace

std::string write_worker_problem(const std::string& directory, const TrialProblem& problem) {
  std::error_code failure;
  std::filesystem::create_directories(directory, failure);
  if (failure) throw std::runtime_error(directory + ": cannot be made: " + failure.message());
  std::string text = "build: \"" + build_hash() + "\"\nseed: " + std::to_string(problem.seed()) +
                     "\nbags: " + std::to_string(problem.bags().size()) + "\n";
  for (std::uint32_t i = 0; i < problem.bags().size(); ++i) {
    const TuningBag& bag = problem.bags()[i];
    const std::string parameters = print_config(bag.config), config = "config_" + hash_text(parameters) + ".yaml";
    const std::string record = "record_" + problem.key({i, {}, 0}).bag + ".bin";
    write_whole(directory + "/" + config, parameters);
    if (!std::filesystem::exists(directory + "/" + record)) bag.record.save(directory + "/" + record);
    text += "bag_" + std::to_string(i) + ": {name: " + yaml_quoted(bag.name) + ", config: " + config +
            ", record: " + record + "}\n";
  }
  const std::string file = directory + "/problem_" + hash_text(text) + ".yaml";
  write_whole(file, text);
  return file;
}

void run_worker(const std::string& problem, const std::string& trials, const std::string& results,
                const std::string& linear_runs) {
  const std::vector<NoiseTrial> asked = read_trials(trials);
  std::set<std::uint32_t> bags;
  for (const NoiseTrial& trial : asked) bags.insert(trial.bag);
  const TrialProblem known = read_problem(problem, bags);
  std::vector<TrialResult> found;
  std::optional<LinearRunFiles> files;
  if (!linear_runs.empty()) files.emplace(known, linear_runs);
  for (const NoiseTrial& trial : asked) found.push_back(files ? files->get(trial).result : known.run(trial));
  write_results(results, found);
}

namespace {

TrialEngine slurm_trials(const TrialProblem& problem, SlurmOptions options, const std::string& program,
                         const std::string& more_arguments) {
  options.worker = shell_quoted(program) + " --worker " +
                   shell_quoted(write_worker_problem(options.directory, problem)) +
                   " --trials \"$TRIALS\" --results \"$RESULTS\"" + more_arguments;
  make_slurm_engine(options);  // throws now if the options make no sense
  return [options](const std::vector<NoiseTrial>& trials, const OnTrial& on_trial) {
    std::map<std::string, std::size_t> places;
    for (std::size_t i = 0; i < trials.size(); ++i) places[identity_of(trials[i])] = i;
    std::size_t done = 0;
    SlurmOptions batch = options;
    batch.on_result = [&](const NoiseTrial& trial, const TrialResult& result) {
      ++done;
      if (on_trial) on_trial(places.at(identity_of(trial)), result);
    };
    try {
      return make_slurm_engine(batch)(trials);
    } catch (const SlurmStopped&) {
      throw TrialsStopped(done, trials.size());
    }
  };
}

}  // namespace

TrialEngine make_slurm_trials(const TrialProblem& problem, SlurmOptions options, const std::string& program) {
  return slurm_trials(problem, std::move(options), program, "");
}

LinearEngine make_slurm_linear_engine(const TrialProblem& problem, SlurmOptions options, const std::string& program) {
  auto files = std::make_shared<const LinearRunFiles>(problem, options.directory + "/linear");
  options.trials_per_task = 1;  // they are few and far between
  return {files,
          slurm_trials(problem, std::move(options), program, " --linear-runs " + shell_quoted(files->directory()))};
}

}  // namespace allan_lio
