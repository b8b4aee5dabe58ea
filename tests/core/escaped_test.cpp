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

TEST(Escaped, KeptCharactersStay) {
  EXPECT_EQ(escaped("a\nb\t\033", "\n\t"), "a\nb\t\\x1b");
}

}  // namespace
}  // namespace kinloop
