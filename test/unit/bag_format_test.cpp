// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/ros/bag_format.h"

#include <bzlib.h>
#include <gtest/gtest.h>
#include <roslz4/lz4s.h>

#include <string>
#include <vector>

#include "allocation_count.h"

namespace allan_lio {
namespace bag_format {
namespace {

constexpr std::size_t kMegabyte = std::size_t{1} << 20U;

std::vector<char> pack(const std::string& compression, std::vector<char> bytes) {
  std::vector<char> packed(bytes.size() + 1000);
  auto size = static_cast<unsigned>(packed.size());
  const auto length = static_cast<unsigned>(bytes.size());
  if (compression == "bz2")
    EXPECT_EQ(BZ2_bzBuffToBuffCompress(packed.data(), &size, bytes.data(), length, 9, 0, 30), BZ_OK);
  else
    EXPECT_EQ(roslz4_buffToBuffCompress(bytes.data(), length, packed.data(), &size, 6), ROSLZ4_OK);
  packed.resize(size);
  return packed;
}

/// What packs badly, with a long run of noughts in its midst, which packs to next to nothing.
std::vector<char> noise_and_noughts() {
  std::vector<char> bytes(9 * kMegabyte);
  std::uint32_t state = 1;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    state = state * 1664525U + 1013904223U;
    if (i < 100000 || i > bytes.size() - 100000) bytes[i] = static_cast<char>(state >> 24U);
  }
  return bytes;
}

class BagChunk : public ::testing::TestWithParam<const char*> {};

TEST_P(BagChunk, UnpacksToWhatWasPacked) {
  const std::vector<char> bytes = noise_and_noughts();
  std::vector<char> packed = pack(GetParam(), bytes), unpacked;
  EXPECT_TRUE(unpack_chunk(GetParam(), packed, bytes.size(), unpacked));
  EXPECT_EQ(unpacked, bytes);
  EXPECT_FALSE(unpack_chunk(GetParam(), packed, bytes.size() - 1, unpacked)) << "there is more than was announced";
  EXPECT_FALSE(unpack_chunk(GetParam(), packed, bytes.size() + 1, unpacked)) << "there is less than was announced";
  EXPECT_EQ(unpacked, bytes);
}

TEST_P(BagChunk, OfPackedDataThatAreCutOffGivesWhatCanBeUnpacked) {
  const std::vector<char> bytes = noise_and_noughts();
  std::vector<char> packed = pack(GetParam(), bytes), unpacked;
  packed.resize(packed.size() - 10);
  EXPECT_FALSE(unpack_chunk(GetParam(), packed, bytes.size(), unpacked));
  ASSERT_GT(unpacked.size(), kMegabyte / 2);
  ASSERT_LE(unpacked.size(), bytes.size());
  EXPECT_TRUE(std::equal(unpacked.begin(), unpacked.end(), bytes.begin()));
}

TEST_P(BagChunk, MakesNoRoomForWhatIsOnlyAnnounced) {
  if (!bytes_allocated()) GTEST_SKIP() << "not counted under a sanitizer";
  std::vector<char> packed = pack(GetParam(), std::vector<char>(1000, 'x')), unpacked;
  const std::size_t before = *bytes_allocated();
  EXPECT_FALSE(unpack_chunk(GetParam(), packed, kLargestChunk, unpacked));
  EXPECT_LT(*bytes_allocated() - before, 8 * kMegabyte) << "the decoder's own buffers are some megabytes";
  EXPECT_EQ(unpacked, std::vector<char>(1000, 'x'));
}

INSTANTIATE_TEST_SUITE_P(, BagChunk, ::testing::Values("bz2", "lz4"));

TEST(BagChunkOfNoCompression, ThatIsKnownUnpacksToNothing) {
  std::vector<char> packed(10), unpacked(10);
  EXPECT_FALSE(unpack_chunk("zip", packed, 10, unpacked));
  EXPECT_TRUE(unpacked.empty());
}

}  // namespace
}  // namespace bag_format
}  // namespace allan_lio
