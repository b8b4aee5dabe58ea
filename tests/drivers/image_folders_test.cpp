// Folders of images without a list of frames: their names, and which images belong together.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "drivers/datasets/layouts/layouts.hpp"
#include "drivers/datasets/open_sequence.hpp"
#include "tests/drivers/sequence_folder.hpp"
#include "tests/support/temp_folder.hpp"

namespace kinloop {
namespace {

using test::TempFolder;

/// "rgb/0 depth/0, ...": the pairs of a folder with these files.
std::string pairs_of(const std::vector<std::string>& files, size_t* skipped = nullptr) {
  const TempFolder folder;
  for (const std::string& name : files) folder.write(name, test::encoded(test::make_color(1), ".png"));
  folder.write("camera.yaml", test::kSmallCamera);
  const RecordedSequence sequence = read_sequence(folder.path()).sequence;
  std::string pairs;
  for (const RecordedFrame& frame : sequence.frames)
    pairs += fmt::format("{} {}, ", std::filesystem::relative(frame.color.file, folder.path()).string(),
                         std::filesystem::relative(frame.depth.file, folder.path()).string());
  if (skipped != nullptr) *skipped = sequence.skipped.size();
  return pairs;
}

TEST(FolderNames, OfColourAndDepthMayBeAnyOfTheUsualOnes) {
  for (const char* color : {"rgb", "color", "colors", "image", "images", "imgs"}) {
    for (const char* depth : {"depth", "depths", "depth_png"}) {
      EXPECT_EQ(pairs_of({fmt::format("{}/1.png", color), fmt::format("{}/1.png", depth)}),
                fmt::format("{}/1.png {}/1.png, ", color, depth));
    }
  }
}

TEST(FlatFolder, IsPairedByTheNamesOfItsImages) {
  EXPECT_EQ(pairs_of({"2_color.png", "2_depth.png", "10_color.png", "10_depth.png"}),
            "2_color.png 2_depth.png, 10_color.png 10_depth.png, ");
  EXPECT_EQ(pairs_of({"a1_rgb.png", "a1_depth.png"}), "a1_rgb.png a1_depth.png, ");
  EXPECT_EQ(pairs_of({"color_0000.png", "depth_0000.png", "color_0001.png", "depth_0001.png"}),
            "color_0000.png depth_0000.png, color_0001.png depth_0001.png, ");
  EXPECT_EQ(pairs_of({"rgb-3.png", "depth-3.png"}), "rgb-3.png depth-3.png, ");
  const TempFolder folder;
  folder.write("color.png", "");
  folder.write("depth.png", "");
  EXPECT_EQ(recognise_layout(folder.path()), nullptr);
}

TEST(FoldersWithoutLists, ImagesOfOneSideAreSkippedAndCounted) {
  size_t skipped = 0;
  EXPECT_EQ(pairs_of({"rgb/1.png", "rgb/2.png", "rgb/10.png", "depth/2.png", "depth/3.png", "depth/10.png"},
                     &skipped),
            "rgb/2.png depth/2.png, rgb/10.png depth/10.png, ");
  EXPECT_EQ(skipped, 2U);
  EXPECT_EQ(pairs_of({"rgb/1-color.png", "rgb/2-color.png", "depth/2-depth.png"}, &skipped),
            "rgb/2-color.png depth/2-depth.png, ");
  EXPECT_EQ(skipped, 1U);
}

}  // namespace
}  // namespace kinloop
