// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/imu/noise_units.h"

#include <gtest/gtest.h>

#include <cmath>

#include "allan_lio/imu/physical_unit.h"

namespace allan_lio {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kDegree = kPi / 180.0;
constexpr double kGravity = 9.80665;
constexpr double kRelativeRounding = 1e-15;

const Dimension kAll[] = {
    Dimension::kGyroWhiteNoise, Dimension::kAccelWhiteNoise, Dimension::kAngularRate,     Dimension::kAcceleration,
    Dimension::kTime,           Dimension::kGyroRandomWalk,  Dimension::kAccelRandomWalk, Dimension::kFrequency};

void expect_factor(const std::string& text, Dimension dimension, double factor) {
  const UnitConversion conversion = convert_unit(text, dimension);
  ASSERT_TRUE(conversion.ok()) << text << ": " << conversion.error;
  EXPECT_NEAR(conversion.to_si / factor, 1.0, kRelativeRounding) << text;
}

TEST(NoiseUnits, GyroWhiteNoiseInEveryUsualUnitBecomesSi) {
  expect_factor("rad/s/sqrt(Hz)", Dimension::kGyroWhiteNoise, 1.0);
  expect_factor("rad/sqrt(s)", Dimension::kGyroWhiteNoise, 1.0);
  expect_factor("deg/s/sqrt(Hz)", Dimension::kGyroWhiteNoise, kDegree);
  expect_factor("deg/sqrt(h)", Dimension::kGyroWhiteNoise, kDegree / 60.0);
  expect_factor("deg/h/sqrt(Hz)", Dimension::kGyroWhiteNoise, kDegree / 3600.0);
  expect_factor("mdps/sqrt(Hz)", Dimension::kGyroWhiteNoise, 1e-3 * kDegree);
}

TEST(NoiseUnits, AccelWhiteNoiseInEveryUsualUnitBecomesSi) {
  expect_factor("m/s^2/sqrt(Hz)", Dimension::kAccelWhiteNoise, 1.0);
  expect_factor("m/s/sqrt(s)", Dimension::kAccelWhiteNoise, 1.0);
  expect_factor("m/s/sqrt(h)", Dimension::kAccelWhiteNoise, 1.0 / 60.0);
  expect_factor("g/sqrt(Hz)", Dimension::kAccelWhiteNoise, kGravity);
  expect_factor("mg/sqrt(Hz)", Dimension::kAccelWhiteNoise, 1e-3 * kGravity);
  expect_factor("ug/sqrt(Hz)", Dimension::kAccelWhiteNoise, 1e-6 * kGravity);
}

TEST(NoiseUnits, RatesAccelerationsAndTimesBecomeSi) {
  expect_factor("rad/s", Dimension::kAngularRate, 1.0);
  expect_factor("deg/s", Dimension::kAngularRate, kDegree);
  expect_factor("deg/h", Dimension::kAngularRate, kDegree / 3600.0);
  expect_factor("mdps", Dimension::kAngularRate, 1e-3 * kDegree);
  expect_factor("m/s^2", Dimension::kAcceleration, 1.0);
  expect_factor("g", Dimension::kAcceleration, kGravity);
  expect_factor("mg", Dimension::kAcceleration, 1e-3 * kGravity);
  expect_factor("ug", Dimension::kAcceleration, 1e-6 * kGravity);
  expect_factor("mGal", Dimension::kAcceleration, 1e-5);
  expect_factor("s", Dimension::kTime, 1.0);
  expect_factor("ms", Dimension::kTime, 1e-3);
  expect_factor("min", Dimension::kTime, 60.0);
  expect_factor("h", Dimension::kTime, 3600.0);
}

TEST(NoiseUnits, RandomWalksInEveryUsualUnitBecomeSi) {
  expect_factor("rad/s^2/sqrt(Hz)", Dimension::kGyroRandomWalk, 1.0);
  expect_factor("rad/s/sqrt(s)", Dimension::kGyroRandomWalk, 1.0);
  expect_factor("deg/s/sqrt(h)", Dimension::kGyroRandomWalk, kDegree / 60.0);
  expect_factor("deg/h/sqrt(h)", Dimension::kGyroRandomWalk, kDegree / 3600.0 / 60.0);
  expect_factor("m/s^3/sqrt(Hz)", Dimension::kAccelRandomWalk, 1.0);
  expect_factor("ug/sqrt(h)", Dimension::kAccelRandomWalk, 1e-6 * kGravity / 60.0);
}

TEST(NoiseUnits, TheUnitTellsDensityPsdAndFiguresOfSingleSamplesApart) {
  constexpr double kRate = 400.0, kTiny = 1e-15;
  const struct {
    const char* unit;
    Dimension dimension;
    double value, density;
    bool of_samples;
  } cases[] = {
      {"rad/s/sqrt(Hz)", Dimension::kGyroWhiteNoise, 0.02, 0.02, false},
      {"(rad/s)^2/Hz", Dimension::kGyroWhiteNoise, 0.0004, 0.02, false},
      {"rad/s", Dimension::kGyroWhiteNoise, 0.4, 0.02, true},
      {"(rad/s)^2", Dimension::kGyroWhiteNoise, 0.16, 0.02, true},
      {"mg", Dimension::kAccelWhiteNoise, 40.0, 0.04 * kGravity / 20.0, true},
      {"(m/s^2)^2", Dimension::kAccelWhiteNoise, 0.16, 0.02, true},
      {"(rad/s^2)^2", Dimension::kGyroRandomWalk, 1e-4, 0.01 / 20.0, true},
      {"rad/s^2", Dimension::kGyroRandomWalk, 1e-2, 0.01 / 20.0, true},
      {"(m/s^3)^2", Dimension::kAccelRandomWalk, 1e-4, 0.01 / 20.0, true},
      {"(m/s^2)^2/s", Dimension::kAccelRandomWalk, 1e-4, 0.01, false},
  };
  for (const auto& c : cases) {
    const NoiseForm form = convert_noise_unit(c.unit, c.dimension);
    ASSERT_TRUE(form.ok()) << c.unit << ": " << form.error;
    EXPECT_EQ(form.of_samples, c.of_samples) << c.unit;
    EXPECT_NEAR(form.apply(c.value, kRate), c.density, kTiny) << c.unit;
  }
  EXPECT_FALSE(convert_noise_unit("rad/s^2", Dimension::kGyroWhiteNoise).ok())
      << "a step of the bias is not white noise";
  EXPECT_FALSE(convert_noise_unit("(rad/s)^2", Dimension::kAngularRate).ok()) << "only densities have other forms";
}

TEST(NoiseUnits, SpellingsOfOneUnitGiveOneFactor) {
  for (const char* text : {" deg / sqrt( h ) ", "deg/h^0.5", "deg/h^(1/2)", "deg*h^-0.5", "\u00b0/\u221ah",
                           "deg/\u221a(h)", "(deg)/(sqrt(h))", "deg/sqrt(hr)"}) {
    expect_factor(text, Dimension::kGyroWhiteNoise, kDegree / 60.0);
  }
  for (const char* text : {"\u00b5g/sqrt(Hz)", "\u03bcg/\u221aHz", "ug/Hz^0.5"}) {
    expect_factor(text, Dimension::kAccelWhiteNoise, 1e-6 * kGravity);
  }
  expect_factor("m/s\u00b2", Dimension::kAcceleration, 1.0);
  expect_factor("dps/sqrt(Hz)", Dimension::kGyroWhiteNoise, kDegree);
}

TEST(NoiseUnits, TheSiUnitsFactorIsExactlyOne) {
  for (const Dimension dimension : kAll) {
    EXPECT_EQ(convert_unit(si_unit(dimension), dimension).to_si, 1.0) << si_unit(dimension);
  }
}

TEST(NoiseUnits, EveryUsualUnitIsAcceptedForItsDimensionAndNoOther) {
  for (const Dimension dimension : kAll) {
    for (const std::string& unit : usual_units(dimension)) {
      for (const Dimension wanted : kAll) {
        EXPECT_EQ(convert_unit(unit, wanted).ok(), wanted == dimension) << unit;
      }
    }
  }
}

TEST(NoiseUnits, AWrongDimensionIsNamedTogetherWithTheOneWanted) {
  const std::string error = convert_unit("deg/h", Dimension::kGyroWhiteNoise).error;
  EXPECT_NE(error.find("an angular rate [rad/s]"), std::string::npos) << error;
  EXPECT_NE(error.find("a gyro's white noise"), std::string::npos) << error;
  EXPECT_NE(error.find("deg/sqrt(h)"), std::string::npos) << error;
}

TEST(NoiseUnits, ADimensionWithoutANameIsSpeltOut) {
  const std::string variance = convert_unit("(deg/s)^2/Hz", Dimension::kGyroWhiteNoise).error;
  EXPECT_NE(variance.find("s^-1 rad^2"), std::string::npos) << variance;
  const std::string pure = convert_unit("1", Dimension::kTime).error;
  EXPECT_NE(pure.find("a pure number"), std::string::npos) << pure;
}

TEST(NoiseUnits, AnAngleIsNotAPureNumber) {
  EXPECT_FALSE(convert_unit("1/s", Dimension::kAngularRate).ok());
  EXPECT_FALSE(convert_unit("1/sqrt(s)", Dimension::kGyroWhiteNoise).ok());
}

TEST(NoiseUnits, WhatIsNotAUnitIsRefusedWithTheReasonAndWhatIsAccepted) {
  for (const char* text :
       {"", "foo", "deg/", "/s", "deg/sqrt(h", "deg/sqrt(h))", "deg/sqrth", "deg//s", "deg^", "deg^x", "m/s^2.3",
        "2*deg/s", "deg/s rad", "m^1/2", "hz", "DEG/s", "((((((((((((((((((((((rad"}) {
    const UnitConversion conversion = convert_unit(text, Dimension::kAngularRate);
    EXPECT_FALSE(conversion.ok()) << text;
    EXPECT_NE(conversion.error.find("rad/s, deg/s, deg/h, mdps"), std::string::npos) << conversion.error;
    EXPECT_NE(conversion.error.find("'" + std::string(text) + "'"), std::string::npos) << conversion.error;
  }
}

TEST(NoiseUnits, ParserBindsPowersTighterThanQuotients) {
  const PhysicalUnit unit = parse_unit("m/s^2/sqrt(Hz)");
  EXPECT_EQ(unit.exponents[0], 1.0);
  EXPECT_EQ(unit.exponents[1], -1.5);
  EXPECT_EQ(unit.exponents[2], 0.0);
  EXPECT_EQ(parse_unit("m/(s*s)").exponents, parse_unit("m/s/s").exponents);
  EXPECT_EQ(parse_unit("h^2").factor, 3600.0 * 3600.0);
}

}  // namespace
}  // namespace allan_lio
