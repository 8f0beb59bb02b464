// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/io/trial_files.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <fstream>

#include "child_process.h"
#include "temporary_directory.h"

namespace allan_lio {
namespace {

std::uint64_t bits_of(double value) {
  std::uint64_t bits = 0;
  std::memcpy(&bits, &value, sizeof bits);
  return bits;
}

void write_text(const std::string& path, const std::string& text) { std::ofstream(path) << text; }

/// What reading a results file of this text complains of.
std::string complaint_about(const std::string& text) {
  const TemporaryDirectory directory;
  write_text(directory.file("r"), text);
  try {
    read_results(directory.file("r"));
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

const char* const kHead =
    "ate,end_error,nll,nis,nis_dof,horizon_nll,horizon_nis,horizon_dof,horizon_share,scans,diverged\n";

TEST(TrialFiles, TrialsComeBackToTheLastBit) {
  const TemporaryDirectory directory;
  std::vector<NoiseTrial> trials(3);
  trials[1] = {4294967295U, {{std::nextafter(1.0, 2.0), 0.1, 1.0 / 3.0, 1e-300}, 5e-324}, 7};
  trials[2].setting.imu.k_g = std::exp(1.23456789);
  write_trials(directory.file("t"), trials);
  const std::vector<NoiseTrial> read = read_trials(directory.file("t"));
  ASSERT_EQ(read.size(), trials.size());
  for (std::size_t i = 0; i < trials.size(); ++i) {
    EXPECT_EQ(read[i].bag, trials[i].bag);
    EXPECT_EQ(read[i].run, trials[i].run);
    const NoiseSetting &a = read[i].setting, &b = trials[i].setting;
    EXPECT_EQ(bits_of(a.imu.k_g), bits_of(b.imu.k_g));
    EXPECT_EQ(bits_of(a.imu.k_a), bits_of(b.imu.k_a));
    EXPECT_EQ(bits_of(a.imu.k_gb), bits_of(b.imu.k_gb));
    EXPECT_EQ(bits_of(a.imu.k_ab), bits_of(b.imu.k_ab));
    EXPECT_EQ(bits_of(a.k_r), bits_of(b.k_r));
  }
}

TEST(TrialFiles, ResultsComeBackToTheLastBitAndNaNAsNaN) {
  const TemporaryDirectory directory;
  std::vector<TrialResult> results(2);
  results[1] = {0.1 + 0.2, -0.0,       -12345.678901234567, 1e300, 18446744073709551615ULL, -1.0 / 7.0, 1.0 / 9.0,
                1e-300,    2.0 / 11.0, 4294967295U,         true};
  write_results(directory.file("r"), results);
  const std::vector<TrialResult> read = read_results(directory.file("r"));
  ASSERT_EQ(read.size(), 2U);
  EXPECT_TRUE(std::isnan(read[0].ate) && std::isnan(read[0].end_error));
  EXPECT_FALSE(read[0].diverged);
  EXPECT_EQ(bits_of(read[1].ate), bits_of(results[1].ate));
  EXPECT_EQ(bits_of(read[1].end_error), bits_of(results[1].end_error));
  EXPECT_EQ(bits_of(read[1].nll), bits_of(results[1].nll));
  EXPECT_EQ(bits_of(read[1].nis), bits_of(results[1].nis));
  EXPECT_EQ(read[1].nis_dof, results[1].nis_dof);
  EXPECT_EQ(bits_of(read[1].horizon_nll), bits_of(results[1].horizon_nll));
  EXPECT_EQ(bits_of(read[1].horizon_nis), bits_of(results[1].horizon_nis));
  EXPECT_EQ(bits_of(read[1].horizon_dof), bits_of(results[1].horizon_dof));
  EXPECT_EQ(bits_of(read[1].horizon_share), bits_of(results[1].horizon_share));
  EXPECT_EQ(read[1].scans, results[1].scans);
  EXPECT_TRUE(read[1].diverged);
}

TEST(TrialFiles, NoTrialsAreAFileToo) {
  const TemporaryDirectory directory;
  write_trials(directory.file("t"), {});
  EXPECT_TRUE(read_trials(directory.file("t")).empty());
}

TEST(TrialFiles, ACutOffFileIsRefusedWhereverTheCutLies) {
  const TemporaryDirectory directory;
  write_results(directory.file("r"), std::vector<TrialResult>(2));
  const std::string text = contents_of(directory.file("r"));
  for (std::size_t size = 0; size < text.size(); ++size) {
    write_text(directory.file("cut"), text.substr(0, size));
    EXPECT_THROW(read_results(directory.file("cut")), std::runtime_error) << size << " bytes";
  }
}

TEST(TrialFiles, MistakesAreNamedWithTheirLine) {
  const std::string one = std::string("allan_lio results 2, 1 rows\n") + kHead;
  EXPECT_NE(complaint_about(one + "1,2,3,x,5,1,1,1,1,6,0\n").find("r:3: 'x' is not a number"), std::string::npos);
  EXPECT_NE(complaint_about(one + "1,2,3,4,-5,1,1,1,1,6,0\n").find("r:3: '-5' is not a whole number"),
            std::string::npos);
  EXPECT_NE(complaint_about(one + "1,2,3,4,5,1,1,1,1,4294967296,0\n").find("'4294967296' is too large"),
            std::string::npos);
  EXPECT_NE(complaint_about(one + "1,2,3,4,18446744073709551616,1,1,1,1,6,0\n").find("is too large"),
            std::string::npos);
  EXPECT_NE(complaint_about(one + "1,2,3,4,5,1,1,1,1,6,2\n").find("'2' is too large"), std::string::npos);
  EXPECT_NE(complaint_about(one + "1,2,3\n").find("r:3: is cut off or of another length"), std::string::npos);
  EXPECT_NE(complaint_about("something else\n").find("is no file of 'allan_lio results 2'"), std::string::npos);
  EXPECT_NE(complaint_about("allan_lio results 22, 0 rows\n" + std::string(kHead)).find("is no file"),
            std::string::npos);
  EXPECT_EQ(complaint_about(one + "1,2,3,4,5,1,1,1,1,6,0\n"), "");
}

TEST(TrialFiles, TrialsAreNotTakenForResults) {
  const TemporaryDirectory directory;
  write_trials(directory.file("t"), std::vector<NoiseTrial>(1));
  EXPECT_THROW(read_results(directory.file("t")), std::runtime_error);
}

}  // namespace
}  // namespace allan_lio
