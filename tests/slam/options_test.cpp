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

TEST(SlamOptions, FormerNamesAreRenamedOrRemoved) {
  SlamOptions options;
  const auto entries = option_entries(options);
  const OptionHistory history = SlamOptions::history();
  std::set<std::string> names;
  for (const RenamedOption& renamed : history.renamed) {
    EXPECT_TRUE(names.insert(renamed.before).second) << renamed.before << " is listed twice";
    if (renamed.before.ends_with(".*")) continue;
    const ResolvedKey resolved = resolve_key(entries, renamed.before, history);
    EXPECT_EQ(resolved.kind, ResolvedKey::Kind::kRenamed) << renamed.before;
  }
  for (const std::string& removed : history.removed)
    EXPECT_TRUE(names.insert(removed).second) << removed << " is listed twice";
}

TEST(SlamOptions, FormerNoiseNamesMapToTheNoiseOptions) {
  SlamOptions options;
  const auto entries = option_entries(options);
  for (const std::string group : {"full.", "global_ba.", "mapping.bundle.", "mapping.local_ba.",
                                  "tracking.pose.", "tracking.pnp.pose."}) {
    const auto resolved = resolve_key(entries, group + "robust_width", SlamOptions::history());
    EXPECT_EQ(resolved.key, "noise.robust_width") << group;
  }
  // These had intentionally different values.
  for (const std::string solver : {"rigid", "icp"}) {
    const std::string key = "tracking." + solver + ".inverse_depth_sigma_per_m";
    EXPECT_EQ(resolve_key(entries, key, SlamOptions::history()).kind, ResolvedKey::Kind::kRemoved) << solver;
  }
}

}  // namespace
}  // namespace kinloop
