// layers.txt says which module may include which; this test reads every #include.

#include <gmock/gmock.h>

#include "tests/layers/layer_check.hpp"
#include "tests/support/shared_data.hpp"
#include "tests/support/temp_folder.hpp"

namespace kinloop::test {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

TEST(Layers, ProjectHasNoViolations) {
  const auto rows = read_layers(source_folder() / "scripts/cmake/layers.txt");
  ASSERT_THAT(rows, SizeIs(testing::Ge(19)));
  EXPECT_THAT(layer_violations(rows), IsEmpty());
  EXPECT_THAT(include_violations(source_folder(), rows), IsEmpty());
}

/// A small project of three modules without violations, to which each test adds one.
class LayerViolations : public testing::Test {
 protected:
  LayerViolations() {
    folder_.write("layers.txt", "# rows\nkinloop/base:\nkinloop/slam: base\ndrivers: base slam\n");
    folder_.write("kinloop/base/ids.hpp", "#include <vector>\n");
    folder_.write("kinloop/slam/deep/slam.cpp",
                  "#include \"kinloop/slam/slam.hpp\"\n#include \"kinloop/base/ids.hpp\"\n");
    folder_.write("drivers/kinect.hpp", "#include \"kinloop/slam/slam.hpp\"\n");
  }

  std::vector<std::string> violations() const {
    const auto rows = read_layers(folder_.path() / "layers.txt");
    auto all = layer_violations(rows);
    for (auto& line : include_violations(folder_.path(), rows)) all.push_back(line);
    return all;
  }

  TempFolder folder_;
};

TEST_F(LayerViolations, NoneInAProjectInOrder) {
  EXPECT_THAT(violations(), IsEmpty());
}

TEST_F(LayerViolations, IncludeThatTheRowDoesNotAllow) {
  folder_.write("kinloop/base/ids.cpp", "\n  #  include \"kinloop/slam/slam.hpp\"  // why not\n");
  EXPECT_THAT(violations(),
              ElementsAre(AllOf(HasSubstr("kinloop/base/ids.cpp:2:"), HasSubstr("include slam"))));
}

TEST_F(LayerViolations, AngleBracketsHideNothing) {
  folder_.write("kinloop/slam/slam.hpp", "#include <drivers/kinect.hpp>\n#include <opencv2/core.hpp>\n");
  EXPECT_THAT(violations(), ElementsAre(HasSubstr("slam/slam.hpp:1:")));
}

TEST_F(LayerViolations, ProgramsTestsAndRelativePathsAreOutOfBounds) {
  folder_.write(
      "kinloop/slam/slam.cpp",
      "#include \"apps/shared/command_line/commands.hpp\"\n#include \"tests/support/temp_folder.hpp\"\n"
      "#include \"../base/ids.hpp\"\n#include <bench/bench.hpp>\n");
  EXPECT_THAT(violations(), SizeIs(4));
}

TEST_F(LayerViolations, FolderWithoutRowAndRowWithoutFolder) {
  folder_.write("kinloop/attic/box.hpp", "");
  EXPECT_THAT(violations(), ElementsAre(HasSubstr("kinloop/attic")));
  std::filesystem::remove_all(folder_.path() / "kinloop/attic");
  std::filesystem::remove_all(folder_.path() / "drivers");
  EXPECT_THAT(violations(), testing::Contains(HasSubstr("there is no folder drivers")));
}

TEST_F(LayerViolations, CyclesAndRowsOutOfOrder) {
  folder_.write("layers.txt", "kinloop/base: slam\nkinloop/slam: base\ndrivers: base slam\n");
  EXPECT_THAT(violations(), testing::Contains(HasSubstr("base names slam")));
  folder_.write("layers.txt", "kinloop/base:\nkinloop/slam: base\ndrivers: base slam\nkinloop/base: slam\n");
  EXPECT_THAT(violations(), testing::Contains(HasSubstr("base has two rows")));
}

TEST_F(LayerViolations, FileOutsideOfAllModules) {
  folder_.write("kinloop/common.hpp", "");
  EXPECT_THAT(violations(), ElementsAre(HasSubstr("kinloop/common.hpp")));
}

}  // namespace
}  // namespace kinloop::test
