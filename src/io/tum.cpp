// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/io/tum.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <limits>
#include <locale>
#include <sstream>
#include <stdexcept>

#include "allan_lio/io/number_text.h"

namespace allan_lio {
namespace {

constexpr int kNsDigits = 9;
constexpr int kMaxDigits = 40;     // more than any int64 of nanoseconds needs
constexpr double kMinNorm = 1e-6;  // of a quaternion; shorter ones carry no rotation
constexpr std::size_t kTumFields = 8;

[[noreturn]] void fail(const std::string& name, std::size_t line, const std::string& sentence) {
  throw std::runtime_error(name + ":" + std::to_string(line) + ": " + sentence);
}

/// The words of a line: parted by blanks or commas, up to a '#'.
std::vector<std::string> split_words(const std::string& line) {
  std::string text = line.substr(0, line.find('#'));
  std::replace(text.begin(), text.end(), ',', ' ');
  std::istringstream in(text);
  std::vector<std::string> words;
  for (std::string word; in >> word;) words.push_back(word);
  return words;
}

StampedPose parse_pose(const std::vector<std::string>& words, const std::string& name, std::size_t line) {
  if (words.size() != kTumFields)
    fail(name, line, "a TUM line holds 8 numbers (t x y z qx qy qz qw), this one " + std::to_string(words.size()));
  StampedPose result;
  if (!parse_seconds(words[0], &result.stamp)) fail(name, line, "'" + words[0] + "' is not a time in seconds");
  std::array<double, kTumFields - 1> v;
  for (std::size_t i = 0; i < v.size(); ++i)
    if (!parse_number(words[i + 1], &v[i])) fail(name, line, "'" + words[i + 1] + "' is not a finite number");
  const Eigen::Quaterniond rotation(v[6], v[3], v[4], v[5]);
  const double norm = rotation.norm();
  if (!(norm > kMinNorm)) fail(name, line, "the quaternion is zero");
  if (!std::isfinite(norm)) fail(name, line, "the quaternion is too large to be normalised");
  result.pose.translation << v[0], v[1], v[2];
  // A quaternion that is normal to rounding keeps its bits, so that what we wrote comes back unchanged.
  constexpr double kRounding = 4 * std::numeric_limits<double>::epsilon();
  result.pose.rotation = std::abs(norm - 1.0) <= kRounding ? rotation : rotation.normalized();
  return result;
}

/// Reads [digits][.digits] into `digits`; returns how many follow the point, or -1 if there is no digit at all.
int take_decimal(const std::string& text, std::size_t* at, std::string* digits) {
  int decimals = 0, seen = 0;
  bool point = false;
  for (; *at < text.size(); ++*at) {
    const char c = text[*at];
    if (c == '.' && !point) {
      point = true;
    } else if (c >= '0' && c <= '9') {
      ++seen;
      decimals += point;
      if (c != '0' || !digits->empty()) digits->push_back(c);  // leading zeros don't count
    } else {
      break;
    }
  }
  return seen > 0 ? decimals : -1;
}

/// The rest of `text` as an exponent: "" or "e+09".
bool take_exponent(const std::string& text, std::size_t at, int* exponent) {
  *exponent = 0;
  if (at == text.size()) return true;
  if (text[at] != 'e' && text[at] != 'E') return false;
  ++at;
  const bool negative = at < text.size() && text[at] == '-';
  if (at < text.size() && (text[at] == '-' || text[at] == '+')) ++at;
  if (at == text.size() || text.size() - at > 3) return false;
  for (; at < text.size(); ++at) {
    if (text[at] < '0' || text[at] > '9') return false;
    *exponent = 10 * *exponent + (text[at] - '0');
  }
  if (negative) *exponent = -*exponent;
  return true;
}

/// `digits` times 10^shift, rounded to the nearest integer. False if it does not fit.
bool shift_decimal(std::string digits, int shift, TimeNs* value) {
  bool round_up = false;
  if (shift < 0) {
    const std::size_t cut = static_cast<std::size_t>(-shift);
    round_up = digits.size() >= cut && digits[digits.size() - cut] >= '5';
    digits.resize(digits.size() > cut ? digits.size() - cut : 0);
  } else if (!digits.empty()) {
    if (digits.size() + static_cast<std::size_t>(shift) > kMaxDigits) return false;
    digits.append(static_cast<std::size_t>(shift), '0');
  }
  TimeNs sum = 0;
  constexpr TimeNs kLimit = std::numeric_limits<TimeNs>::max();
  for (const char c : digits) {
    const int digit = c - '0';
    if (sum > (kLimit - digit - 1) / 10) return false;
    sum = 10 * sum + digit;
  }
  *value = sum + round_up;
  return true;
}

}  // namespace

std::string format_seconds(TimeNs stamp) {
  // Unsigned, because the magnitude of the smallest int64 does not fit an int64.
  const std::uint64_t magnitude = stamp < 0 ? 0 - static_cast<std::uint64_t>(stamp) : static_cast<std::uint64_t>(stamp);
  const std::string whole = std::to_string(magnitude / kNsPerSecond);
  const std::string fraction = std::to_string(magnitude % kNsPerSecond);
  return (stamp < 0 ? "-" : "") + whole + "." + std::string(kNsDigits - fraction.size(), '0') + fraction;
}

bool parse_seconds(const std::string& text, TimeNs* stamp) {
  std::size_t at = 0;
  const bool negative = !text.empty() && text[0] == '-';
  if (!text.empty() && (text[0] == '-' || text[0] == '+')) ++at;
  std::string digits;
  const int decimals = take_decimal(text, &at, &digits);
  int exponent = 0;
  if (decimals < 0 || !take_exponent(text, at, &exponent)) return false;
  if (!shift_decimal(digits, exponent - decimals + kNsDigits, stamp)) return false;
  if (negative) *stamp = -*stamp;
  return true;
}

std::string format_tum_line(const StampedPose& pose) {
  std::ostringstream out;
  out.imbue(std::locale::classic());
  out.precision(std::numeric_limits<double>::max_digits10);
  const Eigen::Vector3d& t = pose.pose.translation;
  const Eigen::Quaterniond& q = pose.pose.rotation;
  out << format_seconds(pose.stamp);
  for (const double value : {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()}) out << ' ' << value;
  return out.str();
}

Trajectory read_tum(std::istream& in, const std::string& name) {
  Trajectory trajectory;
  std::string text;
  for (std::size_t line = 1; std::getline(in, text); ++line) {
    const std::vector<std::string> words = split_words(text);
    if (words.empty()) continue;
    const StampedPose pose = parse_pose(words, name, line);
    if (!trajectory.empty() && pose.stamp <= trajectory.back().stamp)
      fail(name, line,
           "the stamp " + words[0] + " is not later than the one before, " + format_seconds(trajectory.back().stamp));
    trajectory.push_back(pose);
  }
  if (in.bad()) throw std::runtime_error(name + ": cannot be read to its end");
  if (trajectory.empty()) throw std::runtime_error(name + ": holds no pose");
  return trajectory;
}

Trajectory read_tum(const std::string& path) {
  std::ifstream in(path);
  if (!in) throw std::runtime_error(path + ": cannot be opened");
  if (in.peek() == std::ifstream::traits_type::eof() && in.bad())  // a directory opens, but cannot be read
    throw std::runtime_error(path + ": cannot be read");
  in.clear();
  return read_tum(in, path);
}

void write_tum(const std::string& path, const Trajectory& trajectory) {
  std::ofstream out(path);
  for (const StampedPose& pose : trajectory) out << format_tum_line(pose) << '\n';
  out.close();
  if (!out) throw std::runtime_error(path + ": cannot be written");
}

}  // namespace allan_lio
