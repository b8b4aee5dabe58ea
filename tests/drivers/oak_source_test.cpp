#include "drivers/oak/oak_source.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/expect_error.hpp"

namespace kinloop {
namespace {

TEST(Oak, SaysWhatIsMissing) {
  if (oak_available()) {
    EXPECT_THAT(test::input_error([] { open_oak({}, {}); }), testing::HasSubstr("no camera found"));
  } else {
    EXPECT_THAT(test::usage_error([] { open_oak({}, {}); }), testing::HasSubstr("depthai"));
  }
}

}  // namespace
}  // namespace kinloop
