#include "tools/export/grid_file.hpp"

#include <filesystem>

#include <gmock/gmock.h>

#include "kinloop/core/files/text_file.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/temp_folder.hpp"

namespace kinloop {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

TEST(GridFile, IsWhatMapServerReads) {
  const test::TempFolder folder;
  OccupancyGrid grid{0.05, -1, 2, 2, 2, {}};
  grid.cells = {Occupancy::kFree, Occupancy::kOccupied, Occupancy::kUnknown, Occupancy::kFree};
  write_grid(folder.path() / "g.pgm", grid);
  const std::string picture = read_file(folder.path() / "g.pgm");
  EXPECT_THAT(picture, StartsWith("P5\n"));
  // The row with the largest y comes first.
  EXPECT_EQ(picture.substr(picture.size() - 4), std::string("\xcd\xfe\xfe\x00", 4));
  EXPECT_EQ(read_file(folder.path() / "g.yaml"),
            "image: \"g.pgm\"\nresolution: 0.05\norigin: [-1, 2, 0.0]\nnegate: 0\noccupied_thresh: 0.65\n"
            "free_thresh: 0.196\n");
  EXPECT_NO_THROW(write_grid(folder.path() / "g.pgm", grid));  // again
}

TEST(GridFile, ReplacesNoOtherFile) {
  const test::TempFolder folder;
  folder.write("camera.yaml", "width: 640\n");
  const OccupancyGrid grid{0.05, 0, 0, 1, 1, {Occupancy::kFree}};
  EXPECT_THAT(test::input_error([&] { write_grid(folder.path() / "camera.pgm", grid); }),
              HasSubstr("camera.yaml: the description of the grid would replace this file"));
  EXPECT_EQ(read_file(folder.path() / "camera.yaml"), "width: 640\n");
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "camera.pgm"));
}

}  // namespace
}  // namespace kinloop
