// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/printable.h>

#include <gtest/gtest.h>

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

TEST(Exception, SaysWhatItCitesInOneLine)
{
  EXPECT_STREQ(BadInputException("key '\x1B]0;x\n'").what(), "key '\\x1B]0;x\\x0A'");
}

} // namespace pcl_semantic
