#include "kinloop/slam/options.hpp"

#include <limits>
#include <set>

#include <gmock/gmock.h>

#include "kinloop/slam/slam.hpp"
#include "tests/support/expect_error.hpp"

namespace kinloop {
namespace {

using test::usage_error;
using testing::AllOf;
using testing::HasSubstr;

RgbdCamera any_camera() {
  RgbdCamera camera;
  camera.color = {64, 48, 50, 50, 31.5, 23.5, {}};
  return camera;
}

std::string error_of(const SlamOptions& options) {
  return usage_error([&] { const Slam slam(any_camera(), options); });
}

TEST(SlamOptions, SlamRejectsValuesOutOfRange) {
  SlamOptions options;
  options.features.count = 1;
  EXPECT_THAT(error_of(options),
              AllOf(HasSubstr("features.count"), HasSubstr("'1'"), HasSubstr("from 50 to 20000")));
}

TEST(SlamOptions, SlamRejectsNonFiniteNumbers) {
  SlamOptions options;
  options.noise.inverse_depth_sigma_per_m = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(error_of(options), AllOf(HasSubstr("noise.inverse_depth_sigma_per_m"), HasSubstr("'nan'")));
}

TEST(SlamOptions, SlamRejectsInvalidEnumValues) {
  SlamOptions options;
  options.executor.mode = static_cast<ExecutorMode>(9);
  EXPECT_THAT(error_of(options), AllOf(HasSubstr("executor.mode"), HasSubstr("one of inline, lagged, live")));
}

TEST(SlamOptions, MaximumThreadCountIsAllowed) {
  SlamOptions options;
  options.global_ba.threads = 1024;  // maximum of --threads
  EXPECT_NO_THROW(validate(options));
}

TEST(SlamOptions, NoiseReachesTheSensor) {
  SlamOptions options;
  options.noise.robust_width = 2;
  const Slam slam(any_camera(), options);
  EXPECT_EQ(slam.sensor().noise.robust_width, 2);
}

}  // namespace
}  // namespace kinloop
