#include "drivers/datasets/sequence_layout.hpp"

#include <gmock/gmock.h>

#include "drivers/datasets/folder_contents.hpp"
#include "drivers/datasets/sequences_below.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/sensor/camera/camera_file.hpp"
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

std::string hint_of(const std::filesystem::path& path, bool camera_known) {
  try {
    reject_sequence(path, camera_known);
  } catch (const InputErrorWithHint& error) {
    return error.hint();
  } catch (const InputError&) {
    return {};
  }
}

TEST(ForeignLayout, IsRecognisedByTheFolderContents) {
  const TempFolder folder;
  const auto layout_with = [&](const char* name, std::vector<const char*> files) {
    for (const char* file : files) folder.write(std::filesystem::path(name) / file, "");
    return detect_dataset_layout(folder.path() / name);
  };
  EXPECT_EQ(layout_with("kitti", {"image_2/000000.png", "calib.txt"}), "KITTI (image_2/)");
  EXPECT_THAT(layout_with("open3d", {"color/0.jpg", "depth/0.png", "camera.json"}), IsEmpty());
  EXPECT_THAT(layout_with("tum", {"rgb/0.png", "depth/0.png", "rgb.txt", "depth.txt"}), IsEmpty());
  EXPECT_THAT(detect_dataset_layout(folder.path() / "absent"), IsEmpty());
}

TEST(RejectSequence, LooksIntoTheFoldersBelow) {
  const TempFolder folder;
  folder.write("chess/seq-01/frame-000000.color.png", "");
  folder.write("drive/05/image_2/000000.png", "");
  EXPECT_THAT(input_error([&] { reject_sequence(folder.path() / "chess", false); }),
              HasSubstr("chess: contains 1 sequence; choose one: --sequence seq-01, or give its folder, "));
  EXPECT_THAT(input_error([&] { reject_sequence(folder.path() / "drive", false); }),
              HasSubstr("looks like KITTI (image_2/), in 05/, which kinloop cannot read"));
}

TEST(RejectSequence, FindsASequenceFourFoldersDown) {
  const TempFolder folder;
  folder.write("a/b/c/seq-01/frame-000000.color.png", "");
  folder.write("a/notes.txt", "");
  folder.write("a/.cache/seq-02/frame-000000.color.png", "");
  EXPECT_THAT(input_error([&] { reject_sequence(folder.path(), false); }),
              AllOf(HasSubstr("contains 1 sequence; choose one: --sequence a/b/c/seq-01, "),
                    Not(HasSubstr("seq-02"))));
  EXPECT_EQ(hint_of(folder.path(), false), "Sequences:\n  a/b/c/seq-01  (7-Scenes)\n");
}

TEST(SequenceFolder, IsTheOnlyOneBelowUnlessThereIsAnother) {
  const TempFolder folder;
  folder.write("a/b/seq-01/frame-000000.color.png", "");
  EXPECT_EQ(sequence_folder(folder.path()), folder.path() / "a/b/seq-01");
  EXPECT_EQ(sequence_folder(folder.path() / "a/b/seq-01"), folder.path() / "a/b/seq-01");
  folder.write("a/seq-02/frame-000000.color.png", "");  // on another level
  EXPECT_EQ(sequence_folder(folder.path()), folder.path());
  EXPECT_EQ(sequence_folder(folder.path() / "absent"), folder.path() / "absent");
  folder.write("run/run.json", "{}");
  folder.write("run/trajectory.txt", "");
  folder.write("run/images/seq/frame-000000.color.png", "");
  EXPECT_EQ(sequence_folder(folder.path() / "run"), folder.path() / "run");
}

TEST(SequenceFolder, IsTheOneThatIsChosen) {
  const TempFolder folder;
  folder.write("rooms/a/frame-000000.color.png", "");
  folder.write("b/frame-000000.color.png", "");
  folder.write("b/later/frame-000000.color.png", "");  // within another, which is chosen by name only
  EXPECT_EQ(sequence_folder(folder.path(), "rooms/a"), folder.path() / "rooms/a");
  EXPECT_EQ(sequence_folder(folder.path(), "./b"), folder.path() / "b");
  EXPECT_EQ(sequence_folder(folder.path() / "b", "later"), folder.path() / "b/later");
  EXPECT_THAT(input_error([&] { sequence_folder(folder.path(), "rooms/b"); }),
              HasSubstr(": contains 2 sequences, but no 'rooms/b'; did you mean 'rooms/a'?"));
  EXPECT_THAT(input_error([&] { sequence_folder(folder.path() / "rooms", "../b"); }), HasSubstr("no '../b'"));
  EXPECT_THAT(input_error([&] { sequence_folder(folder.path() / "absent", "a"); }),
              HasSubstr("no sequence a in it"));
}

TEST(SequencesBelow, AreCountedUpToALimit) {
  const TempFolder folder;
  for (int i = 0; i < 1001; ++i) std::filesystem::create_directory(folder.path() / std::to_string(i));
  folder.write("1/frame-000000.color.png", "");
  EXPECT_FALSE(sequences_below(folder.path()).complete);
  EXPECT_EQ(sequence_folder(folder.path()), folder.path());  // not known to be the only one
  EXPECT_THAT(input_error([&] { reject_sequence(folder.path(), false); }),
              HasSubstr("contains at least 1 sequence; choose one"));
}

TEST(RejectSequence, AllThatIsMissingIsInOneAnswer) {
  const TempFolder folder;
  folder.write("rgb.txt", "1 a.png\n");
  EXPECT_THAT(input_error([&] { reject_sequence(folder.path(), false); }),
              HasSubstr("no depth.txt, camera.yaml"));
  EXPECT_THAT(hint_of(folder.path(), false),
              AllOf(HasSubstr("7-Scenes "), Not(HasSubstr("for each colour image")),
                    HasSubstr("for each depth image"), HasSubstr("fx: 525")));
  EXPECT_THAT(hint_of(folder.path(), true), AllOf(HasSubstr("depth.txt "), Not(HasSubstr("camera.yaml"))));
}

TEST(RejectSequence, TheCameraToCopyIsOne) {
  const TempFolder folder;
  const std::string hint = hint_of(folder.path(), false);
  const auto file = folder.write("camera.yaml", hint.substr(hint.find("  width:")));
  EXPECT_EQ(read_camera_file(file).color.fx, 525);
}

}  // namespace
}  // namespace kinloop
