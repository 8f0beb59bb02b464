// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/imu/noise_units.h"

#include <array>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include "allan_lio/imu/physical_unit.h"

namespace allan_lio {
namespace {

const Dimension kDimensions[] = {
    Dimension::kGyroWhiteNoise, Dimension::kAccelWhiteNoise, Dimension::kAngularRate,     Dimension::kAcceleration,
    Dimension::kTime,           Dimension::kGyroRandomWalk,  Dimension::kAccelRandomWalk, Dimension::kFrequency};

PhysicalUnit parse_si(Dimension dimension) { return parse_unit(si_unit(dimension)); }

/// "m s^-1.5", or the name of the quantity if it is one of ours.
std::string describe(const PhysicalUnit& unit) {
  for (const Dimension dimension : kDimensions) {
    if (parse_si(dimension).exponents == unit.exponents) {
      return describe(dimension) + " [" + si_unit(dimension) + "]";
    }
  }
  const char* const names[] = {"m", "s", "rad"};
  std::ostringstream out;
  out.imbue(std::locale::classic());
  for (int i = 0; i < 3; ++i) {
    if (unit.exponents[i] == 0.0) continue;
    out << (out.tellp() > 0 ? " " : "") << names[i];
    if (unit.exponents[i] != 1.0) out << '^' << unit.exponents[i];
  }
  return out.tellp() > 0 ? "a quantity in " + out.str() : "a pure number";
}

bool is_density(Dimension dimension) {
  return dimension == Dimension::kGyroWhiteNoise || dimension == Dimension::kAccelWhiteNoise ||
         dimension == Dimension::kGyroRandomWalk || dimension == Dimension::kAccelRandomWalk;
}

}  // namespace

UnitConversion convert_unit(const std::string& text, Dimension wanted) {
  UnitConversion conversion;
  std::string reason;
  try {
    const PhysicalUnit unit = parse_unit(text);
    if (unit.exponents == parse_si(wanted).exponents) {
      conversion.to_si = unit.factor;
      return conversion;
    }
    reason = "is the unit of " + describe(unit) + ", but wanted is " + describe(wanted);
  } catch (const std::invalid_argument& error) {
    reason = text.empty() ? std::string("is empty") : std::string("is not understood: ") + error.what();
  }
  conversion.error = "unit '" + text + "' " + reason + "; accepted are, for example,";
  const char* comma = "";
  for (const std::string& unit : usual_units(wanted)) {
    conversion.error += comma + std::string(" ") + unit;
    comma = ",";
  }
  return conversion;
}

double NoiseForm::apply(double value, double rate) const {
  const double density = squared ? std::sqrt(value * to_si) : value * to_si;
  return of_samples ? density / std::sqrt(rate) : density;
}

NoiseForm convert_noise_unit(const std::string& text, Dimension wanted) {
  NoiseForm form;
  const UnitConversion plain = convert_unit(text, wanted);
  form.to_si = plain.to_si;
  form.error = plain.error;
  if (plain.ok() || !is_density(wanted)) return form;
  try {
    const PhysicalUnit unit = parse_unit(text), density = parse_si(wanted);
    for (const double squared : {1.0, 2.0}) {
      for (const double per_sample : {0.0, 1.0}) {
        std::array<double, 3> exponents = density.exponents;
        for (double& exponent : exponents) exponent *= squared;
        exponents[1] -= 0.5 * per_sample * squared;  // times sqrt(Hz), or Hz for a square
        if (unit.exponents != exponents) continue;
        form.to_si = unit.factor;
        form.squared = squared == 2.0;
        form.of_samples = per_sample == 1.0;
        form.error.clear();
      }
    }
  } catch (const std::invalid_argument&) {
    // plain.error says it
  }
  return form;
}

std::string si_unit(Dimension dimension) { return usual_units(dimension).front(); }

std::vector<std::string> usual_units(Dimension dimension) {
  switch (dimension) {
    case Dimension::kGyroWhiteNoise:
      return {"rad/s/sqrt(Hz)", "rad/sqrt(s)", "deg/s/sqrt(Hz)", "deg/sqrt(h)", "deg/h/sqrt(Hz)", "mdps/sqrt(Hz)"};
    case Dimension::kAccelWhiteNoise:
      return {"m/s^2/sqrt(Hz)", "m/s/sqrt(s)", "m/s/sqrt(h)", "g/sqrt(Hz)", "mg/sqrt(Hz)", "ug/sqrt(Hz)"};
    case Dimension::kAngularRate:
      return {"rad/s", "deg/s", "deg/h", "mdps"};
    case Dimension::kAcceleration:
      return {"m/s^2", "g", "mg", "ug", "mGal"};
    case Dimension::kTime:
      return {"s", "ms", "min", "h"};
    case Dimension::kGyroRandomWalk:
      return {"rad/s^2/sqrt(Hz)", "rad/s/sqrt(s)", "deg/s^2/sqrt(Hz)",
              "deg/s/sqrt(h)",    "deg/h/sqrt(s)", "deg/h/sqrt(h)"};
    case Dimension::kAccelRandomWalk:
      return {"m/s^3/sqrt(Hz)", "m/s^2/sqrt(s)", "m/s^2/sqrt(h)", "ug/sqrt(s)", "mg/sqrt(h)", "ug/sqrt(h)"};
    case Dimension::kFrequency:
      return {"Hz", "1/s"};
  }
  throw std::invalid_argument("usual_units: unknown dimension");
}

std::string describe(Dimension dimension) {
  switch (dimension) {
    case Dimension::kGyroWhiteNoise:
      return "a gyro's white noise (angle random walk)";
    case Dimension::kAccelWhiteNoise:
      return "an accelerometer's white noise (velocity random walk)";
    case Dimension::kAngularRate:
      return "an angular rate";
    case Dimension::kAcceleration:
      return "an acceleration";
    case Dimension::kTime:
      return "a time";
    case Dimension::kGyroRandomWalk:
      return "a gyro bias's random walk";
    case Dimension::kAccelRandomWalk:
      return "an accelerometer bias's random walk";
    case Dimension::kFrequency:
      return "a frequency";
  }
  throw std::invalid_argument("describe: unknown dimension");
}

}  // namespace allan_lio
