// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/io/trial_store.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sqlite3.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include "temporary_directory.h"

namespace allan_lio {
namespace {

TrialKey key_of(std::uint32_t run) {
  TrialKey key;
  key.problem = "0123456789abcdef";
  key.bag = "fedcba";
  key.setting = {{0.1, 1.0 / 3.0, 50.0, 1e-3}, 2.5};
  key.run = run;
  key.seed = std::numeric_limits<std::uint64_t>::max();
  return key;
}

TrialResult result_of(double ate) {
  TrialResult result;
  result.ate = ate;
  result.end_error = std::numeric_limits<double>::infinity();
  result.nll = -1.0 / 3.0;
  result.nis = std::numeric_limits<double>::denorm_min();
  result.nis_dof = std::numeric_limits<std::uint64_t>::max();
  result.horizon_nll = -1.0 / 7.0;
  result.horizon_nis = 1.0 / 9.0;
  result.horizon_dof = 1e-300;
  result.horizon_share = 2.0 / 11.0;
  result.scans = std::numeric_limits<std::uint32_t>::max();
  result.diverged = true;
  return result;
}

bool same_bits(double a, double b) { return std::memcmp(&a, &b, sizeof(a)) == 0; }

std::string refusal(const std::string& path) {
  try {
    TrialStore store(path);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

void run_sql(const std::string& path, const char* sql) {
  sqlite3* file = nullptr;
  ASSERT_EQ(sqlite3_open(path.c_str(), &file), SQLITE_OK);
  EXPECT_EQ(sqlite3_exec(file, sql, nullptr, nullptr, nullptr), SQLITE_OK) << sqlite3_errmsg(file);
  sqlite3_close(file);
}

TEST(TrialStore, GivesResultsBackToTheLastBitAlsoWhenItIsOpenedAgain) {
  const TemporaryDirectory directory;
  const std::string path = directory.file("trials.db");
  TrialResult expected = result_of(0.1 + 0.2);
  TrialStore(path).put(key_of(3), expected);
  const TrialStore store(path);
  const auto found = store.find(key_of(3));
  ASSERT_TRUE(found);
  EXPECT_TRUE(same_bits(found->ate, expected.ate));
  EXPECT_TRUE(same_bits(found->end_error, expected.end_error));
  EXPECT_TRUE(same_bits(found->nll, expected.nll));
  EXPECT_TRUE(same_bits(found->nis, expected.nis));
  EXPECT_EQ(found->nis_dof, expected.nis_dof);
  EXPECT_TRUE(same_bits(found->horizon_nll, expected.horizon_nll));
  EXPECT_TRUE(same_bits(found->horizon_nis, expected.horizon_nis));
  EXPECT_TRUE(same_bits(found->horizon_dof, expected.horizon_dof));
  EXPECT_TRUE(same_bits(found->horizon_share, expected.horizon_share));
  EXPECT_EQ(found->scans, expected.scans);
  EXPECT_TRUE(found->diverged);
}

TEST(TrialStore, KeepsAResultWithoutATruth) {
  const TemporaryDirectory directory;
  TrialStore store(directory.file("trials.db"));
  store.put(key_of(0), TrialResult{});
  const auto found = store.find(key_of(0));
  ASSERT_TRUE(found);
  EXPECT_TRUE(std::isnan(found->ate));
  EXPECT_TRUE(std::isnan(found->end_error));
  EXPECT_EQ(found->nll, 0.0);
  EXPECT_FALSE(found->diverged);
}

TEST(TrialStore, TellsKeysApartByEveryPart) {
  const TemporaryDirectory directory;
  TrialStore store(directory.file("trials.db"));
  const TrialKey key = key_of(1);
  store.put(key, result_of(1.0));
  std::vector<TrialKey> others(9, key);
  others[0].problem += "0";
  others[1].bag += "0";
  others[2].setting.imu.k_g = std::nextafter(key.setting.imu.k_g, 1.0);
  others[3].setting.imu.k_a = std::nextafter(key.setting.imu.k_a, 1.0);
  others[4].setting.imu.k_gb = std::nextafter(key.setting.imu.k_gb, 1.0);
  others[5].setting.imu.k_ab = std::nextafter(key.setting.imu.k_ab, 1.0);
  others[6].setting.k_r = std::nextafter(key.setting.k_r, 1.0);
  others[7].run = 2;
  others[8].seed = 7;
  for (const TrialKey& other : others) EXPECT_FALSE(store.find(other));
  store.put(key, result_of(2.0));
  EXPECT_EQ(store.find(key)->ate, 2.0) << "put() replaces";
  EXPECT_EQ(store.size(), 1U);
}

TEST(TrialStore, TheUnperturbedRunDoesNotDependOnTheSeed) {
  const TemporaryDirectory directory;
  TrialStore store(directory.file("trials.db"));
  store.put(key_of(0), result_of(1.0));
  TrialKey other = key_of(0);
  other.seed = 1;
  EXPECT_TRUE(store.find(other));
}

TEST(TrialStore, RefusesWhatIsNoStoreAndLeavesItAsItIs) {
  const TemporaryDirectory directory;
  const std::string text = directory.file("notes.txt"), other = directory.file("other.db");
  std::ofstream(text) << std::string(2000, 'x');
  run_sql(other, "CREATE TABLE songs (name TEXT)");
  EXPECT_NE(refusal(text).find("notes.txt: cannot be used: file is not a database"), std::string::npos)
      << refusal(text);
  EXPECT_NE(refusal(other).find("other.db: is an SQLite file, but not a trial store"), std::string::npos)
      << refusal(other);
  run_sql(other, "SELECT name FROM songs");
  EXPECT_NE(refusal(directory.file("missing/trials.db")).find("missing/trials.db: cannot be opened"),
            std::string::npos);
  EXPECT_NE(refusal(directory.path()).find(directory.path() + ": cannot be opened"), std::string::npos);
}

TEST(TrialStore, RefusesANewerFormatByItsNumber) {
  const TemporaryDirectory directory;
  const std::string path = directory.file("trials.db");
  TrialStore(path).put(key_of(0), result_of(1.0));
  run_sql(path, "PRAGMA user_version = 3");
  EXPECT_NE(refusal(path).find("format 3, and this program knows format 2 only"), std::string::npos) << refusal(path);
}

/// Runs `work` in a child process, which is killed without warning if it comes back.
template <class Work>
pid_t in_a_child(const Work& work) {
  const pid_t child = fork();
  if (child != 0) return child;
  try {
    work();
  } catch (const std::exception&) {
    _exit(1);
  }
  kill(getpid(), SIGKILL);
  _exit(2);
}

TEST(TrialStore, TwoProcessesWriteAtOnceAndAKillLosesNothingThatWasPut) {
  constexpr std::uint32_t kEach = 200;
  const TemporaryDirectory directory;
  const std::string path = directory.file("trials.db");
  std::vector<pid_t> children;
  for (std::uint32_t part = 0; part < 2; ++part)
    children.push_back(in_a_child([&] {
      TrialStore store(path);
      for (std::uint32_t i = 0; i < kEach; ++i) store.put(key_of(1 + part * kEach + i), result_of(i));
    }));
  for (const pid_t child : children) {
    int status = 0;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    EXPECT_TRUE(WIFSIGNALED(status)) << "the child met an error";
  }
  const TrialStore store(path);
  EXPECT_EQ(store.size(), 2 * kEach);
  for (std::uint32_t i = 0; i < kEach; ++i) EXPECT_EQ(store.find(key_of(1 + kEach + i))->ate, i);
}

}  // namespace
}  // namespace allan_lio
