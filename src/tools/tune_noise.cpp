// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>
#include <Eigen/Core>
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <thread>

#include "allan_lio/calib/trial_worker.h"
#include "allan_lio/calib/tuning_arguments.h"
#include "allan_lio/calib/tuning_summary.h"
#include "allan_lio/calib/tuning_text.h"
#include "allan_lio/io/config_source.h"
#include "allan_lio/io/content_hash.h"
#include "allan_lio/io/number_text.h"
#include "allan_lio/io/run_program.h"
#include "allan_lio/io/whole_file.h"
#include "allan_lio/ros/program_files.h"
#include "allan_lio/ros/stop_signals.h"
#include "allan_lio/ros/tuning_bags.h"
#include "allan_lio/ros/tuning_progress.h"

namespace {

using namespace allan_lio;

constexpr int kBadUse = 2, kFailed = 1, kInterrupted = 130;

void declare_bags(CLI::App& app, TuningArguments& a) {
  app.add_option("--bag", a.bags, "recording to tune on; give more for more; commas part the files of one recording");
  app.add_option("--reference", a.references, "ground truth, a TUM file with the IMU's poses; one for each --bag");
  app.add_option("--hold-out", a.hold_out, "recording that is scored and not tuned on; may be given again");
  app.add_option("--hold-out-reference", a.hold_out_references, "its ground truth; one for each --hold-out");
  app.add_option("--suite", a.suite, "instead of bags: a file of config/suites, whose bags are simulated with truth");
  app.add_option("--seeds", a.seeds, "of the suite, e.g. 1,2,101-105 (default 1)");
  app.add_option("--hold-out-seeds", a.hold_out_seeds, "the suite with these seeds is scored and not tuned on");
  app.add_option("--only", a.only, "sequences of the suite, parted by commas");
  app.add_option("--config", a.config, "name in config/ or config/robots/, or a YAML file (--suite: its own)");
  app.add_option("--param", a.overrides, "key=value over the configuration; may be given again")->take_all();
  app.add_option("--out", a.out, "directory of the results; what lies there from an interrupted run is gone on with");
  app.add_option("--records", a.records, "directory of the suite's prepared records (default OUT/records)");
}

void declare_search(CLI::App& app, TuningArguments& a) {
  app.add_option("--params", a.parameters, "the coefficients to tune, of k_g,k_a,k_gb,k_ab,k_r");
  app.add_option("--search", a.search, "grid, sequential, likelihood or bayes (default likelihood)")
      ->check(CLI::IsMember({"grid", "sequential", "likelihood", "bayes"}));
  app.add_option("--objective", a.objective,
                 "ate: error against ground truth; without one, the negative log-likelihood nll of what the IMU alone "
                 "predicts over 3 to 30 s, or scan_nll of the innovations from scan to scan, which tells k_r (default: "
                 "ate for grid and sequential, and for bayes with truth, else nll)")
      ->check(CLI::IsMember({"ate", "nll", "scan_nll"}));
  app.add_option("--runs", a.runs, "of each bag and setting; from the second on start, thinning and losses vary")
      ->check(CLI::Range(1, 10000));
  app.add_option("--seed", a.seed, "of the runs' variations and of --search bayes (default 1)");
  app.add_option("--grid", a.grid, "values to try: 1,10,50 for all, or k_gb=1,10;k_ab=1,3, or paper");
  app.add_option("--order", a.order, "of --search sequential (default, the paper's: k_a,k_g,k_ab,k_gb,k_r)");
  app.add_option("--start", a.start, "3 for all, or k_gb=10,k_ab=3 (default: the configuration's)");
  app.add_option("--box", a.box, "LOW,HIGH of every tuned coefficient (default 0.01,1000)");
  app.add_option("--prior-sigma", a.prior_sigma, "of ln k about k = 1, without ground truth (default ln 10)")
      ->check(CLI::PositiveNumber);
  app.add_option("--nll-scale", a.nll_scale, "independent errors over their number (default auto: measured)");
  app.add_option("--budget", a.budget, "settings that likelihood (150) or bayes (40) may try")
      ->check(CLI::Range(1, 100000));
  app.add_flag("--rerun", a.rerun,
               "likelihood: run the filter anew with every setting (a hundred), instead of a few times and judging "
               "settings by the linear filter of those runs");
  app.add_option("--profile", a.profile,
                 "slice, followed or reoptimised (nll), or none (default: followed, ate: slice)")
      ->check(CLI::IsMember({"slice", "followed", "reoptimised", "none"}));
}

void declare_engine(CLI::App& app, TuningArguments& a) {
  app.add_option("--jobs", a.jobs, "runs at a time on this machine (default: all processors)")
      ->check(CLI::Range(1, 1024));
  app.add_option("--engine", a.engine, "local, or slurm: array jobs (default local)")
      ->check(CLI::IsMember({"local", "slurm"}));
  app.add_option("--slurm-directory", a.slurm_directory, "seen by the nodes under the same path (default OUT/slurm)");
  app.add_option("--slurm-arg", a.slurm_arguments, "argument for sbatch, e.g. --slurm-arg=--partition=long")
      ->take_all();
  app.add_option("--slurm-poll", a.slurm_poll, "time between looks at the queue [s] (default 2)")
      ->check(CLI::PositiveNumber);
  // What a Slurm task is called with.
  app.add_option("--worker", a.worker, "")->group("");
  app.add_option("--trials", a.trials, "")->group("");
  app.add_option("--results", a.results, "")->group("");
  app.add_option("--linear-runs", a.linear_runs, "")->group("");
}

/// All bags, those tuned on first.
struct Bags {
  std::vector<TuningSource> sources;
  std::uint32_t tuned_on = 0;
};

Bags find_bags(const TuningArguments& a) {
  Bags bags;
  const ConfigChoice choice{a.config, a.overrides};
  const auto add = [&](std::vector<TuningSource> more) {
    bags.sources.insert(bags.sources.end(), more.begin(), more.end());
  };
  if (!a.suite.empty()) {
    add(suite_sources(a.suite, a.seeds, a.only, choice));
  } else {
    const LioConfig config = read_choice(choice);
    for (std::size_t i = 0; i < a.bags.size(); ++i)
      bags.sources.push_back(bag_source(a.bags[i], a.references.empty() ? "" : a.references[i], config));
  }
  bags.tuned_on = static_cast<std::uint32_t>(bags.sources.size());
  if (!a.hold_out_seeds.empty()) add(suite_sources(a.suite, a.hold_out_seeds, a.only, choice));
  for (std::size_t i = 0; i < a.hold_out.size(); ++i)
    bags.sources.push_back(
        bag_source(a.hold_out[i], a.hold_out_references.empty() ? "" : a.hold_out_references[i], read_choice(choice)));
  return bags;
}

/// The noise of the configurations, which must be one.
NoiseSetting configured_noise(const std::vector<TuningSource>& sources) {
  const auto noise_of = [](const LioConfig& config) { return NoiseSetting{config.imu.scale, config.lidar.k_r}; };
  const NoiseSetting first = noise_of(sources[0].config);
  for (const TuningSource& source : sources)
    if (!same_setting(noise_of(source.config), first))
      throw ConfigError("the configurations of " + sources[0].name + " and " + source.name +
                        " have other multipliers: " + text_of(first) + " and " + text_of(noise_of(source.config)));
  return first;
}

TrialProblem prepare_all(const Bags& bags, const TuningArguments& a, const std::atomic<bool>& stop,
                         TuningProgress& progress) {
  PreparationOptions options;
  options.records = a.records.empty() ? a.out + "/records" : a.records;
  options.stop = &stop;
  options.on_progress = [&](const std::string& what, double part) { progress.part(what, part); };
  options.on_note = [&](const std::string& note) { progress.note(note); };
  std::vector<TuningBag> prepared;
  for (const TuningSource& source : bags.sources) prepared.push_back(prepare(source, options));
  progress.clear();
  return TrialProblem(std::move(prepared), a.seed);
}

TuningReport report_of(const TuningArguments& a, const Bags& bags, const TrialProblem& problem,
                       const std::string& command) {
  TuningReport report;
  report.config = a.config.empty() ? a.suite : a.config;
  report.command = command;
  report.seed = a.seed;
  report.search = search_of(a);
  report.versions = {{"allan_lio", ALLAN_LIO_VERSION},
                     {"compiler", __VERSION__},
                     {"Eigen", std::to_string(EIGEN_WORLD_VERSION) + "." + std::to_string(EIGEN_MAJOR_VERSION) + "." +
                                   std::to_string(EIGEN_MINOR_VERSION)}};
  report.hashes.emplace_back("build", build_hash());
  for (std::uint32_t i = 0; i < bags.sources.size(); ++i) {
    const TuningSource& source = bags.sources[i];
    (i < bags.tuned_on ? report.bags : report.hold_out).emplace_back(source.name, problem.key({i, {}, 0}).bag);
    report.hashes.emplace_back("configuration of " + source.name, config_hash(source.config));
  }
  return report;
}

SlurmOptions slurm_of(const TuningArguments& a, const std::atomic<bool>& stop) {
  SlurmOptions options;
  options.directory =
      std::filesystem::absolute(a.slurm_directory.empty() ? a.out + "/slurm" : a.slurm_directory).string();
  options.sbatch_arguments = a.slurm_arguments;
  options.poll_interval = a.slurm_poll;
  options.stop = &stop;
  return options;
}

TrialEngine engine_of(const TuningArguments& a, const TrialProblem& problem, const std::atomic<bool>& stop) {
  if (a.engine == "local") return make_trial_pool(problem, a.jobs, &stop);
  return make_slurm_trials(problem, slurm_of(a, stop), sibling_program("tune_noise"));
}

LinearEngine linear_engine_of(const TuningArguments& a, const TrialProblem& problem, const std::atomic<bool>& stop) {
  if (a.engine == "local") return make_linear_engine(problem, a.out + "/linear", a.jobs, &stop);
  return make_slurm_linear_engine(problem, slurm_of(a, stop), sibling_program("tune_noise"));
}

void require_truth(const TuningArguments& a, const TrialProblem& problem, std::uint32_t tuned_on) {
  for (std::uint32_t i = 0; i < tuned_on && objective_of(a) == TuningObjective::kAte; ++i)
    if (problem.bags()[i].record.reference().empty())
      throw std::invalid_argument("the objective ate needs the ground truth of " + problem.bags()[i].name +
                                  " (--reference); without it take --objective nll");
}

void write_report(const std::string& directory) {
  const ProgramOutcome outcome = run_program({package_script("tune_report"), directory});
  if (outcome.status != 0) throw std::runtime_error("the report was not written, all else is there: " + outcome.errors);
}

int run(const TuningArguments& a, const std::string& command) {
  const StopSignals stop;
  check_arguments(a);
  const Bags bags = find_bags(a);
  SessionSettings settings;
  settings.report.before = configured_noise(bags.sources);
  settings.problem = problem_of(a, settings.report.before, bags.tuned_on);
  settings.plan = plan_of(a, settings.problem);
  for (auto i = bags.tuned_on; i < bags.sources.size(); ++i) settings.held_out.push_back(i);
  std::filesystem::create_directories(a.out);
  settings.directory = a.out;
  settings.jobs = a.jobs;
  settings.estimate_nll_scale = a.nll_scale == "auto";
  TrialStore store(a.out + "/trials.sqlite");
  TuningProgress progress(settings.problem.runs * bags.tuned_on);
  const TrialProblem problem = prepare_all(bags, a, stop.flag(), progress);
  require_truth(a, problem, bags.tuned_on);
  if (is_linear(settings)) settings.linear = linear_engine_of(a, problem, stop.flag());
  const NoiseSetting before = settings.report.before;
  settings.report = report_of(a, bags, problem, command);
  settings.report.before = before;
  TuningSession session(settings, problem, engine_of(a, problem, stop.flag()), &store, &stop.flag(),
                        [&](const FinishedTrial& finished) { progress.trial(finished); });
  try {
    session.run([&](const std::string& phase, std::size_t count) { progress.phase(phase, count); });
  } catch (const std::exception& error) {
    progress.clear();
    session.write_what_there_is(stop.flag() ? "interrupted" : std::string("ended by an error: ") + error.what());
    throw;
  }
  progress.clear();
  std::cout << summary_of(session) << std::flush;
  write_report(a.out);
  std::cout << "\nresults: " << a.out << "/report.html, best.yaml, tuning.yaml, trials.csv\n";
  return every_run_diverges(session.settings().report.comparisons, bags.tuned_on) ? kFailed : 0;
}

std::string command_line(int argc, char** argv) {
  std::string line;
  for (int i = 0; i < argc; ++i) {
    const std::string word = i == 0 ? "tune_noise" : argv[i];
    const bool plain = !word.empty() && word.find_first_of(" \t\n'\"\\$`;&|<>()*?[]#~!{}") == std::string::npos;
    line += (i == 0 ? "" : " ") + (plain ? word : shell_quoted(word));
  }
  return line;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{
      "Finds the multipliers k of the IMU's and the LiDAR's noise, on bags with ground truth or without.\n"
      "Exit status: 0; 1 for a failure, or if every run diverges; 2 for bad use; 130 if it was interrupted, and the "
      "same command goes on from there."};
  TuningArguments arguments;
  declare_bags(app, arguments);
  declare_search(app, arguments);
  declare_engine(app, arguments);
  try {
    app.parse(argc, argv);
    if (!arguments.worker.empty()) {
      run_worker(arguments.worker, arguments.trials, arguments.results, arguments.linear_runs);
      return 0;
    }
    if (arguments.jobs == 0) arguments.jobs = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
    if (arguments.seeds.empty() && !arguments.suite.empty()) arguments.seeds = "1";
    return run(arguments, command_line(argc, argv));
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);
    std::cerr << "tune_noise: " << error.what() << '\n';
    return kBadUse;
  } catch (const ConfigError& error) {
    std::cerr << "tune_noise: " << error.what() << '\n';
    return kBadUse;
  } catch (const std::invalid_argument& error) {
    std::cerr << "tune_noise: " << error.what() << '\n';
    return kBadUse;
  } catch (const TrialsStopped&) {
    std::cerr << "tune_noise: interrupted; what was computed is kept, and the same command goes on from there\n";
    return kInterrupted;
  } catch (const std::exception& error) {
    std::cerr << "tune_noise: " << error.what() << '\n';
    return kFailed;
  }
}
