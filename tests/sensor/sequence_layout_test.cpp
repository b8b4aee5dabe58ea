#include "kinloop/sensor/sequence_layout.hpp"

#include <gmock/gmock.h>

#include "kinloop/base/advised_error.hpp"
#include "kinloop/sensor/camera_file.hpp"
#include "kinloop/sensor/folder_contents.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/temp_folder.hpp"

namespace kinloop {
namespace {

using test::input_error;
using test::TempFolder;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

std::string advice_of(const std::filesystem::path& path, bool camera_known) {
  try {
    reject_sequence(path, camera_known);
  } catch (const AdvisedError& error) {
    return error.advice();
  } catch (const InputError&) {
    return {};
  }
}

TEST(ForeignLayout, IsToldByWhatTheFolderHolds) {
  const TempFolder folder;
  const auto layout_with = [&](const char* name, std::vector<const char*> files) {
    for (const char* file : files) folder.write(std::filesystem::path(name) / file, "");
    return foreign_layout(folder.path() / name);
  };
  EXPECT_EQ(layout_with("open3d", {"color/0.jpg", "depth/0.png", "camera.json"}),
            "Redwood or Open3D (color/ depth/ camera.json)");
  EXPECT_EQ(layout_with("scannet", {"color/0.jpg", "depth/0.png", "pose/0.txt", "intrinsic/a.txt"}),
            "ScanNet (color/ depth/ pose/ intrinsic/)");
  EXPECT_EQ(layout_with("replica", {"results/frame000000.jpg", "traj.txt"}),
            "Replica (results/frame000000.jpg, traj.txt)");
  EXPECT_THAT(layout_with("results_only", {"results/other.jpg", "traj.txt"}), IsEmpty());
  EXPECT_THAT(layout_with("tum", {"rgb/0.png", "depth/0.png", "rgb.txt", "depth.txt"}), IsEmpty());
  EXPECT_THAT(foreign_layout(folder.path() / "absent"), IsEmpty());
}

TEST(RejectSequence, LooksIntoTheFoldersBelow) {
  const TempFolder folder;
  folder.write("chess/seq-01/frame-000000.color.png", "");
  EXPECT_THAT(
      input_error([&] { reject_sequence(folder.path() / "chess", false); }),
      HasSubstr("looks like 7-Scenes (frame-000000.color.png), in seq-01/, which kinloop cannot read yet"));
}

TEST(RejectSequence, AllThatIsMissingIsInOneAnswer) {
  const TempFolder folder;
  folder.write("rgb.txt", "1 a.png\n");
  EXPECT_THAT(input_error([&] { reject_sequence(folder.path(), false); }),
              HasSubstr("no depth.txt, camera.yaml"));
  EXPECT_THAT(advice_of(folder.path(), false),
              AllOf(Not(HasSubstr("rgb.txt ")), HasSubstr("depth.txt "), HasSubstr("fx: 525")));
  EXPECT_THAT(advice_of(folder.path(), true), AllOf(HasSubstr("depth.txt "), Not(HasSubstr("camera.yaml"))));
}

TEST(RejectSequence, TheCameraToCopyIsOne) {
  const TempFolder folder;
  const std::string advice = advice_of(folder.path(), false);
  const auto file = folder.write("camera.yaml", advice.substr(advice.find("  width:")));
  EXPECT_EQ(read_camera_file(file).color.fx, 525);
}

}  // namespace
}  // namespace kinloop
