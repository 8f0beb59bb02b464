// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <exception>
#include <iostream>
#include <string>

#include "allan_lio/imu/imu_noise.h"
#include "allan_lio/sim/fit_study.h"

namespace {

void print(const std::string& title, const std::vector<allan_lio::CoefficientStudy>& rows) {
  std::printf("%s\n\n| | truth | bias | spread | 95 %% interval holds it | observable |\n", title.c_str());
  std::printf("| --- | --- | --- | --- | --- | --- |\n");
  for (const allan_lio::CoefficientStudy& row : rows) {
    std::printf("| %s | %.4g %s | ", row.name.c_str(), row.truth, row.unit.c_str());
    if (row.truth > 0.0) {
      std::printf("%+.2f %% | %.2f %%", 100.0 * (row.mean / row.truth - 1.0), 100.0 * row.spread / row.truth);
    } else {
      std::printf("%+.2g | %.2g", row.mean, row.spread);
    }
    std::printf(" | %.1f %% | %.0f %% |\n", 100.0 * row.inside / row.records, 100.0 * row.observable / row.records);
  }
  std::printf("\n");
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Simulates static records of known noise, fits each, and prints bias, spread and coverage of the intervals as "
      "Markdown: flicker noise by least squares, a Gauss-Markov bias by least squares and by maximum likelihood.");
  allan_lio::FitStudy study;
  double hours = 6.0, markov_time = 100.0;
  int threads = 2;
  study.truth.white = 1.222e-4;  // 0.42 deg/sqrt(h) in rad/s/sqrt(Hz)
  double level = 3.879e-5;       // 8 deg/h in rad/s
  study.truth.random_walk = 2e-6;
  app.add_option("--records", study.records, "records of each kind")->capture_default_str();
  app.add_option("--hours", hours, "length of a record")->capture_default_str();
  app.add_option("--rate", study.rate, "samples a second [Hz]")->capture_default_str();
  app.add_option("--seed", study.first_seed, "of the first record")->capture_default_str();
  app.add_option("--white", study.truth.white, "N [u/sqrt(Hz)]")->capture_default_str();
  app.add_option("--level", level, "Allan deviation on the flat part [u]")->capture_default_str();
  app.add_option("--random-walk", study.truth.random_walk, "K [u/s/sqrt(Hz)]")->capture_default_str();
  app.add_option("--time", markov_time, "T_b of the Gauss-Markov bias [s]")->capture_default_str();
  app.add_option("--threads", threads)->capture_default_str()->check(CLI::Range(1, 64));
  CLI11_PARSE(app, argc, argv);
  try {
    study.duration = 3600.0 * hours;
    allan_lio::NoiseTerms unit;
    unit.instability = 1.0;
    study.truth.instability = level / std::sqrt(allan_lio::model_allan_variance(unit, 1.0));
    print("Flicker noise, least squares", run_study(study, threads));
    study.truth.instability = 0.0;
    study.truth.markov_sigma = level / std::sqrt(2.0 * allan_lio::gauss_markov_peak_value());
    study.truth.markov_time = markov_time;
    study.markov = true;
    print("Gauss-Markov bias, least squares", run_study(study, threads));
    study.likelihood = true;
    print("Gauss-Markov bias, maximum likelihood", run_study(study, threads));
  } catch (const std::exception& error) {
    std::cerr << "allan_study: " << error.what() << "\n";
    return 2;
  }
  return 0;
}
