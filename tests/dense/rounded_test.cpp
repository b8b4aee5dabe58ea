#include "dense/rounded.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace kinloop {
namespace {

TEST(Rounded, IsTheSameAsLround) {
  for (const float value : {0.0F, 0.5F, 1.5F, 2.5F, 126.5F, 65279.5F, 254.49998F}) {
    for (const float towards : {0.0F, value, 1e9F}) {
      const float close = std::nextafter(value, towards);
      EXPECT_EQ(rounded(close), std::lround(close)) << close;
      EXPECT_EQ(rounded(-close), std::lround(-close)) << close;
    }
  }
}

}  // namespace
}  // namespace kinloop
