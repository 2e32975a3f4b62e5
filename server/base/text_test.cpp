// What a caller sent is shown as it is, as far as it is text.

#include "base/text.h"

#include <gtest/gtest.h>

namespace mane::base {
namespace {

TEST(TextTest, TextIsShownAsItIs) {
  EXPECT_EQ(Shown("a hat"), "a hat");
  EXPECT_EQ(Shown("Mütze, 帽子, 🎩"), "Mütze, 帽子, 🎩");
  EXPECT_EQ(Shown(""), "");
}

TEST(TextTest, WhatIsNoTextIsReplaced) {
  EXPECT_EQ(Shown({"a\0b\nc\x7f", 6}), "a?b?c?");
  EXPECT_EQ(Shown("\xc2\x85"), "?");             // A control character.
  EXPECT_EQ(Shown("a\xff\xfe z"), "a?? z");      // No beginning of any.
  EXPECT_EQ(Shown("\xc0\xaf"), "??");            // Too long a form.
  EXPECT_EQ(Shown("\xed\xa0\x80"), "???");       // Half of a pair.
  EXPECT_EQ(Shown("\xf4\x90\x80\x80"), "????");  // Past the last.
  EXPECT_EQ(Shown("\xe5\xb8"), "??");            // Cut.
}

TEST(TextTest, LongTextIsCutBetweenCharacters) {
  EXPECT_EQ(Shown(std::string(5000, 'x')), std::string(126, 'x'));
  std::string hats, fit;
  for (int i = 0; i < 100; ++i) hats += "帽";
  for (int i = 0; i < 42; ++i) fit += "帽";
  EXPECT_EQ(Shown(hats), fit);
  std::string shifted = "a", shifted_fit = "a";
  shifted += hats;
  shifted_fit += fit.substr(0, 123);
  EXPECT_EQ(Shown(shifted), shifted_fit);
}

}  // namespace
}  // namespace mane::base
