// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/io/imu_csv_columns.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace allan_lio {
namespace {

/// A column's name taken apart: lower-case words, and the text in brackets.
struct Name {
  std::vector<std::string> words;
  std::string joined;  ///< the words in a row
  std::string unit;
};

bool is_word(char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9'); }

std::string trimmed(const std::string& text) {
  const std::size_t begin = text.find_first_not_of(" \t\r\"'");
  return begin == std::string::npos ? "" : text.substr(begin, text.find_last_not_of(" \t\r\"'") - begin + 1);
}

/// "rad s^-1" is a product to us.
std::string as_unit(const std::string& text) {
  std::string unit = trimmed(text);
  std::replace(unit.begin(), unit.end(), ' ', '*');
  return unit;
}

Name take_apart(const std::string& text) {
  Name name;
  const std::size_t bracket = text.find_first_of("[(");
  if (bracket != std::string::npos)
    name.unit = as_unit(text.substr(bracket + 1, text.find_first_of("])", bracket) - bracket - 1));
  std::string word;
  for (char c : text.substr(0, bracket) + " ") {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    if (is_word(c)) {
      word += c;
    } else if (!word.empty()) {
      name.words.push_back(word);
      name.joined += word;
      word.clear();
    }
  }
  return name;
}

bool contains(const std::string& text, const std::vector<std::string>& parts) {
  return std::any_of(parts.begin(), parts.end(),
                     [&](const std::string& part) { return text.find(part) != std::string::npos; });
}

bool is_one_of(const std::string& text, const std::vector<std::string>& words) {
  return std::find(words.begin(), words.end(), text) != words.end();
}

/// 0 for a gyro's column, 3 for an accelerometer's, -1 for another's. `stem` is the axis's word without its letter.
int sensor_of(const Name& name, const std::string& stem) {
  // "velocity" ends in y, too.
  if (!stem.empty() &&
      !is_one_of(stem, {"g", "gyr", "gyro", "gyroscope", "w", "omega", "angvel", "angularvelocity", "angularrate", "a",
                        "acc", "accel", "accelerometer", "acceleration", "linearacceleration", "f", "specificforce"}))
    return -1;
  const bool gyro = contains(name.joined, {"gyr", "omega", "angularvel", "angvel", "angularrate"});
  const bool accel = contains(name.joined, {"acc", "specificforce"});
  if (gyro != accel) return gyro ? 0 : 3;
  if (gyro) return -1;
  const std::string& word = stem.empty() ? name.words.front() : stem;
  if (word == "w" || stem == "g") return 0;
  return is_one_of(word, {"a", "f"}) ? 3 : -1;
}

/// Units that a name can end with where brackets are not used.
std::string unit_of_words(const std::string& words) {
  const std::pair<const char*, const char*> known[] = {
      {"rads", "rad/s"}, {"radps", "rad/s"}, {"degs", "deg/s"}, {"degps", "deg/s"}, {"dps", "deg/s"}, {"mdps", "mdps"},
      {"ms2", "m/s^2"},  {"mps2", "m/s^2"},  {"mss", "m/s^2"},  {"g", "g"},         {"mg", "mg"}};
  for (const auto& entry : known)
    if (words == entry.first) return entry.second;
  return "";
}

/// Index into ImuCsvColumns::axes and the unit if the name says it; -1 if it names no axis.
int axis_of(const Name& name, std::string* unit) {
  for (std::size_t i = name.words.size(); i-- > 0;) {
    const std::string& word = name.words[i];
    const char letter = word.back();
    if (letter < 'x' || letter > 'z') continue;
    const std::string stem = word.substr(0, word.size() - 1);
    const int sensor = sensor_of(name, stem);
    if (sensor < 0) continue;
    std::string rest;
    for (std::size_t k = i + 1; k < name.words.size(); ++k) rest += name.words[k];
    *unit = name.unit.empty() ? unit_of_words(rest) : name.unit;
    return sensor + (letter - 'x');
  }
  return -1;
}

bool is_time(const Name& name) {
  return contains(name.joined, {"timestamp", "headerstamp"}) ||
         is_one_of(name.words.front(), {"t", "time", "stamp", "ts", "sec", "secs", "seconds"});
}

/// Takes over the unit of one of a sensor's axes.
void agree(std::string* sensor, const std::string& axis, const std::string& name) {
  if (!sensor->empty() && !axis.empty() && *sensor != axis)
    throw std::invalid_argument("column '" + name + "' is in " + axis + ", but another axis in " + *sensor);
  if (!axis.empty()) *sensor = axis;
}

}  // namespace

bool find_imu_columns(const std::vector<std::string>& names, ImuCsvColumns* columns) {
  ImuCsvColumns found;
  found.count = static_cast<int>(names.size());
  for (int i = 0; i < found.count; ++i) {
    const std::string& text = names[static_cast<std::size_t>(i)];
    const Name name = take_apart(text);
    if (name.words.empty()) continue;
    std::string unit;
    const int axis = axis_of(name, &unit);
    if (axis >= 0) {
      int& place = found.axes[static_cast<std::size_t>(axis)];
      if (place >= 0)
        throw std::invalid_argument("columns '" + trimmed(names[static_cast<std::size_t>(place)]) + "' and '" +
                                    trimmed(text) + "' both name the same axis");
      place = i;
      agree(axis < 3 ? &found.gyro_unit : &found.accel_unit, unit, trimmed(text));
    } else if (contains(name.joined, {"temp"})) {
      found.temperature = i;
    } else if (is_time(name) && (found.time < 0 || contains(name.joined, {"headerstamp"}))) {
      // rostopic echo -p: the header's stamp rather than the time of the recording, both in ns
      const std::string& last = name.words.back();
      found.time = i;
      found.time_unit = !name.unit.empty()                            ? name.unit
                        : is_one_of(last, {"s", "ms", "us", "ns"})    ? last
                        : is_one_of(last, {"sec", "secs", "seconds"}) ? "s"
                        : contains(name.joined, {"fieldheaderstamp"}) ? "ns"
                                                                      : "";
    }
  }
  if (*std::min_element(found.axes.begin(), found.axes.end()) < 0) return false;
  *columns = found;
  return true;
}

bool default_imu_columns(int count, ImuCsvColumns* columns) {
  if (count != 6 && count != 7) return false;
  *columns = {};
  columns->count = count;
  columns->time = count == 7 ? 0 : -1;
  for (int i = 0; i < 6; ++i) columns->axes[static_cast<std::size_t>(i)] = i + count - 6;
  return true;
}

}  // namespace allan_lio
