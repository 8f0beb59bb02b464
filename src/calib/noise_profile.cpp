// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/calib/noise_profile.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "profile_curve.h"
#include "search_parts.h"

namespace allan_lio {
namespace {

constexpr double kTwoSided = 1.959963984540054;  ///< 97.5 % of the normal distribution

/// Settings asked for in one batch: which curve, at which t.
using Asked = std::vector<std::pair<Eigen::Index, double>>;

void sample(NoiseEvaluator& evaluator, const Asked& asked, const ProfilePath& path, std::vector<ProfileCurve>& curves) {
  std::vector<NoiseSetting> settings;
  for (const auto& [i, t] : asked) settings.push_back(setting_at(evaluator.problem(), path(i, t)));
  const std::vector<std::size_t> places = evaluator.evaluate(settings);
  for (std::size_t n = 0; n < asked.size(); ++n) curves[asked[n].first].add(asked[n].second, places[n]);
}

/// All curves: points evenly over the reach, and then near the ends of the interval.
std::vector<ProfileCurve> sample_curves(NoiseEvaluator& evaluator, std::size_t best, const ProfileOptions& options,
                                        const ProfilePath& path) {
  const NoiseProblem& problem = evaluator.problem();
  const Eigen::VectorXd center = log_point(problem, evaluator.evaluations()[best].setting);
  const double reach = std::log(options.reach);
  std::vector<ProfileCurve> curves;
  Asked asked;
  for (Eigen::Index i = 0; i < center.size(); ++i) {
    const double low = std::max(-reach, lower_logs(problem)[i] - center[i]);
    const double high = std::min(reach, upper_logs(problem)[i] - center[i]);
    curves.emplace_back(best, low, high);
    for (int n = 1; n <= options.points_a_side; ++n) {
      const double share = static_cast<double>(n) / options.points_a_side;
      if (low < 0.0) asked.emplace_back(i, share * low);
      if (high > 0.0) asked.emplace_back(i, share * high);
    }
  }
  sample(evaluator, asked, path, curves);
  const int rounds = is_likelihood(problem.objective) ? options.refinements : 0;
  for (int round = 0; round < rounds; ++round) {
    asked.clear();
    for (Eigen::Index i = 0; i < center.size(); ++i)
      for (const int side : {-1, 1}) {
        const double t = curves[i].crossing(evaluator, side, kProfileLevel);
        if (std::isfinite(t) && !curves[i].has(t)) asked.emplace_back(i, t);
      }
    sample(evaluator, asked, path, curves);
  }
  return curves;
}

/// How far the objective's curvature is measured: to the nearer end of the slice's interval.
Eigen::VectorXd widths_of(const NoiseEvaluator& evaluator, const std::vector<ProfileCurve>& slices) {
  constexpr double kLeast = 0.02, kMost = 1.0;  // of ln k
  Eigen::VectorXd widths(slices.size());
  for (Eigen::Index i = 0; i < widths.size(); ++i) {
    const double low = -slices[i].crossing(evaluator, -1, kProfileLevel);
    const double high = slices[i].crossing(evaluator, 1, kProfileLevel);
    widths[i] = std::min(kMost, std::max(kLeast, std::min(low, high)));
  }
  return widths;
}

/// Where the others' best is, by a parabola of that curvature, while coefficient i moves by one.
Eigen::VectorXd direction_of(const Eigen::MatrixXd& curvature, Eigen::Index i) {
  const Eigen::VectorXd column = curvature.ldlt().solve(Eigen::VectorXd::Unit(curvature.rows(), i));
  return column / column[i];
}

/// The best of the others with coefficient i held, by a search of its own from x.
Eigen::VectorXd reoptimised(NoiseEvaluator& evaluator, const Eigen::VectorXd& x, Eigen::Index held,
                            std::size_t settings) {
  constexpr double kFirstStep = 0.2, kTolerance = 0.01;  // of ln k
  BoxSearch box{lower_logs(evaluator.problem()), upper_logs(evaluator.problem()), kFirstStep, kTolerance,
                static_cast<int>(settings)};
  const auto without = [held](const Eigen::VectorXd& all) {
    Eigen::VectorXd others(all.size() - 1);
    others << all.head(held), all.tail(all.size() - 1 - held);
    return others;
  };
  const auto with = [held, &x](const Eigen::VectorXd& others) {
    Eigen::VectorXd all(x.size());
    all << others.head(held), x[held], others.tail(others.size() - held);
    return all;
  };
  box.low = without(box.low);
  box.high = without(box.high);
  return with(minimise(box, without(x), [&](const Eigen::VectorXd& others) {
    return evaluator.evaluations()[evaluator.evaluate(setting_at(evaluator.problem(), with(others)))].objective;
  }));
}

ProfileVerdict verdict_of(bool bounded_below, bool bounded_above) {
  if (bounded_below && bounded_above) return ProfileVerdict::kTold;
  if (bounded_above) return ProfileVerdict::kOnlyUpperBound;
  return bounded_below ? ProfileVerdict::kOnlyLowerBound : ProfileVerdict::kCannotBeTold;
}

NoiseProfile points_of(const NoiseEvaluator& evaluator, const ProfileCurve& curve, NoiseParameter parameter) {
  NoiseProfile profile;
  profile.parameter = parameter;
  for (const auto& [t, rise] : curve.rises(evaluator)) {
    const std::size_t place = curve.places().at(t);
    profile.points.push_back({multiplier(evaluator.evaluations()[place].setting, parameter), rise, place});
  }
  return profile;
}

/// The verdict on errors against ground truth: by what chance does to the averages.
void judge_ate(const NoiseEvaluator& evaluator, const ProfileCurve& curve, NoiseProfile& profile) {
  constexpr double kRange = 5.0;  // standard errors
  const std::uint32_t runs = evaluator.problem().runs;
  if (runs < 2) {
    profile.verdict = ProfileVerdict::kNotJudged;
    return;
  }
  double variance = 0.0, rise_below = 0.0, rise_above = 0.0;
  for (const auto& [t, rise] : curve.rises(evaluator)) {
    const double deviation = evaluator.evaluations()[curve.places().at(t)].run_deviation;
    variance += deviation * deviation / static_cast<double>(curve.places().size());
    if (t < 0.0) rise_below = std::max(rise_below, rise);
    if (t > 0.0) rise_above = std::max(rise_above, rise);
  }
  const double chance = kRange * std::sqrt(variance / runs);
  profile.verdict = verdict_of(rise_below > chance, rise_above > chance);
}

/// The interval and the verdict by the likelihood. `deviation` is 1 sigma of ln k by the curvature.
void judge_nll(const NoiseEvaluator& evaluator, const ProfileCurve& curve, double k, double deviation,
               NoiseProfile& profile) {
  profile.low = k * std::exp(curve.crossing(evaluator, -1, kProfileLevel));
  profile.high = k * std::exp(curve.crossing(evaluator, 1, kProfileLevel));
  profile.curvature_low = k * std::exp(-kTwoSided * deviation);
  profile.curvature_high = k * std::exp(kTwoSided * deviation);
  profile.verdict = verdict_of(profile.low > 0.0, std::isfinite(profile.high));
}

void check_options(const ProfileOptions& options) {
  if (!(options.reach > 1.0) || options.points_a_side < 1)
    throw std::invalid_argument("profile: needs a reach above 1 and a point on either side");
}

}  // namespace

std::vector<NoiseProfile> profile_noise(NoiseEvaluator& evaluator, std::size_t best, const ProfileOptions& options) {
  check_options(options);
  const NoiseProblem& problem = evaluator.problem();
  const Eigen::VectorXd center = log_point(problem, evaluator.evaluations()[best].setting);
  const bool likelihood = is_likelihood(problem.objective);
  std::vector<ProfileCurve> curves = sample_curves(evaluator, best, options, [&](Eigen::Index i, double t) {
    return Eigen::VectorXd(center + t * Eigen::VectorXd::Unit(center.size(), i));
  });
  Eigen::VectorXd deviations = Eigen::VectorXd::Zero(center.size());
  if (likelihood) {
    const double least = 1.0 / (problem.prior_sigma * problem.prior_sigma);  // the prior's own
    const Eigen::MatrixXd curvature = curvature_at(evaluator, best, widths_of(evaluator, curves), least);
    deviations = curvature.inverse().diagonal().cwiseSqrt();
    if (options.kind != ProfileKind::kSlice && center.size() > 1)
      curves = sample_curves(evaluator, best, options, [&](Eigen::Index i, double t) {
        const Eigen::VectorXd there = center + t * direction_of(curvature, i);
        return options.kind == ProfileKind::kFollowed ? there
                                                      : reoptimised(evaluator, there, i, options.settings_a_point);
      });
  }
  std::vector<NoiseProfile> profiles;
  for (std::size_t i = 0; i < curves.size(); ++i) {
    const NoiseParameter parameter = problem.tuned[i];
    profiles.push_back(points_of(evaluator, curves[i], parameter));
    const double k = multiplier(evaluator.evaluations()[best].setting, parameter);
    if (likelihood)
      judge_nll(evaluator, curves[i], k, deviations[static_cast<Eigen::Index>(i)], profiles.back());
    else
      judge_ate(evaluator, curves[i], profiles.back());
  }
  return profiles;
}

}  // namespace allan_lio
