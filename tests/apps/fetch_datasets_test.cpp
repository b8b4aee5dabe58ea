// kinloop fetch of every dataset that it knows, from a local server of small look-alikes in the dataset's
// layout; kinloop run opens what was fetched.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "kinloop/core/files/text_file.hpp"
#include "tests/apps/http_server.hpp"
#include "tests/apps/program_test.hpp"

namespace kinloop {
namespace {

using testing::AllOf;
using testing::HasSubstr;

using test::kBadInput;
using test::kDone;
using test::kWrongUse;

namespace fs = std::filesystem;

class FetchNames : public test::ProgramTest {
 protected:
  void SetUp() override {
    if (run("--version").out.find("downloads: yes") == std::string::npos)
      GTEST_SKIP() << "this build cannot download";
  }

  /// The bytes of an archive of what is in made/; made/ is empty afterwards.
  [[nodiscard]] std::string pack(const std::string& format) const {
    const std::string options = format == "zip" ? "cf archive --format=zip" : "czf archive";
    const Run packed = shell("cd '" + at("made") + "' && cmake -E tar " + options + " * && mv archive ..");
    EXPECT_EQ(packed.exit_code, kDone) << packed.err;
    fs::remove_all(at("made"));
    return read_file(at("archive"));
  }

  [[nodiscard]] Run fetch(const std::string& name, const test::HttpServer& server) const {
    return run("fetch " + name + " -q -o '" + at("data") + "' --server " + server.address());
  }
};

class FetchDatasets : public FetchNames {
 protected:
  static constexpr size_t kFrames = 3;

  void SetUp() override {
    FetchNames::SetUp();
    if (IsSkipped()) return;
    test::write_room(at("room"), "--frames 3 --size 640x480");
    color_ = read_table(at("room/rgb.txt"));
    depth_ = read_table(at("room/depth.txt"));
    ASSERT_EQ(color_.size(), kFrames);
    ASSERT_EQ(depth_.size(), kFrames);
  }

  [[nodiscard]] fs::path color(size_t i) const { return at("room/" + color_[i].fields[1]); }
  [[nodiscard]] fs::path depth(size_t i) const { return at("room/" + depth_[i].fields[1]); }

  /// Copies parts of the simulated room into made/FOLDER.
  void copy(const std::string& folder, const std::vector<std::string>& parts) const {
    fs::create_directories(at("made/" + folder));
    for (const std::string& part : parts)
      fs::copy(at("room/" + part), at("made/" + folder + "/" + part), fs::copy_options::recursive);
  }

  /// The depth of a frame in another unit.
  void write_depth(size_t i, const std::string& file, double per_metre) const {
    cv::Mat image = cv::imread(depth(i).string(), cv::IMREAD_UNCHANGED);
    image.convertTo(image, CV_16U, per_metre / 5000);
    ASSERT_TRUE(cv::imwrite(at("made/" + file), image));
  }

  /// Fetches `name`, which must come to data/FOLDER and be opened by kinloop in that layout.
  void expect_fetched(const std::string& name, const test::HttpServer& server, const std::string& folder,
                      const std::string& layout) const {
    const Run fetched = fetch(name, server);
    ASSERT_EQ(fetched.exit_code, kDone) << fetched.err;
    EXPECT_THAT(fetched.out, testing::StartsWith(at("data/" + folder) + "\nlicence: "));
    const size_t downloads = server.downloads;
    EXPECT_EQ(fetch(name, server).out, at("data/" + folder) + "\nalready exists\n");
    EXPECT_EQ(server.downloads, downloads);
    for (const auto& entry : fs::recursive_directory_iterator(at("data")))
      EXPECT_NE(entry.path().extension(), ".part") << entry.path();
    const std::string path = "'" + at("data/" + folder) + "'";
    const Run opened = run("run " + path + " --quiet --no-loop -o '" + at("map") + "'");
    EXPECT_EQ(opened.exit_code, kDone) << opened.err;
    EXPECT_THAT(read_file(at("map/run.json")), HasSubstr("\"frames\": 3"));
    EXPECT_THAT(run("probe " + path).out, HasSubstr(layout));
  }

  std::vector<TextLine> color_, depth_;
};

const std::vector<std::string> kTumParts = {"rgb", "depth", "rgb.txt", "depth.txt", "groundtruth.txt"};

TEST_F(FetchDatasets, TumIsOneArchiveOfACameraAndASequence) {
  copy("rgbd_dataset_freiburg2_desk", kTumParts);
  const test::HttpServer server("/freiburg2/rgbd_dataset_freiburg2_desk.tgz", pack("tgz"));
  expect_fetched("tum/fr2_desk", server, "rgbd_dataset_freiburg2_desk", "TUM");
  EXPECT_FALSE(fs::exists(at("data/rgbd_dataset_freiburg2_desk.tgz")));
}

TEST_F(FetchDatasets, Eth3dIsTheColourAndTheDepthArchiveInOneFolder) {
  copy("cables_1", {"rgb", "rgb.txt", "groundtruth.txt"});
  folder_.write("made/cables_1/calibration.txt", "525 525 319.5 239.5\n");
  const std::string mono = pack("zip");
  copy("cables_1", {"depth", "depth.txt"});
  const test::HttpServer server({{"/cables_1_mono.zip", mono}, {"/cables_1_rgbd.zip", pack("zip")}});
  expect_fetched("eth3d/cables_1", server, "cables_1", "ETH3D");
  EXPECT_EQ(server.downloads, 2U);
}

TEST_F(FetchNames, Eth3dKeepsTheColourArchiveWhenDepthIsMissing) {
  folder_.write("made/cables_1/rgb.txt", "1 rgb/1.png\n");
  const std::string mono = pack("zip");
  const test::HttpServer server("/cables_1_mono.zip", mono);
  EXPECT_EQ(fetch("eth3d/cables_1", server).exit_code, kBadInput);
  EXPECT_EQ(read_file(at("data/cables_1_mono.zip")), mono);
  EXPECT_FALSE(fs::exists(at("data/cables_1")));
}

TEST_F(FetchDatasets, IclNuimHasNoFolderInItsArchive) {
  for (const auto& [name, archive, folder, truth] :
       {std::tuple{"icl/living_room_traj0", "/living_room_traj0_frei_png.tar.gz",
                   "living_room_traj0_frei_png", "livingRoom0.gt.freiburg"},
        std::tuple{"icl/office_traj3", "/traj3_frei_png.tar.gz", "office_traj3_frei_png",
                   "traj3.gt.freiburg"}}) {
    fs::create_directories(at("made/rgb"));
    fs::create_directories(at("made/depth"));
    std::string associations, poses;
    for (size_t i = 0; i < kFrames; ++i) {
      const std::string number = std::to_string(i + 1);
      fs::copy(color(i), at("made/rgb/" + number + ".png"));
      fs::copy(depth(i), at("made/depth/" + number + ".png"));
      associations += number + " depth/" + number + ".png " + number + " rgb/" + number + ".png\n";
      poses += number + " 0 0 -2.25 0 0 0 1\n";
    }
    folder_.write("made/associations.txt", associations);
    folder_.write(std::string("made/") + truth, poses);
    expect_fetched(name, test::HttpServer(archive, pack("tgz")), folder, "ICL-NUIM");
  }
}

TEST_F(FetchDatasets, SevenScenesDownloadsASceneOnceForAllItsSequences) {
  std::map<std::string, std::string> sequences;
  for (const std::string sequence : {"seq-01", "seq-12"}) {
    fs::create_directories(at("made/" + sequence));
    for (size_t i = 0; i < kFrames; ++i) {
      const std::string frame = sequence + "/frame-00000" + std::to_string(i);
      fs::copy(color(i), at("made/" + frame + ".color.png"));
      write_depth(i, frame + ".depth.png", 1000);
      folder_.write("made/" + frame + ".pose.txt", "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
    }
    sequences[sequence] = pack("zip");
  }
  for (const auto& [sequence, archive] : sequences)
    folder_.write("made/redkitchen/" + sequence + ".zip", archive);
  const test::HttpServer server("/redkitchen.zip", pack("zip"));
  expect_fetched("7scenes/redkitchen/seq-12", server, "7scenes/redkitchen/seq-12", "7-Scenes");
  expect_fetched("7scenes/redkitchen/seq-01", server, "7scenes/redkitchen/seq-01", "7-Scenes");
  EXPECT_EQ(server.downloads, 1U);
  const Run missing = fetch("7scenes/redkitchen/seq-09", server);
  EXPECT_EQ(missing.exit_code, kBadInput);
  EXPECT_THAT(missing.err, HasSubstr("contains no seq-09"));
}

TEST_F(FetchDatasets, BonnIsOneArchiveASequence) {
  copy("rgbd_bonn_balloon", kTumParts);
  const test::HttpServer server("/rgbd_bonn_balloon.zip", pack("zip"));
  expect_fetched("bonn/balloon", server, "rgbd_bonn_balloon", "Bonn");
}

TEST_F(FetchDatasets, ReplicaDownloadsItsOneArchiveOnce) {
  for (const std::string room : {"room0", "office4"}) {
    fs::create_directories(at("made/Replica/" + room + "/results"));
    std::string poses;
    for (size_t i = 0; i < kFrames; ++i) {
      const std::string number = "00000" + std::to_string(i);
      ASSERT_TRUE(cv::imwrite(at("made/Replica/" + room + "/results/frame" + number + ".jpg"),
                              cv::imread(color(i).string())));
      write_depth(i, "Replica/" + room + "/results/depth" + number + ".png", 6553.5);
      poses += "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1\n";
    }
    folder_.write("made/Replica/" + room + "/traj.txt", poses);
  }
  folder_.write("made/Replica/cam_params.json",
                R"({"camera": {"w": 640, "h": 480, "fx": 525, "fy": 525, "cx": 319.5, "cy": 239.5,
                    "scale": 6553.5}})");
  const test::HttpServer server("/Replica.zip", pack("zip"));
  expect_fetched("replica/room0", server, "Replica/room0", "Replica");
  EXPECT_THAT(fetch("replica/office4", server).out, HasSubstr("already exists"));
  EXPECT_EQ(server.downloads, 1U);
}

TEST_F(FetchDatasets, OpenLorisIsAnArchiveOfAnArchiveASequence) {
  std::map<std::string, std::string> sequences;
  for (const std::string sequence : {"home1-2", "home1-5", "corridor1-1"}) {
    for (const std::string folder : {"color", "aligned_depth"})
      fs::create_directories(at("made/" + sequence + "/" + folder));
    std::string colors, depths;
    for (size_t i = 0; i < kFrames; ++i) {
      const std::string stamp = fmt::format("15600048{}.5", 10 + i);
      fs::copy(color(i), at("made/" + sequence + "/color/" + stamp + ".png"));
      write_depth(i, sequence + "/aligned_depth/" + stamp + ".png", 1000);
      colors += stamp + " color/" + stamp + ".png\n";
      depths += stamp + " aligned_depth/" + stamp + ".png\n";
    }
    folder_.write("made/" + sequence + "/color.txt", colors);
    folder_.write("made/" + sequence + "/aligned_depth.txt", depths);
    folder_.write("made/" + sequence + "/sensors.yaml",
                  "%YAML:1.0\n---\nd400_color_optical_frame:\n   width: 640\n   height: 480\n   intrinsics: "
                  "!!opencv-matrix\n      rows: 1\n      cols: 4\n      dt: d\n"
                  "      data: [ 525, 319.5, 525, 239.5 ]\n");
    sequences[sequence] = pack("7zip");
  }
  for (const std::string sequence : {"home1-2", "home1-5"})
    folder_.write("made/" + sequence + ".7z", sequences[sequence]);
  const test::HttpServer server({{"/package/home1-1_5-package.tar", pack("gnutar")},
                                 {"/package/corridor1-1.7z", sequences["corridor1-1"]}});
  expect_fetched("openloris/home1-5", server, "openloris/home1/home1-5", "OpenLORIS");
  expect_fetched("openloris/home1-2", server, "openloris/home1/home1-2", "OpenLORIS");
  EXPECT_EQ(server.downloads, 1U);
  expect_fetched("openloris/corridor1-1", server, "openloris/corridor1-1", "OpenLORIS");
}

TEST_F(FetchNames, ScanNetIsARecordingAtTheAddressThatTheUserWasGiven) {
  const test::HttpServer server("/v2/scans/scene0011_01/scene0011_01.sens", "x");
  const std::string command = "fetch scannet/scene0011_01 -q -o '" + at("data") + "'";
  const std::string expected = at("data/scannet/scene0011_01");
  const Run fetched = run(command, "KINLOOP_SCANNET_SERVER=" + server.address() + "/");
  ASSERT_EQ(fetched.exit_code, kDone) << fetched.err;
  EXPECT_THAT(fetched.out, testing::StartsWith(expected + "\nlicence: ScanNet"));
  EXPECT_EQ(read_file(expected + "/scene0011_01.sens"), "x");
  EXPECT_EQ(run(command).out, expected + "\nalready exists\n");
  EXPECT_EQ(
      run("fetch scannet/scene0011_02 -q -o '" + at("data") + "' --server " + server.address()).exit_code,
      kBadInput);
}

TEST_F(FetchNames, AFolderWithoutASequenceIsNotReplaced) {
  folder_.write("data/rgbd_bonn_balloon/mine.txt", "x");
  const Run refused = fetch("bonn/balloon", test::HttpServer("/rgbd_bonn_balloon.zip", "x"));
  EXPECT_EQ(refused.exit_code, kBadInput);
  EXPECT_THAT(refused.err, AllOf(HasSubstr("contains no rgb.txt"), HasSubstr("move it away")));
}

TEST_F(FetchNames, ListNamesTheDatasetsAndTheirLicences) {
  const Run list = run("fetch --list");
  EXPECT_EQ(list.exit_code, kDone);
  for (const char* name : {"tum/fr1_room", "eth3d/cables_1", "icl/living_room_traj0", "icl/office_traj0",
                           "7scenes/redkitchen/seq-01", "bonn/balloon", "replica/room0", "CC BY-NC-SA 4.0",
                           "ScanNet", "OpenLORIS"}) {
    EXPECT_THAT(list.out, HasSubstr(name));
  }
  EXPECT_EQ(run("fetch").exit_code, kWrongUse);
}

TEST_F(FetchNames, ADatasetThatMustBeAskedForSaysHow) {
  const Run scannet = run("fetch scannet/scene0000_00 -o '" + at("data") + "'");
  EXPECT_EQ(scannet.exit_code, kWrongUse);
  EXPECT_THAT(scannet.err, AllOf(HasSubstr("terms of use"), HasSubstr("download-scannet.py"),
                                 HasSubstr("KINLOOP_SCANNET_SERVER")));
}

TEST_F(FetchNames, NamesOfNoSequenceAreRefused) {
  for (const char* name :
       {"icl/living_room_traj4", "7scenes/kitchen/seq-01", "7scenes/chess", "replica/room3", "eth3d/../x",
        "openloris/cafe1-3", "scannet/scene1", "bonn/", "kitti/00"}) {
    const Run refused = run(std::string("fetch ") + name);
    EXPECT_EQ(refused.exit_code, kWrongUse) << name;
    EXPECT_THAT(refused.err, HasSubstr("not a known sequence")) << name;
  }
}

}  // namespace
}  // namespace kinloop
