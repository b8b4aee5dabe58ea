// No output of any command replaces a file that the command reads, whatever its name: the file itself, a link
// to it, or a new file in the folder of a recording.

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "tests/apps/program_test.hpp"

namespace kinloop {
namespace {

namespace fs = std::filesystem;
using test::kDone;
using test::kWrongUse;
using testing::AllOf;
using testing::AnyOf;
using testing::HasSubstr;

/// A command with OUT for its output, and the files that it reads.
struct Case {
  std::string arguments;
  std::vector<std::string> inputs;
  std::string extension = "";  ///< that the output must have
};

/// `image` is one of the recording.
std::vector<Case> outputs_and_inputs(const std::string& image) {
  const std::string run = "run rec -q -o new --camera cam.yaml --vocabulary words.kinvoc --mask mask.png ";
  const std::vector<std::string> of_run = {
      "rec/rgb.txt", "rec/groundtruth.txt", "rec/camera.yaml", "cam.yaml", "mask.png", "words.kinvoc"};
  const std::vector<std::string> map = {"out/map.kinmap"}, posed = {"out/map.kinmap", "poses.txt"};
  const std::vector<std::string> recording = {"out/map.kinmap", "rec/rgb.txt"};
  return {
      {run + "--trajectory OUT", of_run},
      {run + "--save-map OUT", of_run},
      {run + "--poses-to OUT", of_run},
      {"run rec -q -o new --load-map out --trajectory OUT", map},
      {"run rec -q -o new --load-map out --save-map OUT", map},
      {"run rec -q -o new --load-map out --poses-to OUT", map},
      {"record rec -o OUT", {"rec/rgb.txt"}, ".mcap"},
      {"eval poses.txt rec --plot OUT", {"poses.txt", "rec/groundtruth.txt"}},
      {"eval out --plot OUT", {"out/trajectory.txt", "out/groundtruth.txt"}},
      {"export out -q --poses poses.txt --cloud OUT", posed, ".ply"},
      {"export out -q --poses poses.txt --octomap OUT", posed, ".bt"},
      {"export out -q --poses poses.txt --grid OUT", posed, ".pgm"},
      {"export out -q --trajectory OUT", map},
      {"export out -q --keyframes OUT", map},
      {"export out -q --graph OUT", map},
      {"export out -q --poses poses.txt --mcap OUT", posed, ".mcap"},
      {"export out -q --recording rec --images 5 --colmap new --trajectory OUT", recording},
      {"export out -q --images 5 --colmap new --trajectory OUT", recording},
      {"mesh out -q --poses poses.txt -o OUT", posed, ".ply"},
      {"plan out -q -o OUT", map, ".svg"},
      {"share out -q -o OUT", {"out/run.json", "out/map.ply", "out/map.kinmap"}},
      {"share out/map.ply -q -o OUT", {"out/map.ply"}},
      {"report out out -o OUT", {"out/run.json", "out/trajectory.txt"}},
      {"map merge out other.kinmap -q -o OUT", {"out/map.kinmap", "other.kinmap"}},
      {"map diff out other.kinmap -q -o OUT", {"out/map.kinmap", "other.kinmap"}},
      {"map withdraw out --loop 1,2 -q -o OUT", map},
      {"optimize out/graph.g2o -o OUT", {"out/graph.g2o"}},
      {"optimize out/graph.g2o -o new.g2o --report OUT", {"out/graph.g2o"}},
      {"optimize out/graph.g2o -o new.g2o --overwrite --report OUT", {"out/graph.g2o"}},
      {"vocab import words.txt -o OUT", {"words.txt"}},
      {"vocab export words.kinvoc -o OUT", {"words.kinvoc"}},
      {"vocab train rec --held-out photos -q -o OUT", {image, "photos/a.png"}},
      {"vocab describe photos -q -o OUT", {"photos/a.png"}},
      {"calibrate intrinsics photos --square 0.03 -o OUT", {"photos/a.png"}, ".yaml"},
      {"calibrate extrinsics photos --color cam.yaml --square 0.03 -o OUT", {"cam.yaml"}},
  };
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const size_t at = text.find(from);
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

class OutputGuard : public test::ProgramTest {
 protected:
  /// A recording, a run of it, and what other commands read.
  void SetUp() override {
    test::write_room(at("rec"), "--frames 12");
    const Run made = run("run '" + at("rec") + "' -q -o '" + at("out") + "'");
    ASSERT_EQ(made.exit_code, kDone) << made.err;
    fs::copy_file(at("rec/camera.yaml"), at("cam.yaml"));
    fs::copy_file(at("out/map.kinmap"), at("other.kinmap"));
    fs::copy_file(at("out/trajectory.txt"), at("poses.txt"));
    fs::create_directory(at("photos"));
    for (const auto& image : fs::directory_iterator(at("rec/rgb"))) {
      for (const char* copy : {"photos/a.png", "mask.png"})
        fs::copy_file(image.path(), at(copy), fs::copy_options::skip_existing);
      image_ = "rec/rgb/" + image.path().filename().string();
      break;
    }
    for (const char* name : {"words.kinvoc", "words.txt"})
      folder_.write(name, "not read before the outputs are checked");
  }

  std::string image_;  ///< of the recording

  [[nodiscard]] Run run_here(const std::string& arguments) const {
    return run(arguments, "cd '" + folder_.path().string() + "';");
  }

  /// The command is refused in one line, and the file stays as it is.
  void expect_refused(const Case& command, const std::string& output, const std::string& input) {
    SCOPED_TRACE(fmt::format("{} with {} onto {}", command.arguments, output, input));
    const std::string before = read_file(at(input));
    const Run refused = run_here(replaced(command.arguments, "OUT", output));
    EXPECT_EQ(refused.exit_code, kWrongUse) << refused.err;
    EXPECT_THAT(refused.err,
                AllOf(HasSubstr("error: "), HasSubstr(output),
                      AnyOf(HasSubstr("which this command reads"), HasSubstr("is in the folder of"))));
    EXPECT_EQ(std::count(refused.err.begin(), refused.err.end(), '\n'), 1) << refused.err;
    EXPECT_EQ(read_file(at(input)), before);
  }
};

TEST_F(OutputGuard, NoOutputReplacesAnInput) {
  for (const Case& command : outputs_and_inputs(image_)) {
    for (const std::string& input : command.inputs) {
      if (fs::path(input).extension() == command.extension || command.extension.empty())
        expect_refused(command, input, input);
      const std::string symbolic = "symbolic" + command.extension, hard = "hard" + command.extension;
      fs::create_symlink(input, at(symbolic));
      expect_refused(command, symbolic, input);
      fs::create_hard_link(at(input), at(hard));
      expect_refused(command, hard, input);
      for (const std::string& link : {symbolic, hard}) fs::remove(at(link));
    }
  }
  EXPECT_FALSE(fs::exists(at("new")) && !fs::is_empty(at("new")));
}

TEST_F(OutputGuard, NoNewFileIsMadeInTheFolderOfTheRecording) {
  fs::create_directory_symlink("rec", at("link"));
  fs::create_symlink("rec/dangling.txt", at("dangling"));
  for (const char* command : {
           "run rec -q -o new --trajectory ",
           "run rec -q -o new --save-map ",
           "run rec -q -o new --poses-to ",
           "run rec -q -o rec/new --trajectory ",
           "eval poses.txt rec --plot ",
       }) {
    for (const char* output :
         {"rec/new.txt", "rec/rgb/new.txt", "link/new.txt", "dangling", "out/../rec/new.txt"}) {
      SCOPED_TRACE(fmt::format("{}{}", command, output));
      const Run refused = run_here(command + std::string(output));
      EXPECT_EQ(refused.exit_code, kWrongUse);
      EXPECT_THAT(refused.err, HasSubstr("is in the folder of the recording, rec"));
    }
  }
  EXPECT_FALSE(fs::exists(at("rec/new.txt")) || fs::exists(at("rec/dangling.txt")));
}

TEST_F(OutputGuard, ImagesOutsideTheFolderOfTheRecordingAreInputs) {
  fs::create_directory(at("lists"));
  for (const char* list : {"rgb.txt", "depth.txt", "camera.yaml"}) {
    std::string text = read_file(at("rec/" + std::string(list)));
    for (size_t i = 0; (i = text.find(".png", i)) != std::string::npos; ++i) {
      const size_t name = text.rfind(' ', i) + 1;
      text.insert(name, "../rec/");
      i += std::string_view("../rec/").size();
    }
    folder_.write("lists/" + std::string(list), text);
  }
  const std::string before = read_file(at(image_));
  const Run refused = run_here("run lists -q -o new --trajectory " + image_);
  EXPECT_EQ(refused.exit_code, kWrongUse);
  EXPECT_THAT(refused.err, HasSubstr("which this command reads"));
  EXPECT_EQ(read_file(at(image_)), before);
}

TEST_F(OutputGuard, ResultsDoNotReplaceWhatARunReads) {
  fs::create_directory(at("rec/sub"));
  fs::rename(at("rec/camera.yaml"), at("camera.yaml"));  // found above the recording
  struct Refused {
    const char *arguments, *file;
  };
  for (const auto& [arguments, file] :
       {Refused{"run rec -q -o rec", "rec/groundtruth.txt"}, Refused{"run rec -q -o .", "camera.yaml"},
        Refused{"run rec -q --camera out/camera.yaml -o out", "out/camera.yaml"},
        Refused{"run rec -q --camera cam.yaml --mask out/mask.png -o out", "out/mask.png"},
        Refused{"record rec --camera camera.yaml -o .", "camera.yaml"},
        Refused{"simulate room --path out/groundtruth.txt -o out", "out/groundtruth.txt"}}) {
    SCOPED_TRACE(arguments);
    if (!fs::exists(at(file))) fs::copy_file(at("mask.png"), at(file));
    const std::string before = read_file(at(file));
    const Run refused = run_here(arguments);
    EXPECT_EQ(refused.exit_code, kWrongUse);
    EXPECT_THAT(refused.err, AnyOf(HasSubstr("which this command reads; choose another folder"),
                                   HasSubstr("is the folder of the recording")));
    EXPECT_EQ(read_file(at(file)), before);
  }
}

TEST_F(OutputGuard, ResultsMayBeInTheFolderOfTheRecording) {
  for (int i = 0; i < 2; ++i) {  // the second run replaces the results of the first
    const Run inside =
        run_here("run rec -q -o rec/out --trajectory rec/out/poses.csv --save-map rec/out/room.kinmap");
    EXPECT_EQ(inside.exit_code, kDone) << inside.err;
  }
  EXPECT_TRUE(fs::exists(at("rec/out/poses.csv")));
  const Run beside = run("run . -q", "cd '" + at("rec") + "';");
  EXPECT_EQ(beside.exit_code, kDone) << beside.err;
  EXPECT_EQ(run_here("eval out --plot out/errors.svg").exit_code, kDone);
  EXPECT_EQ(run_here("optimize out/graph.g2o -o out/graph.g2o --overwrite").exit_code, kDone);
}

}  // namespace
}  // namespace kinloop
