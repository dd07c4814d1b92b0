// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/printable.h>

#include <gtest/gtest.h>

#include <string>
#include <tuple>
#include <vector>

namespace pcl_semantic {

TEST(Printable, EscapesWhatMovesACursorAndWhatIsNoUtf8)
{
  EXPECT_EQ(printable("road 7"), "road 7");
  EXPECT_EQ(printable("Stra\xC3\x9F"
                      "e \xE2\x82\xAC \xF0\x9F\x98\x80"),
            "Stra\xC3\x9F"
            "e \xE2\x82\xAC \xF0\x9F\x98\x80");
  EXPECT_EQ(printable("\x1B[2Ja\nb\x7F"), "\\x1B[2Ja\\x0Ab\\x7F");
  EXPECT_EQ(printable("a\nb\t", true), "a\nb\\x09");
  EXPECT_EQ(printable("\xC2\x9B"
                      "1m"),
            "\\xC2\\x9B1m")
      << "a control character of two bytes";
  EXPECT_EQ(printable("\xE9 \xC3"), "\\xE9 \\xC3");
  EXPECT_EQ(printable(std::string(1, '\0')), "\\x00");
}

TEST(Printable, EscapesWhatChangesLinesOrTheirDirection)
{
  for (const auto& [hidden, text, json] :
       std::vector<std::tuple<std::string, std::string, std::string>>{
           {"\x7F", "\\x7F", "\\u007F"},
           {"\xC2\x9B", "\\xC2\\x9B", "\\u009B"},
           {"\xD8\x9C", "\\xD8\\x9C", "\\u061C"},
           {"\xE2\x80\x8E", "\\xE2\\x80\\x8E", "\\u200E"},
           {"\xE2\x80\xA8", "\\xE2\\x80\\xA8", "\\u2028"},
           {"\xE2\x80\xAE", "\\xE2\\x80\\xAE", "\\u202E"},
           {"\xE2\x81\xA9", "\\xE2\\x81\\xA9", "\\u2069"}}) {
    EXPECT_EQ(printable("a" + hidden + "b"), "a" + text + "b");
    EXPECT_EQ(printableJson("{\n\"" + hidden + "\"}"), "{\n\"" + json + "\"}");
  }
  // Surrogates, overlong forms and what lies beyond Unicode are no UTF-8.
  for (const std::string bad : {"\xED\xA0\x80", "\xE0\x80\xAF", "\xF4\x90\x80\x80"})
    EXPECT_EQ(printable(bad).substr(0, 2), "\\x") << printable(bad);
  EXPECT_EQ(printableJson("\"\xC3\x9F\""), "\"\xC3\x9F\"");
}

TEST(Exception, SaysWhatItCitesInOneLine)
{
  EXPECT_STREQ(BadInputException("key '\x1B]0;x\n'").what(), "key '\\x1B]0;x\\x0A'");
}

} // namespace pcl_semantic
