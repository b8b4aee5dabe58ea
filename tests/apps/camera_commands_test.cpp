// kinloop fetch, record, calibrate and live cameras, end to end.

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "drivers/datasets/tum_writer.hpp"
#include "drivers/ros/bag_source.hpp"
#include "tests/apps/http_server.hpp"
#include "tests/apps/program_test.hpp"
#include "tests/calibration/pictures.hpp"
#include "tests/support/shared_data.hpp"

namespace kinloop {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

using test::kBadInput;
using test::kDone;
using test::kWrongUse;

class CameraCommands : public test::ProgramTest {
 protected:
  /// Whether the build has the part named in a line of --version.
  [[nodiscard]] bool has(const std::string& part) const {
    return run("--version").out.find(part + ": yes") != std::string::npos;
  }
};

class Fetch : public CameraCommands {
 protected:
  void SetUp() override {
    if (!has("downloads")) GTEST_SKIP() << "this build cannot download";
    folder_.write("made/rgbd_dataset_freiburg1_room/rgb.txt", "# colour\n");
    // Incompressible data.
    std::string noise(300'000, '\0');
    uint32_t state = 1;
    for (char& c : noise) c = static_cast<char>((state = state * 1664525 + 1013904223) >> 24);
    folder_.write("made/rgbd_dataset_freiburg1_room/rgb/1.png", noise);
    ASSERT_EQ(
        std::system(("tar -C '" + at("made") + "' -czf '" + at("room.tgz") + "' rgbd_dataset_freiburg1_room")
                        .c_str()),
        0);
    archive_ = read_file(at("room.tgz"));
  }
  [[nodiscard]] Run fetch(const test::HttpServer& server) const {
    return run("fetch tum/fr1_room -q -o '" + at("data") + "' --server " + server.address());
  }
  [[nodiscard]] std::string at_data(const std::string& name) const {
    return at("data/rgbd_dataset_freiburg1_room/" + name);
  }

  static constexpr const char* kPath = "/freiburg1/rgbd_dataset_freiburg1_room.tgz";
  std::string archive_;
};

TEST_F(Fetch, DownloadsAndUnpacksAndNamesTheLicence) {
  const test::HttpServer server(kPath, archive_);
  const Run result = fetch(server);
  EXPECT_EQ(result.exit_code, kDone) << result.err;
  EXPECT_THAT(result.out, HasSubstr("CC BY 4.0"));
  EXPECT_EQ(read_file(at_data("rgb/1.png")), read_file(at("made/rgbd_dataset_freiburg1_room/rgb/1.png")));
  EXPECT_FALSE(std::filesystem::exists(at("data/rgbd_dataset_freiburg1_room.tgz")));
  EXPECT_THAT(fetch(server).out, HasSubstr("already exists"));
}

TEST_F(Fetch, FollowsALinkToTheFolder) {
  const test::HttpServer server(kPath, archive_);
  std::filesystem::create_directory(at("disk"));
  std::filesystem::create_directory_symlink("disk", at("data"));
  const Run result = fetch(server);
  EXPECT_EQ(result.exit_code, kDone) << result.err;
  EXPECT_TRUE(std::filesystem::exists(at("disk/rgbd_dataset_freiburg1_room/rgb.txt")));
}

TEST_F(Fetch, ResumesAnInterruptedDownload) {
  test::HttpServer server(kPath, archive_);
  server.hang_up_after = 100'000;
  const Run first = fetch(server);
  EXPECT_EQ(first.exit_code, kBadInput);
  EXPECT_THAT(first.err, HasSubstr("run the same command again"));
  EXPECT_EQ(std::filesystem::file_size(at("data/rgbd_dataset_freiburg1_room.tgz.part")), 100'000U);
  server.hang_up_after = std::string::npos;
  EXPECT_EQ(fetch(server).exit_code, kDone);
  EXPECT_EQ(server.last_range_begin, 100'000U);
  EXPECT_EQ(read_file(at_data("rgb/1.png")), read_file(at("made/rgbd_dataset_freiburg1_room/rgb/1.png")));
}

TEST_F(Fetch, SaysWhatIsWrong) {
  const test::HttpServer other("/elsewhere", "x"), damaged(kPath, archive_.substr(0, archive_.size() / 2));
  EXPECT_EQ(fetch(other).exit_code, kBadInput);
  EXPECT_THAT(fetch(other).err, HasSubstr(other.address()));
  const Run cut = fetch(damaged);
  EXPECT_EQ(cut.exit_code, kBadInput);
  EXPECT_THAT(cut.err, AllOf(HasSubstr("damaged or truncated"),
                             HasSubstr("delete the archive and copy or download it again")));
  const Run name = run("fetch tum/room");
  EXPECT_EQ(name.exit_code, kWrongUse);
  EXPECT_THAT(name.err, HasSubstr("tum/fr1_room"));
  EXPECT_EQ(run("fetch tum/fr1_../x").exit_code, kWrongUse);
}

TEST_F(Fetch, RefusesLinksDevicesAndMoreThanAnySequenceHas) {
  const std::string made = at("made/rgbd_dataset_freiburg1_room");
  struct Case {
    std::string spoil, reason;
  };
  const std::vector<Case> cases = {{"ln -s /etc/passwd '" + made + "/link'", "neither a file nor a folder"},
                                   {"mkfifo '" + made + "/pipe'", "neither a file nor a folder"},
                                   {"truncate -s 80G '" + made + "/zeros'", "more than any sequence has"}};
  for (const auto& [spoil, reason] : cases) {
    const auto packed = shell("rm -rf '" + at("data") + "' && " + spoil + " && tar -S -C '" + at("made") +
                              "' -czf '" + at("bad.tgz") + "' rgbd_dataset_freiburg1_room; rm -f '" + made +
                              "'/link '" + made + "'/pipe '" + made + "'/zeros");
    ASSERT_EQ(packed.exit_code, kDone) << packed.err;
    const Run refused = fetch(test::HttpServer(kPath, read_file(at("bad.tgz"))));
    EXPECT_EQ(refused.exit_code, kBadInput) << spoil;
    EXPECT_THAT(refused.err, HasSubstr(reason)) << spoil;
  }
}

TEST_F(CameraCommands, RecordGivesTheSameSequenceBack) {
  ASSERT_EQ(run("simulate room --frames 6 --size 160x120 --quiet -o '" + at("a") + "'").exit_code, kDone);
  const Run recorded = run("record '" + at("a") + "' -o '" + at("b") + "'");
  ASSERT_EQ(recorded.exit_code, kDone) << recorded.err;
  EXPECT_THAT(recorded.out, HasSubstr("6 frames"));
  ASSERT_EQ(run("record '" + at("b") + "' -o '" + at("c") + "' --threads 1").exit_code, kDone);
  EXPECT_EQ(read_file(at("b/rgb.txt")), read_file(at("a/rgb.txt")));
  size_t images = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(at("b"))) {
    if (!entry.is_regular_file()) continue;
    const auto name = std::filesystem::relative(entry.path(), at("b"));
    EXPECT_EQ(read_file(entry.path()), read_file(std::filesystem::path(at("c")) / name)) << name;
    images += name.has_parent_path() ? 1 : 0;
  }
  EXPECT_EQ(images, 12U) << "of colour and depth";
}

TEST_F(CameraCommands, SimulatesADepthCameraOfItsOwn) {
  ASSERT_EQ(
      run("simulate room --sensor realsense --frames 2 --size 160x120 -q -o '" + at("a") + "'").exit_code,
      kDone);
  EXPECT_THAT(read_file(at("a/camera.yaml")),
              AllOf(HasSubstr("sensor: realsense_d4xx"), HasSubstr("depth: {width: 212, height: 120")));
  ASSERT_EQ(run("record '" + at("a") + "' -o '" + at("b") + "'").exit_code, kDone);
  EXPECT_THAT(read_file(at("b/camera.yaml")), Not(HasSubstr("depth: {")));  // registered to colour
}

TEST_F(CameraCommands, SimulateWritesMasksOfWhatMovesAndOnlyThen) {
  const std::string simulate = "simulate room --frames 2 --size 160x120 -q ";
  ASSERT_EQ(run(simulate + "--set movers.people=1 -o '" + at("people") + "'").exit_code, kDone);
  for (const char* stamp : {"1.000000", "1.033333"}) {
    const cv::Mat mask = cv::imread(at("people/movers/" + std::string(stamp) + ".png"), cv::IMREAD_UNCHANGED);
    EXPECT_EQ(mask.size(), cv::Size(160, 120));
    EXPECT_TRUE(std::filesystem::exists(at("people/rgb/" + std::string(stamp) + ".png")));
  }
  ASSERT_EQ(run(simulate + "-o '" + at("nobody") + "'").exit_code, kDone);
  EXPECT_FALSE(std::filesystem::exists(at("nobody/movers")));
  EXPECT_EQ(run(simulate + "--set movers.dogs=1 -o '" + at("dogs") + "'").exit_code, kWrongUse);
}

TEST_F(CameraCommands, RecordAsOneFileGivesTheSameSequence) {
  ASSERT_EQ(run("simulate room --frames 6 --size 160x120 --quiet -o '" + at("a") + "'").exit_code, kDone);
  ASSERT_EQ(run("record '" + at("a") + "' -o '" + at("b") + "'").exit_code, kDone);
  const Run one_file = run("record '" + at("a") + "' -o '" + at("m.mcap") + "'");
  ASSERT_EQ(one_file.exit_code, kDone) << one_file.err;
  EXPECT_THAT(one_file.out, HasSubstr("6 frames"));
  ASSERT_EQ(run("record '" + at("m.mcap") + "' -o '" + at("c") + "' --threads 1").exit_code, kDone);
  for (const char* list : {"rgb.txt", "depth.txt", "associations.txt", "camera.yaml"})
    EXPECT_EQ(read_file(std::filesystem::path(at("c")) / list),
              read_file(std::filesystem::path(at("b")) / list));
  for (const char* images : {"b/rgb", "b/depth"}) {
    size_t compared = 0;
    for (const auto& entry : std::filesystem::directory_iterator(at(images))) {
      const auto name = std::filesystem::relative(entry.path(), at("b"));
      EXPECT_EQ(read_file(entry.path()), read_file(std::filesystem::path(at("c")) / name)) << name;
      ++compared;
    }
    EXPECT_EQ(compared, 6U) << images;
  }
  const Run again = run("record '" + at("a") + "' -o '" + at("m.mcap") + "'");
  EXPECT_EQ(again.exit_code, kBadInput);
  EXPECT_THAT(again.err, HasSubstr("already exists"));
}

TEST_F(CameraCommands, ARecordingWhoseSourceFailsKeepsTheFramesBefore) {
  ASSERT_EQ(run("simulate room --frames 6 --size 160x120 --quiet -o '" + at("a") + "'").exit_code, kDone);
  const auto send = test::source_folder() / "docs/examples/python/stream_frames.py";
  ASSERT_EQ(shell("python3 '" + send.string() + "' '" + at("a") + "' >'" + at("bytes") + "'").exit_code,
            kDone);
  for (const char* recording : {"folder", "file.mcap"}) {
    const Run cut =
        shell("head -c -1 '" + at("bytes") + "' | '" KINLOOP_PROGRAM "' record - -o '" + at(recording) + "'");
    EXPECT_EQ(cut.exit_code, kBadInput) << cut.err;
    EXPECT_THAT(cut.out, HasSubstr("5 frames"));
    const Run read = run("probe '" + at(recording) + "'");
    EXPECT_THAT(read.out, HasSubstr("5 frames, 0 damaged")) << read.err;
  }
}

TEST_F(CameraCommands, ARecordingThatFillsTheDiskKeepsTheFramesBefore) {
  const Run full = run("record sim:room --frames 40 -o '" + at("file.mcap") + "'", "ulimit -f 8000;");
  EXPECT_EQ(full.exit_code, kBadInput) << full.err;
  EXPECT_THAT(full.err, HasSubstr("disk full"));
  EXPECT_THAT(run("probe '" + at("file.mcap") + "'").out, HasSubstr("640 x 480"));
}

TEST_F(CameraCommands, ARecordingThatFillsASmallDiskKeepsTheFramesThatFitted) {
  test::write_room(at("small"), "--frames 60");
  const Run full = run("record '" + at("small") + "' -o '" + at("file.mcap") + "'", "ulimit -f 1000;");
  EXPECT_EQ(full.exit_code, kBadInput) << full.err;
  EXPECT_THAT(full.err, HasSubstr("file.mcap: writing failed; is the disk full?"));
  const auto read = open_bag(at("file.mcap"), {});
  size_t frames = 0;
  while (read->next()) ++frames;
  ASSERT_EQ(run("record '" + at("small") + "' -o '" + at("whole.mcap") + "'").exit_code, kDone);
  const size_t bytes_per_frame = std::filesystem::file_size(at("whole.mcap")) / 60;
  const size_t fitting = std::filesystem::file_size(at("file.mcap")) / bytes_per_frame;
  EXPECT_GT(fitting, 3U);
  EXPECT_GE(frames + 2, fitting);
}

TEST_F(CameraCommands, TheNextRecordingRecoversThatOfAKilledProcess) {
  ASSERT_EQ(run("record sim:room --frames 6 -o '" + at("whole.mcap") + "'").exit_code, kDone);
  const std::string bytes = read_file(at("whole.mcap"));
  folder_.write("kinloop-1-0.tmp", bytes.substr(0, bytes.size() / 2));
  const Run next = run("record sim:room --frames 1 -o '" + at("next.mcap") + "'");
  EXPECT_EQ(next.exit_code, kDone);
  EXPECT_THAT(next.err, HasSubstr("recovered-1-0.mcap"));
  EXPECT_FALSE(std::filesystem::exists(at("kinloop-1-0.tmp")));
  EXPECT_EQ(run("probe '" + at("recovered-1-0.mcap") + "'").exit_code, kDone);
}

TEST_F(CameraCommands, ReportsMissingCameras) {
  const std::pair<std::string, std::string> parts[] = {{"kinect1", "Kinect 1"}, {"kinect2", "Kinect 2"},
                                                       {"openni2", "OpenNI2"},  {"realsense", "RealSense"},
                                                       {"orbbec", "Orbbec"},    {"oak", "OAK"}};
  for (const auto& [camera, part] : parts) {
    const bool known = has(part);
    const Run result = run("run " + camera + " -o '" + at("out") + "'");
    EXPECT_EQ(result.exit_code, known ? kBadInput : kWrongUse) << result.err;
    EXPECT_THAT(result.err, AllOf(HasSubstr(camera), HasSubstr(known ? "no " : "this build")));
  }
}

#ifdef KINLOOP_FAKE_FREENECT
/// A substitute for libfreenect sends five frames and then stops.
TEST_F(CameraCommands, Kinect1IsRecordedUntilItIsUnplugged) {
  const Run result = run("record kinect1 --set reconnect_s=0 -o '" + at("out") + "'",
                         "LD_PRELOAD='" KINLOOP_FAKE_FREENECT "'");
  EXPECT_EQ(result.exit_code, kDone) << result.err;
  EXPECT_THAT(result.out, HasSubstr("5 frames"));
  EXPECT_THAT(result.err, AllOf(HasSubstr("no --camera"), HasSubstr("for the camera to return"),
                                HasSubstr("the camera did not return")));
  const auto rows = read_table(at("out/associations.txt"));
  ASSERT_EQ(rows.size(), 5U);
  const double lasted_s = std::stod(rows.back().fields[0]) - std::stod(rows.front().fields[0]);
  EXPECT_NEAR(lasted_s, 4 * 2e6 / 60e6, 1e-5) << "across the wrap-around of the device's counter";
  EXPECT_EQ(rows.front().fields[0], rows.front().fields[2]);
}
#endif

TEST_F(CameraCommands, CalibrateWritesACameraFiguresAndAReport) {
  const auto stills = test::shared_data("kinect2_checkerboard/sync");
  KINLOOP_SKIP_WITHOUT(stills);
  const std::string board = "' --board 5x7 --square 0.03 -o '" + at("camera.yaml") + "'";
  const Run extrinsics = run("calibrate extrinsics '" + stills.string() + board);
  ASSERT_EQ(extrinsics.exit_code, kDone) << extrinsics.err;
  EXPECT_THAT(extrinsics.out,
              AllOf(HasSubstr("10 of 10"), HasSubstr("baseline"), HasSubstr("rejected: 0013_ir.png")));
  EXPECT_THAT(extrinsics.err, HasSubstr("do not constrain the focal length"));
  EXPECT_THAT(read_file(at("camera.yaml")), AllOf(HasSubstr("depth: {"), HasSubstr("T_color_depth")));
  EXPECT_THAT(read_file(at("camera.html")), AllOf(HasSubstr("<svg"), HasSubstr("Coverage of the image")));
  const Run depth = run("calibrate depth '" + stills.string() + "' --camera '" + at("camera.yaml") + board);
  ASSERT_EQ(depth.exit_code, kDone) << depth.err;
  EXPECT_THAT(depth.out, HasSubstr("depth shift"));
  EXPECT_THAT(read_file(at("camera_depth.html")), HasSubstr("<svg"));
  EXPECT_THAT(read_file(at("camera.html")), HasSubstr("Coverage of the image")) << "the other report is kept";
  EXPECT_THAT(read_file(at("camera.yaml")), HasSubstr("depth_shift_m:"));
  EXPECT_THAT(read_file(at("camera.json")), AllOf(HasSubstr("\"deviation\""), HasSubstr("\"depth_shift\"")));
}

/// A sequence of a board that is held still at each of its poses.
void write_boards(const std::filesystem::path& folder) {
  RgbdCamera camera;
  camera.color = test::infrared_camera();
  TumWriter writer(folder, camera);
  Random random(3);
  int64_t stamp_ns = 0;
  for (int pose = 0; pose < 5; ++pose) {
    const cv::Mat gray = test::in_8_bits(
        test::picture(camera.color, test::random_pose(random, test::small_board()), test::small_board()));
    cv::Mat color;
    cv::cvtColor(gray, color, cv::COLOR_GRAY2BGR);
    Frame frame;
    frame.color = color;
    frame.depth_m = cv::Mat(gray.size(), CV_32FC1, cv::Scalar(0.5));
    for (int i = 0; i < 2; ++i) {
      frame.stamp_ns = stamp_ns += 33'000'000;
      writer.append(frame);
    }
  }
  writer.finish();
}

TEST_F(CameraCommands, CalibrateTakesStillsFromALiveCamera) {
  write_boards(at("live"));
  const std::string rest =
      " --live '" + at("live") + "' --board 5x7 --square 0.03 -o '" + at("camera.yaml") + "'";
  const Run run_live = run("calibrate intrinsics '" + at("stills") + "' --viewer=0" + rest);
  ASSERT_EQ(run_live.exit_code, kDone) << run_live.err;
  EXPECT_THAT(run_live.out, AllOf(HasSubstr("hold the board still"), HasSubstr("away from the camera"),
                                  HasSubstr("5 stills in"), HasSubstr("5 of 5 images")));
  EXPECT_THAT(run_live.err, HasSubstr("viewer at http"));
  EXPECT_TRUE(std::filesystem::exists(at("stills/0005.png")));
  EXPECT_TRUE(std::filesystem::exists(at("camera.yaml")));

  const Run again = run("calibrate intrinsics '" + at("stills") + "'" + rest);
  EXPECT_EQ(again.exit_code, kBadInput);
  EXPECT_THAT(again.err, HasSubstr("not empty"));
  const Run pairs = run("calibrate extrinsics '" + at("pairs") + "'" + rest);
  EXPECT_EQ(pairs.exit_code, kBadInput);
  EXPECT_THAT(pairs.err, HasSubstr("no infrared"));
}

TEST_F(CameraCommands, CalibrateSuggestsTheDetectedBoardSize) {
  const auto stills = test::shared_data("kinect2_checkerboard/colour");
  KINLOOP_SKIP_WITHOUT(stills);
  const std::string start = "calibrate intrinsics '" + stills.string() + "' -o '" + at("camera.yaml") + "' ";
  const Run board = run(start + "--board 6x8 --square 0.03");
  EXPECT_EQ(board.exit_code, kBadInput);
  EXPECT_THAT(board.err, AllOf(HasSubstr("no 6x8 board"), HasSubstr("use --board 5x7")));
  const Run square = run(start + "--board 5x7 --square 30");
  EXPECT_EQ(square.exit_code, kWrongUse);
  EXPECT_THAT(square.err, HasSubstr("30 mm is 0.03"));
}

TEST_F(CameraCommands, CalibrateRefusesANameThatItsOtherResultsTake) {
  std::filesystem::create_directory(at("empty"));
  for (const char* name : {"cam.json", "cam.html"}) {
    const Run refused = run("calibrate intrinsics '" + at("empty") + "' --square 0.03 -o '" + at(name) + "'");
    EXPECT_EQ(refused.exit_code, kWrongUse) << name;
    EXPECT_THAT(refused.err, HasSubstr(".yaml")) << name;
  }
}

TEST_F(CameraCommands, CalibrateSaysWhatIsWrong) {
  EXPECT_EQ(run("calibrate intrinsics '" + at("absent") + "' --square 0.03").exit_code, kBadInput);
  std::filesystem::create_directory(at("empty"));
  EXPECT_THAT(run("calibrate intrinsics '" + at("empty") + "' --square 0.03").err,
              HasSubstr("no PNG or JPEG"));
  const Run board = run("calibrate intrinsics '" + at("empty") + "' --square 0.03 --board 5");
  EXPECT_EQ(board.exit_code, kBadInput) << "the folder is checked first";
  EXPECT_EQ(
      run("calibrate intrinsics '" + at("empty") + "' --square 0.03 --set distortion_terms=3").exit_code,
      kWrongUse);
  EXPECT_EQ(run("calibrate").exit_code, kWrongUse);
  EXPECT_THAT(run("calibrate depth x --square 0.03 --depth-scale 0").err,
              HasSubstr("'0' must be a positive number"));
}

}  // namespace
}  // namespace kinloop
