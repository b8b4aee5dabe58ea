#include "kinloop/core/text/did_you_mean.hpp"

#include <gmock/gmock.h>

namespace kinloop {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

const std::vector<std::string> kCommands{"run", "map", "mesh", "simulate", "info"};
const std::vector<std::string> kKeys{"features.count", "dense.voxel_m", "mesh.voxel_m", "seed"};

TEST(DidYouMean, NamesAWordThatIsNear) {
  EXPECT_EQ(did_you_mean("simulte", kCommands), "; did you mean 'simulate'?");
  EXPECT_EQ(did_you_mean("rnu", kCommands), "; did you mean 'run'?") << "a transposition is one edit";
  EXPECT_EQ(did_you_mean("inof", kCommands), "; did you mean 'info'?");
  EXPECT_EQ(did_you_mean("features.cuont", kKeys), "; did you mean 'features.count'?");
}

TEST(DidYouMean, SuggestsNothingIfNoWordIsNear) {
  for (const char* far : {"foo", "x", "go", "render", "emulation", ""}) {
    EXPECT_THAT(did_you_mean(far, kCommands), IsEmpty()) << far;
  }
  EXPECT_THAT(did_you_mean(std::string(size_t{1} << 24, 'a'), kKeys), IsEmpty()) << "and at once";
  EXPECT_THAT(did_you_mean("run", {}), IsEmpty());
}

TEST(DidYouMean, KnowsTheLastPartOfAKey) {
  EXPECT_EQ(did_you_mean("voxel_m", kKeys), "; did you mean 'dense.voxel_m' or 'mesh.voxel_m'?");
  EXPECT_THAT(did_you_mean("voxel", kKeys), IsEmpty());
}

}  // namespace
}  // namespace kinloop
