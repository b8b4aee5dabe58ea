// The order of the rooms is law: layers.txt says who may include whom, and this test reads every #include.

#include <gmock/gmock.h>

#include "tests/layers/layer_check.hpp"
#include "tests/support/temp_folder.hpp"

namespace kinloop::test {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

const std::filesystem::path kRoot = KINLOOP_SOURCE_DIR;

TEST(Layers, TheProjectKeepsToThem) {
  const auto rows = read_layers(kRoot / "layers.txt");
  ASSERT_THAT(rows, SizeIs(testing::Ge(14)));
  EXPECT_THAT(layer_violations(rows), IsEmpty());
  EXPECT_THAT(include_violations(kRoot, rows), IsEmpty());
  EXPECT_THAT(cmake_violations(kRoot, rows), IsEmpty());
}

/// A small house of three rooms in good order, into which each test plants one violation.
class Planted : public testing::Test {
 protected:
  Planted() {
    folder_.write("layers.txt", "# rows\nbase:\nsensor: base\nslam: base sensor\n");
    folder_.write("kinloop/CMakeLists.txt", "");
    folder_.write("kinloop/base/CMakeLists.txt", "kinloop_room(base LIBRARIES fmt)\n");
    folder_.write("kinloop/sensor/CMakeLists.txt", "kinloop_room(sensor ROOMS base LIBRARIES fmt)\n");
    folder_.write("kinloop/slam/CMakeLists.txt", "kinloop_room(slam ROOMS sensor\n  base)\n");
    folder_.write("kinloop/base/ids.hpp", "#include <vector>\n");
    folder_.write("kinloop/sensor/deep/frame.cpp",
                  "#include \"kinloop/sensor/frame.hpp\"\n#include \"kinloop/base/ids.hpp\"\n");
    folder_.write("kinloop/slam/slam.hpp", "#include \"kinloop/sensor/frame.hpp\"\n");
  }

  std::vector<std::string> violations() const {
    const auto rows = read_layers(folder_.path() / "layers.txt");
    auto all = layer_violations(rows);
    for (auto& line : include_violations(folder_.path(), rows)) all.push_back(line);
    for (auto& line : cmake_violations(folder_.path(), rows)) all.push_back(line);
    return all;
  }

  TempFolder folder_;
};

TEST_F(Planted, AHouseInGoodOrderHasNone) {
  EXPECT_THAT(violations(), IsEmpty());
}

TEST_F(Planted, IncludeThatTheRowDoesNotAllow) {
  folder_.write("kinloop/base/ids.cpp", "\n  #  include \"kinloop/slam/slam.hpp\"  // why not\n");
  EXPECT_THAT(violations(),
              ElementsAre(AllOf(HasSubstr("kinloop/base/ids.cpp:2:"), HasSubstr("include slam"))));
}

TEST_F(Planted, AngleBracketsHideNothing) {
  folder_.write("kinloop/sensor/frame.hpp",
                "#include <kinloop/slam/slam.hpp>\n#include <opencv2/core.hpp>\n");
  EXPECT_THAT(violations(), ElementsAre(HasSubstr("sensor/frame.hpp:1:")));
}

TEST_F(Planted, ProgramsTestsAndRelativePathsAreOutOfBounds) {
  folder_.write("kinloop/slam/slam.cpp",
                "#include \"apps/commands.hpp\"\n#include \"tests/support/temp_folder.hpp\"\n"
                "#include \"../sensor/frame.hpp\"\n#include <bench/bench.hpp>\n");
  EXPECT_THAT(violations(), SizeIs(4));
}

TEST_F(Planted, RoomWithoutRowAndRowWithoutRoom) {
  folder_.write("kinloop/attic/box.hpp", "");
  EXPECT_THAT(violations(), ElementsAre(HasSubstr("kinloop/attic")));
  std::filesystem::remove_all(folder_.path() / "kinloop/attic");
  std::filesystem::remove_all(folder_.path() / "kinloop/slam");
  EXPECT_THAT(violations(), testing::Contains(HasSubstr("slam has no folder")));
}

TEST_F(Planted, CyclesAndRowsOutOfOrder) {
  folder_.write("layers.txt", "base: slam\nsensor: base\nslam: base sensor\n");
  EXPECT_THAT(violations(), testing::Contains(HasSubstr("base names slam")));
  folder_.write("layers.txt", "base:\nsensor: base\nslam: base sensor\nbase: slam\n");
  EXPECT_THAT(violations(), testing::Contains(HasSubstr("base has two rows")));
}

TEST_F(Planted, TargetThatLinksOtherRoomsThanItMayInclude) {
  folder_.write("kinloop/sensor/CMakeLists.txt", "kinloop_room(sensor ROOMS base slam LIBRARIES fmt)\n");
  EXPECT_THAT(violations(), ElementsAre(HasSubstr("kinloop/sensor/CMakeLists.txt")));
}

TEST_F(Planted, FileOutsideOfAllRooms) {
  folder_.write("kinloop/common.hpp", "");
  EXPECT_THAT(violations(), ElementsAre(HasSubstr("kinloop/common.hpp")));
}

}  // namespace
}  // namespace kinloop::test
