// Every layout on a sample that the test writes, and the same frames in all of them.

#include "drivers/datasets/layouts/layouts.hpp"

#include <map>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <opencv2/imgcodecs.hpp>

#include "drivers/datasets/open_sequence.hpp"
#include "drivers/datasets/recorded_source.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "kinloop/sensor/camera/camera_file.hpp"
#include "kinloop/slam/slam.hpp"
#include "tests/drivers/depth_file_samples.hpp"
#include "tests/drivers/layout_writers.hpp"
#include "tests/drivers/test_video.hpp"
#include "tests/slam/recording.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/temp_folder.hpp"

namespace kinloop {
namespace {

namespace fs = std::filesystem;
using test::input_error;
using test::LayoutWriter;
using test::make_sample;
using test::Sample;
using test::TempFolder;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

RgbdCamera camera_in_millimetres(const PinholeCamera& lens) {
  RgbdCamera camera;
  camera.color = lens;
  camera.depth_scale = 1000;
  return camera;
}

/// A sample written in one layout.
struct Written {
  Written(const LayoutWriter& writer, const Sample& sample) {
    fs::create_directories(folder.path() / "sample");
    writer.write(path(), sample);
    if (!writer.own_camera) return;
    write_camera_file(folder.path() / "camera.yaml", camera_in_millimetres(sample.lens));
    camera = (folder.path() / "camera.yaml").string();
  }
  [[nodiscard]] fs::path path() const { return folder.path() / "sample"; }
  [[nodiscard]] OpenedSequence read() const { return read_sequence(path(), camera); }
  [[nodiscard]] std::unique_ptr<FrameSource> open() const { return open_sequence(path().string(), camera); }

  TempFolder folder;
  std::optional<std::string> camera;
};

const LayoutWriter& writer_of(const std::string& name) {
  const auto& writers = test::layout_writers();
  return *std::find_if(writers.begin(), writers.end(), [&](const auto& w) { return name == w.name; });
}

class EveryLayout : public testing::TestWithParam<LayoutWriter> {};

TEST_P(EveryLayout, IsRecognised) {
  const Written written(GetParam(), make_sample(2));
  const SequenceLayout* layout = recognise_layout(written.path());
  ASSERT_NE(layout, nullptr);
  EXPECT_STREQ(layout->name, GetParam().name);
}

TEST_P(EveryLayout, GivesTheFramesAndPosesThatWereWritten) {
  const Sample sample = make_sample(12);
  const Written written(GetParam(), sample);
  const auto source = written.open();
  EXPECT_THAT(source->info().description, HasSubstr("12 frames, 32 x 24, registered depth"));
  EXPECT_EQ(source->camera().color, sample.lens);
  for (size_t i = 0; i < sample.size(); ++i) {
    const auto frame = source->next();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->stamp_ns, sample.truth[i].stamp_ns);
    EXPECT_EQ(cv::norm(frame->color.bgr(), sample.colors[i], cv::NORM_INF), 0);
    cv::Mat depth_m;
    sample.depths_mm[i].convertTo(depth_m, CV_32FC1, 1.0 / 1000);
    EXPECT_EQ(cv::norm(frame->depth_m, depth_m, cv::NORM_INF), 0);
  }
  EXPECT_FALSE(source->next());
  EXPECT_THAT(source->skipped(), IsEmpty());
  const Trajectory& truth = source->info().ground_truth;
  const std::string layout = GetParam().name;
  if (layout == "colour and depth images" || layout == "images side by side") return;  // have none
  ASSERT_EQ(truth.size(), sample.size());
  for (size_t i = 0; i < truth.size(); ++i) {
    const SE3 error = truth[i].T_world_camera.inverse() * sample.truth[i].T_world_camera;
    EXPECT_EQ(truth[i].stamp_ns, sample.truth[i].stamp_ns);
    EXPECT_LT(error.translation.norm() + error.angle_rad(), 1e-5);
  }
}

TEST_P(EveryLayout, SkipsDamagedAndMissingDepth) {
  Written written(GetParam(), make_sample(3));
  RecordedSequence sequence = written.read().sequence;
  sequence.frames[1].depth.file = written.folder.write("damaged.png", "x");
  sequence.frames[1].depth.offset = sequence.frames[1].depth.size = 0;
  RecordedSource source("sample", std::move(sequence), written.read().camera);
  EXPECT_TRUE(source.next());
  EXPECT_TRUE(source.next());
  EXPECT_FALSE(source.next());
  ASSERT_EQ(source.skipped().size(), 1U);
  EXPECT_THAT(source.skipped().front().reason, HasSubstr("damaged.png"));
}

/// Byte flips, cuts, insertions and copies, in the files that are parsed and in the images.
std::string mutated(std::string bytes, cv::RNG& random) {
  static const std::vector<std::string> kPieces = {"nan", "-1", "1e999", "999999999999", "\n",
                                                   " ",   "\"", "]",     "../",          "\xff"};
  const auto below = [&](size_t limit) {
    return static_cast<size_t>(random.uniform(0, static_cast<int>(limit)));
  };
  const int changes = random.uniform(1, 4);
  for (int i = 0; i < changes; ++i) {
    const size_t at = below(bytes.size() + 1);
    const size_t length = std::min(below(9), bytes.size() - at);
    switch (random.uniform(0, 5)) {
      case 0:
        if (at < bytes.size()) bytes[at] = static_cast<char>(random.uniform(0, 256));
        break;
      case 1:
        bytes.erase(at, length);
        break;
      case 2:
        bytes.insert(at, kPieces[below(kPieces.size())]);
        break;
      case 3:
        bytes.insert(at, bytes.substr(below(bytes.size() + 1), 8));
        break;
      default:
        if (below(4) == 0) bytes.resize(at);
    }
  }
  return bytes;
}

TEST_P(EveryLayout, MutatedFilesAreReadOrRefused) {
  constexpr int kMutants = 200;
  const Written written(GetParam(), make_sample(2, {8, 6}));
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(written.path())) {
    if (entry.is_regular_file()) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  // Text says more than pixels: it is mutated five times as often.
  std::vector<fs::path> drawn;
  for (const fs::path& file : files) {
    const bool image = file.extension() == ".png" || file.extension() == ".jpg";
    drawn.insert(drawn.end(), image ? 1 : 5, file);
  }
  cv::RNG random(11);
  int refused = 0;
  for (int i = 0; i < kMutants; ++i) {
    const fs::path& file = drawn[static_cast<size_t>(random.uniform(0, static_cast<int>(drawn.size())))];
    const std::string original = read_file(file);
    write_file(file, mutated(original, random));
    try {
      const auto source = written.open();
      while (source->next()) {
      }
    } catch (const InputError& error) {
      EXPECT_THAT(std::string(error.what()), testing::Not(HasSubstr("\n")));
      ++refused;
    }
    write_file(file, original);
  }
  EXPECT_LT(refused, kMutants);
}

TEST(Layouts, SetTheSensorThatTheyKnow) {
  using enum DepthSensorModel;
  const std::map<std::string, DepthSensorModel> known = {
      {"OpenLORIS", kRealsenseD4xx}, {"7-Scenes", kKinect1},     {"BundleFusion", kStructuredLight},
      {"ScanNet", kStructuredLight}, {"Stray Scanner", kIphone}, {"ScanNet recording", kStructuredLight},
      {"3D Scanner App", kIphone},   {"Polycam", kIphone},       {"Record3D", kIphone},
      {"Record3D export", kIphone}};
  size_t found = 0;
  for (const LayoutWriter& writer : test::layout_writers()) {
    SCOPED_TRACE(writer.name);
    const DepthSensor sensor = Written(writer, make_sample(2)).read().camera.sensor;
    const auto expected = known.find(writer.name);
    if (expected == known.end()) {
      EXPECT_NE(sensor.origin, SensorOrigin::kCameraFile);
      continue;
    }
    EXPECT_EQ(sensor.model, expected->second);
    EXPECT_EQ(sensor.origin, SensorOrigin::kSource);
    ++found;
  }
  EXPECT_GE(found, known.size() - 1);  // Stray Scanner needs a video encoder
}

TEST(Record3dExport, SmallerDepthHasTheSameViewAndConfidence) {
  Sample sample = make_sample(2, {64, 48});
  const Written written(writer_of("Record3D export"), sample);
  cv::Mat confidence(24, 32, CV_8UC1, cv::Scalar(2));
  confidence.rowRange(0, 12).setTo(0);
  for (int i = 0; i < 2; ++i) {
    write_file(written.path() / fmt::format("depth/{}.exr", i),
               test::exr(cv::Mat(24, 32, CV_32FC1, cv::Scalar(1.5))));
    cv::imwrite((written.path() / fmt::format("confidence/{}.png", i)).string(), confidence);
  }
  const auto source = written.open();
  ASSERT_TRUE(source->camera().depth);
  EXPECT_EQ(source->camera().depth->width, 32);
  EXPECT_EQ(source->camera().depth->fx, sample.lens.fx / 2);
  const auto frame = source->next();
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->depth_m.size(), cv::Size(64, 48));
  EXPECT_EQ(frame->depth_m.at<float>(6, 32), 0);
  EXPECT_NEAR(frame->depth_m.at<float>(40, 32), 1.5, 1e-5);
}

TEST(Record3dExport, IntrinsicsOfLargerImagesAreScaled) {
  const Sample sample = make_sample(2);
  const Written written(writer_of("Record3D export"), sample);
  write_file(written.path() / "metadata.json",
             R"({"w": 64, "h": 48, "fps": 30, "K": [48, 0, 0, 0, 48, 0, 31.5, 23.5, 1]})");
  const RgbdCamera camera = written.read().camera;
  EXPECT_EQ(camera.color.width, 32);
  EXPECT_EQ(camera.color.fx, 24);
}

TEST(Transforms, UnitOfDepthMayBeThatOfNerfCapture) {
  const Written written(writer_of("Nerfstudio, NeRFCapture"), make_sample(2));
  std::string json = read_file(written.path() / "transforms.json");
  json.replace(json.find("0.001"), 5, "0.00015259021896696422");  // 10 m in 16 bits
  write_file(written.path() / "transforms.json", json);
  EXPECT_NEAR(written.read().camera.depth_scale, 6553.5, 1e-6);
}

/// Moves both kinds of images of a folder with transforms.json into images/, as NeRFCapture saves them.
void put_side_by_side(const fs::path& folder) {
  std::string text = read_file(folder / "transforms.json");
  for (const auto& [from, kind] :
       {std::pair("rgb", "color"), std::pair("images", "color"), std::pair("depth", "depth")}) {
    std::error_code absent;
    if (!fs::is_directory(folder / from, absent)) continue;
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(folder / from)) files.push_back(entry.path());
    for (const fs::path& file : files) {
      const std::string name = fmt::format("shots/{}.{}", kind, file.filename().string());
      fs::create_directories(folder / "shots");
      fs::rename(file, folder / name);
      const std::string old = fmt::format("{}/{}", from, file.filename().string());
      for (size_t at = text.find(old); at != std::string::npos; at = text.find(old))
        text.replace(at, old.size(), name);
    }
    fs::remove(folder / from);
  }
  write_file(folder / "transforms.json", text);
}

TEST(Transforms, ListedImagesMayLieAnywhere) {
  const Written written(writer_of("Nerfstudio, NeRFCapture"), make_sample(3));
  put_side_by_side(written.path());
  const auto opened = read_sequence(written.path());
  EXPECT_THAT(opened.sequence.frames, SizeIs(3));
  EXPECT_THAT(opened.sequence.ground_truth, SizeIs(3));
  fs::rename(written.path() / "transforms.json", written.path() / "transforms_train.json");
  EXPECT_THAT(read_sequence(written.path()).sequence.frames, SizeIs(3));
}

/// Folders a/ and b/ with colour and depth of three frames, without a camera.
void write_images_elsewhere(const TempFolder& folder, const Sample& sample) {
  for (size_t i = 0; i < sample.size(); ++i) {
    folder.write(fmt::format("a/{}.png", i), test::encoded(sample.colors[i], ".png"));
    folder.write(fmt::format("b/{}.png", i), test::encoded(sample.depths_mm[i], ".png"));
  }
  write_camera_file(folder.path() / "camera.yaml", camera_in_millimetres(sample.lens));
}

TEST(Listed, AnyListThatNamesImagesIsFollowed) {
  struct List {
    const char* name;
    std::string text;
    int64_t second_ns;  ///< stamp of the second frame
  };
  const std::vector<List> lists = {
      {"associate.txt",
       "1700000000.0 a/0.png 1700000000.0 b/0.png\n1700000000.2 a/1.png 1700000000.21 b/1.png\n"
       "1700000000.4 a/2.png 1700000000.4 b/2.png\n",
       1'700'000'000'200'000'000},
      {"frames.csv",
       "time,depth,colour\r\n0,\"b/0.png\",a/0.png\r\n66667000,b/1.png,a/1.png\r\n133333000,b/2.png,a/"
       "2.png\r\n",
       66'667'000},
      {"list.txt", "# two names\nb/2.png;a/2.png\nb/1.png;a/1.png\nb/0.png;a/0.png\n", 33'333'333},
      {"frames.json",
       R"({"fps": 30, "frames": [{"rgb": "a/0.png", "depth": "b/0.png", "timestamp": 5.0},
 {"rgb": "a/1.png", "depth": "b/1.png", "timestamp": 5.1}, {"rgb": "a/2.png", "depth": "b/2.png", "timestamp": 5.2}]})",
       5'100'000'000},
  };
  const Sample sample = make_sample(3);
  for (const List& list : lists) {
    SCOPED_TRACE(list.name);
    const TempFolder folder;
    write_images_elsewhere(folder, sample);
    folder.write(list.name, list.text);
    const auto opened = read_sequence(folder.path());
    EXPECT_EQ(opened.sequence.layout, fmt::format("images listed in {}", list.name));
    ASSERT_THAT(opened.sequence.frames, SizeIs(3));
    EXPECT_EQ(opened.sequence.frames[1].stamp_ns, list.second_ns);
    for (const RecordedFrame& frame : opened.sequence.frames) {
      EXPECT_EQ(frame.color.file.parent_path().filename(), "a");
      EXPECT_EQ(frame.color.file.filename(), frame.depth.file.filename());
    }
  }
}

TEST(Listed, MutatedListsAreReadOrRefused) {
  const Sample sample = make_sample(2, {8, 6});
  const TempFolder folder;
  write_images_elsewhere(folder, sample);
  cv::RNG random(12);
  int refused = 0;
  for (const auto& [name, text] : {std::pair("l.txt", "0.0 a/0.png 0.0 b/0.png\n0.1 a/1.png 0.1 b/1.png\n"),
                                   std::pair("l.json", R"([{"c": "a/0.png", "d": "b/0.png", "time": 1},
 {"c": "a/1.png", "d": "b/1.png", "time": 2}])")}) {
    for (int i = 0; i < 200; ++i) {
      const auto file = folder.write(name, mutated(text, random));
      try {
        const auto source = open_sequence(folder.path().string());
        while (source->next()) {
        }
      } catch (const InputError&) {
        ++refused;
      }
      fs::remove(file);
    }
  }
  EXPECT_GT(refused, 0);
}

TEST(Transforms, FramesWithoutDepthFilesArePairedAsInTwoFolders) {
  const Sample sample = make_sample(3);
  const Written written(writer_of("Nerfstudio, NeRFCapture"), sample);
  std::string json = read_file(written.path() / "transforms.json");
  for (size_t at; (at = json.find("depth_path")) != std::string::npos;) json.replace(at, 10, "mask_path");
  for (size_t at; (at = json.find(".png\", \"mask")) != std::string::npos;)
    json.erase(at, 4);  // as instant-ngp
  write_file(written.path() / "transforms.json", json);
  const RecordedSequence sequence = written.read().sequence;
  EXPECT_EQ(sequence.frames.size(), 3U);
  EXPECT_FALSE(sequence.truth_in_metres);
  ASSERT_EQ(sequence.ground_truth.size(), 3U);
  EXPECT_LT(
      (sequence.ground_truth[2].T_world_camera.inverse() * sample.truth[2].T_world_camera).translation.norm(),
      1e-6);
}

TEST(Layouts, ACameraFileWithoutSensorLeavesThatOfTheLayout) {
  const Sample sample = make_sample(2);
  const Written written(writer_of("Polycam"), sample);
  RgbdCamera camera = camera_in_millimetres(sample.lens);
  const auto file = written.folder.path() / "given.yaml";
  write_camera_file(file, camera);
  EXPECT_EQ(read_sequence(written.path(), file.string()).camera.sensor.model, DepthSensorModel::kIphone);
  camera.sensor = depth_sensor(DepthSensorModel::kKinect2, SensorOrigin::kSource);
  write_camera_file(file, camera);
  EXPECT_EQ(read_sequence(written.path(), file.string()).camera.sensor.model, DepthSensorModel::kKinect2);
}

INSTANTIATE_TEST_SUITE_P(Layouts, EveryLayout, testing::ValuesIn(test::layout_writers()),
                         [](const auto& layout) {
                           std::string name = layout.param.name;
                           std::erase_if(name, [](unsigned char c) { return std::isalnum(c) == 0; });
                           return name;
                         });

/// Frames of the simulated room, with depth in millimetres.
Sample simulated_sample(int frames) {
  const test::Recording recording = test::record_simulation("sim:room", frames);
  Sample sample;
  sample.lens = recording.camera.color;
  auto& lens = sample.lens;
  for (double* value : {&lens.fx, &lens.fy, &lens.cx, &lens.cy})
    *value = static_cast<double>(static_cast<float>(*value));  // .sens has floats
  lens.lens = {};                                              // which most layouts cannot express
  for (size_t i = 0; i < recording.frames.size(); ++i) {
    cv::Mat depth_mm;
    recording.frames[i].depth_m.convertTo(depth_mm, CV_16UC1, 1000);
    cv::Mat color;
    recording.frames[i].color.bgr().copyTo(color);
    sample.colors.push_back(color);
    sample.depths_mm.push_back(depth_mm);
    sample.truth.push_back(
        {std::llround(1e9 * static_cast<double>(i) / 30), recording.truth[i].T_world_camera});
  }
  return sample;
}

/// As one sensor for all: its noise weighs the measurements.
Trajectory trajectory_of(FrameSource& source) {
  RgbdCamera camera = source.camera();
  camera.sensor = {};
  Slam slam(camera);
  while (const auto frame = source.next()) slam.process(*frame);
  return slam.finish();
}

TEST(Layouts, TheSameFramesGiveTheSameTrajectoryInEachOfThem) {
  const Sample sample = simulated_sample(8);
  const std::string camera_file_layout = "TUM";
  const Written reference(writer_of(camera_file_layout), sample);
  const Trajectory expected = trajectory_of(*reference.open());
  ASSERT_EQ(expected.size(), sample.size());
  for (const LayoutWriter& writer : test::layout_writers()) {
    SCOPED_TRACE(writer.name);
    const Trajectory trajectory = trajectory_of(*Written(writer, sample).open());
    ASSERT_EQ(trajectory.size(), expected.size());
    for (size_t i = 0; i < trajectory.size(); ++i) {
      EXPECT_EQ(trajectory[i].stamp_ns, expected[i].stamp_ns);
      EXPECT_EQ(trajectory[i].T_world_camera.translation, expected[i].T_world_camera.translation);
      EXPECT_EQ(trajectory[i].T_world_camera.rotation.coeffs(), expected[i].T_world_camera.rotation.coeffs());
    }
  }
}

TEST(SevenScenes, DepthOfTheOriginalIsToBeRegistered) {
  const Sample sample = make_sample(2, {640, 480});
  const Written written(writer_of("7-Scenes"), sample);
  fs::remove(written.path() / "camera-intrinsics.txt");
  const auto [sequence, camera, name] = written.read();
  ASSERT_TRUE(camera.depth);
  EXPECT_EQ(camera.depth->fx, 585);
  EXPECT_EQ(camera.color.fx, 522.07);
  // The poses in the files are those of the depth camera.
  const SE3 T_world_depth = sequence.ground_truth[1].T_world_camera * camera.T_color_depth;
  EXPECT_LT((T_world_depth.inverse() * sample.truth[1].T_world_camera).translation.norm(), 1e-6);
}

TEST(SevenScenes, AFileOfAnotherNameHasTheCameraOfItsImages) {
  const Written written(writer_of("7-Scenes"), make_sample(2, {640, 480}));
  fs::remove(written.path() / "camera-intrinsics.txt");
  write_file(written.path() / "camera-intrinsics.color.txt", "500 0 320\n0 500 240\n0 0 1\n");
  const auto [sequence, camera, name] = written.read();
  EXPECT_FALSE(camera.depth);
  EXPECT_EQ(camera.color.fx, 500);
}

TEST(ScanNet, SmallerDepthHasItsOwnLens) {
  Sample sample = make_sample(2, {64, 48});
  const Written written(writer_of("ScanNet"), sample);
  for (const char* name : {"0.png", "1.png"})
    cv::imwrite((written.path() / "depth" / name).string(), cv::Mat(24, 32, CV_16UC1, cv::Scalar(1500)));
  write_file(written.path() / "intrinsic/intrinsic_depth.txt",
             "24 0 15.5 0  0 24 11.5 0  0 0 1 0  0 0 0 1\n");
  const auto source = written.open();
  ASSERT_TRUE(source->camera().depth);
  EXPECT_EQ(source->camera().depth->width, 32);
  const auto frame = source->next();
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->depth_m.size(), cv::Size(64, 48));
  EXPECT_NEAR(frame->depth_m.at<float>(24, 32), 1.5, 1e-5);
}

TEST(ScanNet, FramesWithoutTrackingHaveNoTruth) {
  const Written written(writer_of("ScanNet"), make_sample(3));
  std::string lost;
  for (int i = 0; i < 16; ++i) lost += "-inf ";
  write_file(written.path() / "pose/1.txt", lost);
  const RecordedSequence sequence = written.read().sequence;
  EXPECT_EQ(sequence.frames.size(), 3U);
  EXPECT_EQ(sequence.ground_truth.size(), 2U);
}

TEST(Sens, RecordingThatWasCutOffKeepsItsFrames) {
  const Written written(writer_of("ScanNet recording"), make_sample(3));
  const fs::path file = written.path() / "scene0000_00.sens";
  const std::string whole = read_file(file);
  write_file(file, whole.substr(0, whole.size() - 10));
  EXPECT_EQ(written.read().sequence.frames.size(), 2U);
  write_file(file, whole.substr(0, 100));
  EXPECT_THAT(
      input_error([&] { static_cast<void>(written.read()); }),
      AllOf(HasSubstr("scene0000_00.sens: at byte 100: the file is truncated"), HasSubstr("copy it again")));
  EXPECT_THAT(input_error([&] { read_sequence(written.folder.write("own.sens", "x")); }),
              HasSubstr("at byte 0"));
}

TEST(Scanner3dApp, DepthOfLowConfidenceIsUnknown) {
  const Written written(writer_of("3D Scanner App"), make_sample(2));
  cv::Mat confidence(24, 32, CV_8UC1, cv::Scalar(2));
  confidence.at<uint8_t>(5, 6) = 0;
  cv::imwrite((written.path() / "conf_00000.png").string(), confidence);
  const auto frame = written.open()->next();
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->depth_m.at<float>(5, 6), 0);
  EXPECT_GT(frame->depth_m.at<float>(5, 7), 0);
}

struct BadInput {
  const char* layout;
  const char* file;     ///< to be changed
  const char* content;  ///< null: removed
  std::vector<const char*> said;
};

TEST(Layouts, WhatIsMissingOrWrongIsNamedWithTheRemedy) {
  const std::vector<BadInput> inputs = {
      {"Replica", "cam_params.json", nullptr, {"no cam_params.json", "--camera"}},
      {"Replica",
       "cam_params.json",
       R"({"camera": {"w": 32, "h": 24, "fx": 24, "fy": 24, "cx": 15, "cy": 11}})",
       {"cam_params.json: no number 'scale'"}},
      {"Replica", "traj.txt", "1 0 0\n0 x 0\n", {"traj.txt:2: 'x' is not a number"}},
      {"Replica", "traj.txt", "1 0 1e999\n", {"traj.txt:1: '1e999' is not a number"}},
      {"Replica", "traj.txt", "1 0 1.5.3\n", {"traj.txt:1: '1.5.3' is not a number"}},
      {"OpenLORIS", "sensors.yaml", nullptr, {"no sensors.yaml", "--camera"}},
      {"OpenLORIS", "sensors.yaml", "{", {"sensors.yaml: not a YAML file"}},
      {"BundleFusion", "info.txt", "m_colorWidth = 32\n", {"info.txt: no 'm_colorHeight"}},
      {"ScanNet", "intrinsic/intrinsic_color.txt", nullptr, {"intrinsic_color.txt: no such file"}},
      {"ScanNet",
       "intrinsic/intrinsic_depth.txt",
       "1 0 0 0 1 0 0 0 1",
       {"intrinsic_depth.txt: fx 1", "correct it"}},
      {"ScanNet", "depth/1.png", nullptr, {}},
      {"7-Scenes", "frame-000001.pose.txt", "1 2 3", {"frame-000001.pose.txt: not a matrix"}},
      {"3D Scanner App", "frame_00001.json", "{\"time\": ", {"frame_00001.json: not JSON", "byte 10"}},
      {"3D Scanner App", "frame_00001.json", nullptr, {"frame_00001.json: no such file"}},
      {"Record3D", "rgbd/0.depth", "bvx2....", {"rgbd/0.depth: compressed by LZFSE", "lzfse -decode"}},
      {"Redwood or Open3D",
       "camera_intrinsic.json",
       R"({"width": 32})",
       {"camera_intrinsic.json: no camera in a known format"}},
      {"TartanAir", "pose_left.txt", "1 2 3\n", {"pose_left.txt: 3 numbers"}},
      {"ICL-NUIM", "associations.txt", "0 depth/0.png\n", {"associations.txt:1:", "colour_file"}},
      {"ETH3D", "calibration.txt", "24 24\n", {"calibration.txt: 2 numbers"}},
#ifdef KINLOOP_WITH_VIDEO
      {"Stray Scanner", "camera_matrix.csv", nullptr, {"no camera_matrix.csv", "--camera"}},
      {"Stray Scanner", "rgb.mp4", "x", {"rgb.mp4: not a video"}},
      {"Stray Scanner", "odometry.csv", "t\n1, 0, 1\n", {"odometry.csv:2:", "found 3 fields"}},
#endif
  };
  for (const BadInput& bad : inputs) {
    SCOPED_TRACE(fmt::format("{} {}", bad.layout, bad.file));
    const Written written(writer_of(bad.layout), make_sample(3));
    fs::remove(written.path() / bad.file);
    if (bad.content != nullptr) write_file(written.path() / bad.file, bad.content);
    if (bad.said.empty()) {  // the frame without depth is left out
      EXPECT_EQ(written.read().sequence.frames.size(), 2U);
      continue;
    }
    const std::string message = input_error([&] { static_cast<void>(written.open()); });
    for (const char* piece : bad.said) EXPECT_THAT(message, HasSubstr(piece));
  }
}

TEST(Layouts, NestedYamlIsAnErrorNotACrash) {
  constexpr size_t kBrackets = 100'000;
  std::string sequences;
  for (size_t i = 0; i < kBrackets; ++i) sequences += "- ";
  for (const std::string& nested : {std::string(kBrackets, '['), std::string(kBrackets, '{'), sequences}) {
    for (const char* file : {"sensors.yaml", "trans_matrix.yaml"}) {
      const Written written(writer_of("OpenLORIS"), make_sample(2));
      write_file(written.path() / file, "%YAML:1.0\n---\n" + nested);
      EXPECT_THAT(input_error([&] { static_cast<void>(written.open()); }), HasSubstr("not a YAML file"));
    }
  }
}

TEST(FoldersWithoutLists, ArePairedByTimeByNumberOrByOrder) {
  const Sample sample = make_sample(3);
  const auto paired = [&](std::vector<std::string> color, std::vector<std::string> depth) {
    const TempFolder folder;
    for (const std::string& name : color) folder.write("rgb/" + name, "c");
    for (const std::string& name : depth) folder.write("depth/" + name, "d");
    write_camera_file(folder.path() / "camera.yaml", camera_in_millimetres(sample.lens));
    std::string pairs;
    for (const RecordedFrame& frame : read_sequence(folder.path()).sequence.frames)
      pairs += fmt::format("{}-{} ", frame.color.file.stem().string(), frame.depth.file.stem().string());
    return pairs;
  };
  EXPECT_EQ(paired({"9.png", "10.png"}, {"9.png", "10.png", "11.png"}), "9-9 10-10 ");
  EXPECT_EQ(paired({"c_1.png", "c_2.png"}, {"depth0001.png", "depth0002.png"}),
            "c_1-depth0001 c_2-depth0002 ");
  EXPECT_EQ(paired({"a.png", "b.png"}, {"x.png", "y.png"}), "a-x b-y ");
  EXPECT_EQ(paired({"1.000.png", "1.033.png"}, {"1.030.png", "1.500.png"}), "1.033-1.030 ");
  EXPECT_EQ(paired({"0001-000000000000.jpg", "0002-000000033369.jpg"}, {"0001-000000033360.png"}),
            "0002-000000033369-0001-000000033360 ");
  EXPECT_THAT(input_error([&] {
                paired({"a.png"}, {"x.png", "y.png"});
              }),
              AllOf(HasSubstr("1 colour images and 2 depth images"), HasSubstr("associations.txt")));
}

TEST(RecordedSource, DepthImageWithoutPixelsForTheCameraIsAnError) {
  const Written written(writer_of("Record3D"), make_sample(2));
  for (const char* name : {"rgbd/0.depth", "rgbd/1.depth"}) write_file(written.path() / name, "too short");
  const auto source = written.open();
  EXPECT_THAT(input_error([&] { source->next(); }),
              AllOf(HasSubstr("none of the 2 frames"), HasSubstr("9 bytes")));
}

#ifdef KINLOOP_WITH_VIDEO
TEST(StrayScanner, RowsAreThoseOfTheirFrame) {
  if (!video_available()) GTEST_SKIP() << "this build reads no video";
  const Sample sample = make_sample(6);
  const Written written(writer_of("Stray Scanner"), sample);
  const fs::path file = written.path() / "odometry.csv";
  std::istringstream text(read_file(file));
  std::vector<std::string> lines;
  for (std::string line; std::getline(text, line);) lines.push_back(line);
  // The row of frame 1 is missing, and the others are in another order.
  write_file(file, fmt::format("{}\n{}\n{}\n{}\n", lines[0], lines[4], lines[1], lines[3]));
  const auto source = written.open();
  for (const size_t index : {size_t{0}, size_t{2}, size_t{3}}) {
    const auto frame = source->next();
    ASSERT_TRUE(frame) << index << ": "
                       << (source->skipped().empty() ? "" : source->skipped().front().reason);
    EXPECT_EQ(frame->stamp_ns, sample.truth[index].stamp_ns);
    EXPECT_LT(cv::norm(frame->color.bgr(), sample.colors[index], cv::NORM_INF), 12) << index;
  }
  EXPECT_FALSE(source->next());
}

TEST(StrayScanner, TheMedianOfTheLensesOfAllFramesIsUsed) {
  const Written written(writer_of("Stray Scanner"), make_sample(3));
  std::string odometry = "timestamp, frame, x, y, z, qx, qy, qz, qw, fx, fy, cx, cy, more, \n";
  for (int i = 0; i < 3; ++i)
    odometry += fmt::format("{}, {:06d}, 0, 0, 0, 0, 0, 0, 1, {}, 24, 15, 11, , \n", i, i, 20 + i);
  write_file(written.path() / "odometry.csv", odometry);
  EXPECT_EQ(written.read().camera.color.fx, 21);
}

TEST(VideoReader, FramesComeInTheOrderTheyAreShown) {
  const TempFolder folder;
  std::vector<cv::Mat> images;
  for (int i = 0; i < 12; ++i) images.emplace_back(48, 64, CV_8UC3, cv::Scalar::all(20 * i));
  test::write_video_with_b_frames(folder.path() / "v.mp4", images);
  VideoReader video(folder.path() / "v.mp4");
  EXPECT_EQ(video.size(), cv::Size(64, 48));
  for (const size_t i : {0, 1, 2, 3, 4, 5, 9, 11, 2})
    EXPECT_NEAR(cv::mean(video.read(i))[0], 20.0 * static_cast<double>(i), 6);
  EXPECT_THAT(input_error([&] { video.read(12); }), HasSubstr("v.mp4: the video ends after 12 frames"));
}
#endif

}  // namespace
}  // namespace kinloop
