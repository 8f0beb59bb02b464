// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/calib/trial_problem.h"

#include <sstream>
#include <stdexcept>
#include <utility>

#include "allan_lio/io/config_source.h"
#include "allan_lio/io/content_hash.h"

namespace allan_lio {
namespace {

std::string hex(std::uint64_t bits) {
  std::ostringstream out;
  out << std::hex << bits;
  return out.str();
}

std::string problem_hash(const LioConfig& config, const std::string& build) {
  LioConfig common = with_setting(config, NoiseSetting{});
  common.threads = 1;
  return hash_text(build + print_config(common));
}

}  // namespace

TrialProblem::TrialProblem(std::vector<TuningBag> bags, std::uint64_t seed) : bags_(std::move(bags)), seed_(seed) {
  const std::string build = build_hash();
  for (const TuningBag& bag : bags_) {
    digests_.push_back(bag.record.digest());
    problem_hashes_.push_back(problem_hash(bag.config, build));
  }
}

const TuningBag& TrialProblem::bag_of(const NoiseTrial& trial) const {
  if (trial.bag >= bags_.size())
    throw std::invalid_argument("a trial asks for bag " + std::to_string(trial.bag) + " of " +
                                std::to_string(bags_.size()));
  return bags_[trial.bag];
}

TrialResult TrialProblem::run(const NoiseTrial& trial) const {
  const TuningBag& bag = bag_of(trial);
  try {
    return run_trial(bag.record, digests_[trial.bag], bag.config, trial, seed_);
  } catch (const std::exception& error) {
    throw std::runtime_error(describe(trial) + ": " + error.what());
  }
}

LinearisedTrial TrialProblem::run_linearised(const NoiseTrial& trial) const {
  const TuningBag& bag = bag_of(trial);
  try {
    return allan_lio::run_linearised(bag.record, digests_[trial.bag], bag.config, trial, seed_);
  } catch (const std::exception& error) {
    throw std::runtime_error(describe(trial) + ": " + error.what());
  }
}

TrialKey TrialProblem::key(const NoiseTrial& trial) const {
  bag_of(trial);
  return {problem_hashes_[trial.bag], hex(digests_[trial.bag]), trial.setting, trial.run, seed_};
}

std::string TrialProblem::describe(const NoiseTrial& trial) const {
  const NoiseSetting& s = trial.setting;
  std::ostringstream out;
  out.imbue(std::locale::classic());
  out << bag_of(trial).name << ", run " << trial.run << ", k_g " << s.imu.k_g << ", k_a " << s.imu.k_a << ", k_gb "
      << s.imu.k_gb << ", k_ab " << s.imu.k_ab << ", k_r " << s.k_r;
  return out.str();
}

}  // namespace allan_lio
