// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/imu/noise_units.h"

#include <sstream>
#include <stdexcept>

#include "allan_lio/imu/physical_unit.h"

namespace allan_lio {
namespace {

const Dimension kDimensions[] = {Dimension::kGyroWhiteNoise, Dimension::kAccelWhiteNoise, Dimension::kAngularRate,
                                 Dimension::kAcceleration, Dimension::kTime};

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
  }
  throw std::invalid_argument("describe: unknown dimension");
}

}  // namespace allan_lio
