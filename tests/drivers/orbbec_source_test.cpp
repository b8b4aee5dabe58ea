#include "drivers/orbbec/orbbec_source.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/expect_error.hpp"

namespace kinloop {
namespace {

TEST(Orbbec, SaysWhatIsMissing) {
  if (orbbec_available()) {
    EXPECT_THAT(test::input_error([] { open_orbbec({}, {}); }), testing::HasSubstr("no camera found"));
  } else {
    EXPECT_THAT(test::usage_error([] { open_orbbec({}, {}); }), testing::HasSubstr("OrbbecSDK"));
  }
}

}  // namespace
}  // namespace kinloop
