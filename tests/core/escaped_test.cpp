#include "kinloop/core/text/escaped.hpp"

#include <gtest/gtest.h>

namespace kinloop {
namespace {

TEST(Escaped, ControlCharactersOfAsciiAndUnicodeAreShown) {
  EXPECT_EQ(escaped("a\033[2Jb"), "a\\x1b[2Jb");
  EXPECT_EQ(escaped("a\nb\x7f"), "a\\nb\\x7f");
  EXPECT_EQ(escaped("\xC2\x9B"
                    "31m"),
            "\\xc2\\x9b"
            "31m");  // U+009B, CSI
  EXPECT_EQ(escaped("\xE2\x80\xAE"
                    "gpj"),
            "\\xe2\\x80\\xae"
            "gpj");  // U+202E
  EXPECT_EQ(escaped("Zimmer \xC3\xA4, \xE2\x82\xAC"), "Zimmer \xC3\xA4, \xE2\x82\xAC");
}

TEST(Escaped, BytesThatAreNotUtf8AreShownAndThoseOfCharactersStay) {
  EXPECT_EQ(escaped("a\x9b"
                    "31m"),
            "a\\x9b"
            "31m");                                                            // CSI of Latin-1
  EXPECT_EQ(escaped("\xC4\x9B\xF0\x9F\x98\x80"), "\xC4\x9B\xF0\x9F\x98\x80");  // U+011B, U+1F600
  EXPECT_EQ(escaped("\xC4"), "\\xc4");                                         // truncated
  EXPECT_EQ(escaped("\xE0\x82\x9B"), "\\xe0\\x82\\x9b");                       // longer than needed
  EXPECT_EQ(escaped("\xED\xA0\x80"), "\\xed\\xa0\\x80");                       // a surrogate
  EXPECT_EQ(escaped("\xF4\x90\x80\x80"), "\\xf4\\x90\\x80\\x80");              // above U+10FFFF
}

TEST(Escaped, KeptCharactersStay) {
  EXPECT_EQ(escaped("a\nb\t\033", "\n\t"), "a\nb\t\\x1b");
}

TEST(EscapedMarkup, IsContentAndAttributeOfHtmlAndXml) {
  EXPECT_EQ(escaped_markup("<a> & \"b\""), "&lt;a&gt; &amp; &quot;b&quot;");
  EXPECT_EQ(escaped_markup("Küche\n\t2"), "Küche\n\t2");
  EXPECT_EQ(escaped_markup("a\033\x01z"), "az");  // XML forbids control characters
}

}  // namespace
}  // namespace kinloop
