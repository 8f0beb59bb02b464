// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/calib/tuning_text.h"

#include <algorithm>
#include <stdexcept>

#include "allan_lio/calib/noise_grid.h"
#include "allan_lio/io/number_text.h"

namespace allan_lio {
namespace {

std::string trimmed(const std::string& text) {
  const auto begin = text.find_first_not_of(" \t"), end = text.find_last_not_of(" \t");
  return begin == std::string::npos ? "" : text.substr(begin, end - begin + 1);
}

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  for (std::size_t begin = 0, end = 0; end != std::string::npos; begin = end + 1) {
    end = text.find(separator, begin);
    parts.push_back(trimmed(text.substr(begin, end == std::string::npos ? end : end - begin)));
    if (parts.back().empty()) throw std::invalid_argument("'" + text + "': a part of it is empty");
  }
  return parts;
}

double positive_number(const std::string& text, const std::string& whole) {
  double value = 0.0;
  if (!parse_number(text, &value) || !(value > 0.0))
    throw std::invalid_argument("'" + whole + "': '" + text + "' is not a positive number");
  return value;
}

std::vector<double> positive_numbers(const std::string& text, const std::string& whole) {
  std::vector<double> values;
  for (const std::string& part : split(text, ',')) values.push_back(positive_number(part, whole));
  return values;
}

/// The place of "k_gb" of "k_gb=..." among the parameters; `value` gets what stands behind the sign.
std::size_t place_of(const std::string& part, const std::vector<NoiseParameter>& parameters, const std::string& whole,
                     std::string* value) {
  const std::size_t sign = part.find('=');
  if (sign == std::string::npos) throw std::invalid_argument("'" + whole + "': '" + part + "' has no '='");
  *value = part.substr(sign + 1);
  const NoiseParameter parameter = noise_parameter(trimmed(part.substr(0, sign)));
  const auto found = std::find(parameters.begin(), parameters.end(), parameter);
  if (found == parameters.end())
    throw std::invalid_argument("'" + whole + "': " + name_of(parameter) + " is not tuned");
  return static_cast<std::size_t>(found - parameters.begin());
}

}  // namespace

std::vector<std::string> parts_of(const std::string& text) { return split(text, ','); }

std::vector<NoiseParameter> parse_parameters(const std::string& text) {
  std::vector<NoiseParameter> parameters;
  for (const std::string& name : parts_of(text)) parameters.push_back(noise_parameter(name));
  return parameters;
}

std::vector<std::vector<double>> parse_grid(const std::string& text, const std::vector<NoiseParameter>& parameters) {
  if (text == "paper") return {paper_grid()};
  if (text.find('=') == std::string::npos) return {positive_numbers(text, text)};
  std::vector<std::vector<double>> lists(parameters.size());
  for (const std::string& part : split(text, ';')) {
    std::string values;
    std::vector<double>& list = lists[place_of(part, parameters, text, &values)];
    if (!list.empty()) throw std::invalid_argument("'" + text + "': a coefficient has two lists");
    list = positive_numbers(values, text);
  }
  for (std::size_t i = 0; i < lists.size(); ++i)
    if (lists[i].empty()) throw std::invalid_argument("'" + text + "': there is no list for " + name_of(parameters[i]));
  return lists;
}

NoiseSetting parse_start(const std::string& text, const std::vector<NoiseParameter>& tuned, NoiseSetting start) {
  if (text.find('=') == std::string::npos) {
    for (const NoiseParameter parameter : tuned) multiplier(start, parameter) = positive_number(text, text);
    return start;
  }
  for (const std::string& part : split(text, ',')) {
    std::string value;
    const NoiseParameter parameter = tuned[place_of(part, tuned, text, &value)];
    multiplier(start, parameter) = positive_number(trimmed(value), text);
  }
  return start;
}

void parse_box(const std::string& text, NoiseProblem& problem) {
  const std::vector<double> ends = positive_numbers(text, text);
  if (ends.size() != 2) throw std::invalid_argument("'" + text + "': a box is LOW,HIGH");
  problem.lowest_k = ends[0];
  problem.highest_k = ends[1];
}

std::string text_of(const NoiseSetting& setting) {
  std::string text;
  for (const NoiseParameter parameter :
       {NoiseParameter::kKg, NoiseParameter::kKa, NoiseParameter::kKgb, NoiseParameter::kKab, NoiseParameter::kKr})
    text += (text.empty() ? "" : ", ") + std::string(name_of(parameter)) + " " +
            number_text(multiplier(setting, parameter));
  return text;
}

}  // namespace allan_lio
