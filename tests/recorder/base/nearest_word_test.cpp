// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/base/text_words.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>
#include "tests/support/message.h"

namespace calot::recorder {
namespace {

const std::vector<std::string> commands{"record", "recover", "replay", "render", "regrade", "study", "participant"};

TEST(ShownWord, KeepsLettersAndMasksWhatHidesOrTurns) {
  EXPECT_EQ(shown("Müller 日本 µm"), "Müller 日本 µm");
  EXPECT_EQ(shown("\xD7\x8F"), "\xD7\x8F");  // assigned by no version of Unicode yet
  for (const char* hidden : {"\n",     "\x7F",   "\u0085", "\u00A0", "\u00AD",     "\u0600",     "\u061C", "\u06DD",
                             "\u070F", "\u0890", "\u08E2", "\u1680", "\u180E",     "\u200F",     "\u2028", "\u202E",
                             "\u2066", "\u3000", "\uE000", "\uFEFF", "\U0001D173", "\U000E0001", "\xFF"})
    EXPECT_EQ(shown(std::string("a") + hidden + "b"), "a?b");
  EXPECT_EQ(shown("\xED\xA0\x80"), "???");  // half of a pair of UTF-16
  EXPECT_EQ(shown("日本日本", 3), "日本日...");
}

TEST(NearestWord, DistancesCountEachMistakeOnce) {
  EXPECT_EQ(wordDistance("", ""), 0U);
  EXPECT_EQ(wordDistance("abc", ""), 3U);
  EXPECT_EQ(wordDistance("record", "record"), 0U);
  EXPECT_EQ(wordDistance("recrod", "record"), 1U);  // exchanged
  EXPECT_EQ(wordDistance("recod", "record"), 1U);   // left out
  EXPECT_EQ(wordDistance("recoord", "record"), 1U);
  EXPECT_EQ(wordDistance("rekord", "record"), 1U);
  EXPECT_EQ(wordDistance("kitten", "sitting"), 3U);
  EXPECT_EQ(wordDistance("record", "recover"), wordDistance("recover", "record"));
}

TEST(NearestWord, IsTheOneThatWasMeant) {
  EXPECT_EQ(nearestWord("recrod", commands), "record");
  EXPECT_EQ(nearestWord("stduy", commands), "study");
  EXPECT_EQ(nearestWord("STUDY", commands), "study");
  EXPECT_EQ(nearestWord("partici", commands), "participant");  // its beginning
}

TEST(NearestWord, IsNoneWhereNothingIsNear) {
  EXPECT_EQ(nearestWord("xyzzy", commands), "");
  EXPECT_EQ(nearestWord("re", commands), "");  // the beginning of many
  EXPECT_EQ(nearestWord("", commands), "");
  EXPECT_EQ(nearestWord("study", commands), "");  // it is right
  EXPECT_EQ(nearestWord(std::string(1000000, 'r'), commands), "");
  EXPECT_EQ(nearestWord("study", {}), "");
}

TEST(NearestWord, IsAskedAfter) {
  expectNames(didYouMean("recrod", commands), {"\"record\""});
  EXPECT_EQ(didYouMean("xyzzy", commands), "");
  EXPECT_EQ(didYouMean("c", {"a", "b"}), "") << "every letter is another one";
  expectNames(didYouMean("ab", {"a\rb"}), {"\"a?b\""});  // as text
}

}  // namespace
}  // namespace calot::recorder
