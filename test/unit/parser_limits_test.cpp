// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
// Sizes that no honest file has.
#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "allan_lio/io/config_source.h"
#include "allan_lio/io/known_keys.h"
#include "allan_lio/io/line_reader.h"
#include "temporary_directory.h"

namespace allan_lio {
namespace {

TEST(ParserLimits, AKeyOfMegabytesIsRefusedWithTheNearestOneLikeAnyOther) {
  ConfigSource source;
  source["map/voxel_siz" + std::string(std::size_t{4} << 20U, 'e')] = ConfigEntry{{"1"}, false, "huge.yaml:1"};
  try {
    refuse_unknown_keys(source);
    FAIL() << "accepted";
  } catch (const ConfigError& error) {
    EXPECT_NE(std::string(error.what()).find("is not a parameter; the nearest one is '"), std::string::npos);
  }
}

TEST(ParserLimits, ALineMayBeLongerThanTheBufferAndNotLongerThanAMegabyte) {
  const TemporaryDirectory directory;
  const std::string path = directory.file("lines");
  const std::string longest((std::size_t{1} << 20U) - 1, 'x');
  std::ofstream(path) << "first\n" << longest << "\nlast\n";
  LineReader lines(path);
  TextLine line;
  ASSERT_TRUE(lines.next(line));
  ASSERT_TRUE(lines.next(line));
  EXPECT_EQ(std::string(line.begin, line.end), longest);
  ASSERT_TRUE(lines.next(line));
  EXPECT_EQ(std::string(line.begin, line.end), "last");
  EXPECT_FALSE(lines.next(line));

  std::ofstream(path) << longest << "xx\n";
  LineReader too_long(path);
  EXPECT_THROW(too_long.next(line), std::runtime_error);
}

}  // namespace
}  // namespace allan_lio
