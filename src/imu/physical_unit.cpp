// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/imu/physical_unit.h"

#include <cctype>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace allan_lio {
namespace {

constexpr double kStandardGravity = 9.80665;  // [m/s^2], exact by definition
constexpr double kRadPerDegree = 3.14159265358979323846 / 180.0;

PhysicalUnit power(const PhysicalUnit& unit, double exponent) {
  PhysicalUnit result;
  result.factor = exponent == 0.5 ? std::sqrt(unit.factor) : std::pow(unit.factor, exponent);
  for (int i = 0; i < 3; ++i) result.exponents[i] = unit.exponents[i] * exponent;
  return result;
}

/// a * b, or a / b for `sign` -1.
PhysicalUnit combine(const PhysicalUnit& a, const PhysicalUnit& b, int sign) {
  PhysicalUnit result;
  result.factor = sign > 0 ? a.factor * b.factor : a.factor / b.factor;
  for (int i = 0; i < 3; ++i) result.exponents[i] = a.exponents[i] + sign * b.exponents[i];
  return result;
}

bool find_atom(const std::string& name, PhysicalUnit* unit) {
  const struct {
    const char* name;
    PhysicalUnit unit;
  } atoms[] = {{"1", {1.0, {{0, 0, 0}}}},
               {"rad", {1.0, {{0, 0, 1}}}},
               {"deg", {kRadPerDegree, {{0, 0, 1}}}},
               {"dps", {kRadPerDegree, {{0, -1, 1}}}},
               {"mdps", {1e-3 * kRadPerDegree, {{0, -1, 1}}}},
               {"m", {1.0, {{1, 0, 0}}}},
               {"s", {1.0, {{0, 1, 0}}}},
               {"ms", {1e-3, {{0, 1, 0}}}},
               {"us", {1e-6, {{0, 1, 0}}}},
               {"min", {60.0, {{0, 1, 0}}}},
               {"h", {3600.0, {{0, 1, 0}}}},
               {"hr", {3600.0, {{0, 1, 0}}}},
               {"Hz", {1.0, {{0, -1, 0}}}},
               {"g", {kStandardGravity, {{1, -2, 0}}}},
               {"mg", {kStandardGravity / 1e3, {{1, -2, 0}}}},
               {"ug", {kStandardGravity / 1e6, {{1, -2, 0}}}},
               {"Gal", {1e-2, {{1, -2, 0}}}},
               {"mGal", {1e-5, {{1, -2, 0}}}}};
  for (const auto& atom : atoms) {
    if (name != atom.name) continue;
    *unit = atom.unit;
    return true;
  }
  return false;
}

/// Blanks out; typographic signs as ASCII. '~' stands for the root sign, which needs no parentheses.
std::string to_plain(const std::string& text) {
  const std::pair<const char*, const char*> signs[] = {{"\u00b5", "u"},   {"\u03bc", "u"}, {"\u00b2", "^2"},
                                                       {"\u221a", "~"},   {"\u00b7", "*"}, {"\u22c5", "*"},
                                                       {"\u00b0", "deg"}, {" ", ""},       {"\t", ""}};
  std::string plain = text;
  for (const auto& sign : signs) {
    const std::string from = sign.first, to = sign.second;
    for (std::size_t at = plain.find(from); at != std::string::npos; at = plain.find(from, at + to.size())) {
      plain.replace(at, from.size(), to);
    }
  }
  return plain;
}

/// product := factor (('*' | '/') factor)*      factor := primary ('^' number)?
/// primary := 'sqrt' '(' product ')' | '~' primary | '(' product ')' | name | '1'
class UnitParser {
 public:
  explicit UnitParser(std::string text) : text_(std::move(text)) {}

  PhysicalUnit parse() {
    const PhysicalUnit unit = product();
    if (at_ != text_.size()) fail("'" + text_.substr(at_) + "' is not understood");
    return unit;
  }

 private:
  PhysicalUnit product() {
    PhysicalUnit unit = factor();
    while (peek() == '*' || peek() == '/') {
      const int sign = text_[at_++] == '*' ? 1 : -1;
      unit = combine(unit, factor(), sign);
    }
    return unit;
  }

  PhysicalUnit factor() {
    const PhysicalUnit base = primary();
    return take('^') ? power(base, exponent()) : base;
  }

  PhysicalUnit primary() {
    if (++depth_ > 20) fail("it is nested too deep");
    PhysicalUnit unit;
    if (take('~')) {
      unit = power(primary(), 0.5);
    } else if (take('(')) {
      unit = parenthesised();
    } else {
      const std::string name = word();
      if (name == "sqrt" && take('(')) {
        unit = power(parenthesised(), 0.5);
      } else if (!find_atom(name, &unit)) {
        fail(name.empty() ? "a unit is missing" : "'" + name + "' is not a unit");
      }
    }
    --depth_;
    return unit;
  }

  PhysicalUnit parenthesised() {
    const PhysicalUnit unit = product();
    if (!take(')')) fail("a ')' is missing");
    return unit;
  }

  double exponent() {
    const bool bracket = take('(');
    const int sign = take('-') ? -1 : 1;
    if (!std::isdigit(static_cast<unsigned char>(peek()))) fail("a number is missing after '^'");
    double value = text_[at_++] - '0';
    if (take('.')) {
      if (!take('5')) fail("only powers in halves are understood");
      value += 0.5;
    } else if (bracket && take('/')) {
      if (!take('2')) fail("only powers in halves are understood");
      value /= 2.0;
    }
    if (bracket && !take(')')) fail("a ')' is missing");
    return sign * value;
  }

  std::string word() {
    if (take('1')) return "1";
    const std::size_t begin = at_;
    while (std::isalpha(static_cast<unsigned char>(peek()))) ++at_;
    return text_.substr(begin, at_ - begin);
  }

  char peek() const { return at_ < text_.size() ? text_[at_] : '\0'; }

  bool take(char expected) {
    if (peek() != expected) return false;
    ++at_;
    return true;
  }

  [[noreturn]] static void fail(const std::string& reason) { throw std::invalid_argument(reason); }

  std::string text_;
  std::size_t at_ = 0;
  int depth_ = 0;
};

}  // namespace

PhysicalUnit parse_unit(const std::string& text) { return UnitParser(to_plain(text)).parse(); }

}  // namespace allan_lio
