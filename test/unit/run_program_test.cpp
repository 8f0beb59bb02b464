// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/io/run_program.h"

#include <gtest/gtest.h>

#include <chrono>
#include <stdexcept>
#include <thread>

namespace allan_lio {
namespace {

TEST(RunProgram, GivesBothOutputsAndTheStatusAndTakesWordsAsTheyAre) {
  const ProgramOutcome outcome =
      run_program({"sh", "-c", "printf '%s' \"$1\"; echo trouble >&2; exit 3", "x", "a $b 'c'"});
  EXPECT_EQ(outcome.status, 3);
  EXPECT_EQ(outcome.output, "a $b 'c'");
  EXPECT_EQ(outcome.errors, "trouble\n");
}

TEST(RunProgram, MuchOutputOnBothSidesDoesNotStopIt) {
  const ProgramOutcome outcome = run_program({"sh", "-c", "head -c 300000 /dev/zero >&2; head -c 300000 /dev/zero"});
  EXPECT_EQ(outcome.output.size(), 300000U);
  EXPECT_EQ(outcome.errors.size(), 300000U);
}

TEST(RunProgram, AProgramThatIsNotThereIsNamed) {
  try {
    run_program({"/nowhere/at_all"});
    FAIL() << "no error";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("/nowhere/at_all"), std::string::npos) << error.what();
  }
}

TEST(RunProgram, IsEndedByTheStopFlag) {
  std::atomic<bool> stop{false};
  std::thread later([&stop] {
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    stop = true;
  });
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_EQ(run_program({"sleep", "60"}, &stop).status, -1);
  later.join();
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(30));
}

TEST(RunProgram, AWordComesThroughTheShell) {
  const std::string word = "it's $HOME \"and\" `more`\\";
  EXPECT_EQ(run_program({"sh", "-c", "printf %s " + shell_quoted(word)}).output, word);
}

}  // namespace
}  // namespace allan_lio
