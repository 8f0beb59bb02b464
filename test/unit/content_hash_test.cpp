// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/io/content_hash.h"

#include <gtest/gtest.h>

namespace allan_lio {
namespace {

TEST(ContentHash, IsFnv1aInHexadecimalDigits) {
  EXPECT_EQ(hash_text(""), "cbf29ce484222325");
  EXPECT_EQ(hash_text("a"), "af63dc4c8601ec8c");
  EXPECT_EQ(hash_text("foobar"), "85944171f73967e8");
}

TEST(ContentHash, OfTheBuildStaysTheSameAsLongAsTheProgramDoes) {
  EXPECT_EQ(build_hash().size(), 16U);
  EXPECT_EQ(build_hash(), build_hash());
  EXPECT_NE(build_hash(), hash_text("")) << "the file has content";
}

}  // namespace
}  // namespace allan_lio
