#include "kinloop/core/time.hpp"

#include <gtest/gtest.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/random.hpp"

namespace kinloop {
namespace {

TEST(ParseStamp, ParsesExactly) {
  EXPECT_EQ(parse_stamp_ns("1305031910.765238"), 1305031910765238000);
  EXPECT_EQ(parse_stamp_ns("1305031910.765238001"), 1305031910765238001);
  EXPECT_EQ(parse_stamp_ns("0.1"), 100000000);
  EXPECT_EQ(parse_stamp_ns("1000"), 1000000000000);
  EXPECT_EQ(parse_stamp_ns("5."), 5000000000);
  EXPECT_EQ(parse_stamp_ns(".5"), 500000000);
  EXPECT_EQ(parse_stamp_ns("-0.25"), -250000000);
  EXPECT_EQ(parse_stamp_ns("-3.000000001"), -3000000001);
  EXPECT_EQ(parse_stamp_ns("0.1234567899"), 123456789);  // digits below a nanosecond are truncated
  EXPECT_EQ(parse_stamp_ns("2305843009"), 2305843009000000000);
}

TEST(ParseStamp, TakesExponents) {
  EXPECT_EQ(parse_stamp_ns("1.5e3"), 1500000000000);
  EXPECT_EQ(parse_stamp_ns("2E-3"), 2000000);
  EXPECT_EQ(parse_stamp_ns("-1e0"), -1000000000);
}

TEST(ParseStamp, RejectsWhatIsNotAFiniteDecimalNumber) {
  for (const char* text : {"",
                           ".",
                           "-",
                           "-.",
                           "--1",
                           "1-2",
                           "1.-0",
                           "1.2.3",
                           "1.123456789-5",
                           "1.12345678912.5",
                           "nan",
                           "-nan",
                           "inf",
                           "-inf",
                           "1e400",
                           "1e30",
                           "2305843010",
                           "-2305843010",
                           "2.4e9",
                           "9000000001",
                           "99999999999999999999999",
                           "-9999999999",
                           "12abc",
                           "abc",
                           "1,5",
                           " 1",
                           "1 ",
                           "0x10",
                           "+-1"}) {
    EXPECT_FALSE(parse_stamp_ns(text)) << "'" << text << "'";
  }
}

TEST(SplitStamp, RoundsDown) {
  for (const int64_t stamp_ns :
       {int64_t{0}, int64_t{-1}, int64_t{1}, -kNsPerSecond, 1 - kNsPerSecond, -kMaxStampNs}) {
    const auto [seconds, nanoseconds] = split_stamp(stamp_ns);
    EXPECT_EQ(seconds * kNsPerSecond + nanoseconds, stamp_ns);
    EXPECT_GE(nanoseconds, 0);
    EXPECT_LT(nanoseconds, kNsPerSecond);
  }
}

TEST(CheckedStamp, RefusesStampsWhoseDifferencesOverflow) {
  EXPECT_EQ(checked_stamp_ns(-kMaxStampNs), -kMaxStampNs);
  for (const int64_t stamp_ns : {kMaxStampNs + 1, -kMaxStampNs - 1, std::numeric_limits<int64_t>::min(),
                                 std::numeric_limits<int64_t>::max()})
    EXPECT_THROW(checked_stamp_ns(stamp_ns), InputError);
}

TEST(FormatStamp, HasSixDecimalsAndMoreOnlyWhereNeeded) {
  EXPECT_EQ(format_stamp(1305031910765238000), "1305031910.765238");
  EXPECT_EQ(format_stamp(0), "0.000000");
  EXPECT_EQ(format_stamp(1), "0.000000001");
  EXPECT_EQ(format_stamp(-250000000), "-0.250000");
}

TEST(FormatStamp, ParsesBackToTheSameStamp) {
  Random random(1);
  for (int i = 0; i < 10000; ++i) {
    const auto magnitude = static_cast<int64_t>(random.next() % uint64_t{kMaxStampNs});
    const int64_t stamp_ns = i % 2 == 0 ? magnitude : -(magnitude >> (i % 60));
    ASSERT_EQ(parse_stamp_ns(format_stamp(stamp_ns)), stamp_ns);
  }
}

TEST(Seconds, RoundTrip) {
  EXPECT_EQ(to_ns(0.02), 20000000);
  EXPECT_EQ(to_ns(-1.5), -1500000000);
  EXPECT_EQ(to_ns(1e-9 * 0.6), 1);
  EXPECT_DOUBLE_EQ(to_seconds(33333333), 0.033333333);
}

}  // namespace
}  // namespace kinloop
