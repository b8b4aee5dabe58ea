// Map files, end to end: run, map, export.

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "apps/map/withdraw_from_file.hpp"
#include "dense/files/ply.hpp"
#include "drivers/bags/bag_files.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "kinloop/core/time.hpp"
#include "kinloop/io/map_file/map_file.hpp"
#include "kinloop/sensor/images/jpeg_codec.hpp"
#include "kinloop/sensor/sensor_estimate.hpp"
#include "kinloop/slam/saved_session.hpp"
#include "tests/apps/program_test.hpp"

namespace kinloop {
namespace {

using test::kBadInput;
using test::kWrongUse;
using testing::HasSubstr;
using testing::Not;

constexpr const char* kSmall = " --set sim.frames=20 --set sim.width=160 --set sim.height=120 -q ";

/// One short run shared by all tests, with its results.
class MapCommand : public testing::Test {
 protected:
  static void SetUpTestSuite() { folder_ = std::make_unique<test::TempFolder>(); }
  static void TearDownTestSuite() { folder_.reset(); }

  [[nodiscard]] static std::string at(const std::string& name) { return (folder_->path() / name).string(); }

  static int run(const std::string& arguments, const std::string& before = "") {
    const test::ProgramRun done = test::run_program(*folder_, arguments, before);
    out_ = done.out, err_ = done.err;
    return done.exit_code;
  }

  /// The folder of the run.
  static std::string ran() {
    if (!std::filesystem::exists(at("run"))) {
      EXPECT_EQ(run("run sim:room" + std::string(kSmall) + "-o " + at("run")), 0) << err_;
    }
    return at("run");
  }

  /// Returns what puts a shell script in the place of Python, which writes recordings for Rerun. Called with
  /// one word, it is asked for Rerun's package; else the third is the recording.
  static std::string with_python(const std::string& script) {
    folder_->write("programs/python3", "#!/bin/sh\n[ $# -eq 1 ] && exit 0\n" + script + "\n");
    std::filesystem::permissions(at("programs/python3"), std::filesystem::perms::owner_all);
    return "PATH='" + at("programs") + "':\"$PATH\"";
  }

  static std::unique_ptr<test::TempFolder> folder_;
  static std::string out_, err_;
};

std::unique_ptr<test::TempFolder> MapCommand::folder_;
std::string MapCommand::out_, MapCommand::err_;

TEST_F(MapCommand, ExportReproducesTheFilesOfTheRun) {
  const std::string folder = ran();
  ASSERT_EQ(run("export " + folder + " -q --trajectory " + at("t.txt") + " --keyframes " + at("k.txt") +
                " --graph " + at("g.g2o") + " --cloud " + at("c.ply")),
            0)
      << err_;
  EXPECT_TRUE(read_file(at("t.txt")) == read_file(folder + "/trajectory.txt"));
  EXPECT_TRUE(read_file(at("k.txt")) == read_file(folder + "/keyframes.txt"));
  EXPECT_TRUE(read_file(at("g.g2o")) == read_file(folder + "/graph.g2o"));
  EXPECT_TRUE(read_file(at("c.ply")) == read_file(folder + "/map.ply"));
}

/// The map of `input` as another version would have written it, which knew `options` alone.
void write_with_options(const std::filesystem::path& input, const std::filesystem::path& output,
                        std::vector<std::pair<std::string, std::string>> options) {
  const MapReader reader(input);
  SavedMap saved = reader.read().first;
  saved.options = std::move(options);
  std::vector<SavedImages> images;
  reader.read_images([&](SavedImages image) { images.push_back(std::move(image)); });
  write_map(output, saved, images.size(), [&](size_t index) { return images[index]; });
}

TEST_F(MapCommand, OptionsOfAMapThatThisVersionDoesNotKnowAreIgnored) {
  const std::string map = ran() + "/map.kinmap";
  write_with_options(
      map, at("other.kinmap"),
      {{"mapping.no_such_option", "40"}, {"dense.max_depth_m", "2"}, {"dense.no_such_m", "3"}});
  write_with_options(map, at("reference.kinmap"), {{"dense.max_depth_m", "2"}});
  write_with_options(map, at("default.kinmap"), {});
  const auto cloud_of = [](const std::string& name) {
    const std::string cloud = at(name + ".ply");
    EXPECT_EQ(run("export " + at(name + ".kinmap") + " -q --cloud " + cloud), 0) << err_;
    EXPECT_EQ(err_, "") << name;
    return read_file(cloud);
  };
  const std::string reference = cloud_of("reference");
  EXPECT_FALSE(cloud_of("default") == reference) << "the option makes no difference here";
  EXPECT_TRUE(cloud_of("other") == reference);
}

TEST_F(MapCommand, CloudsAreUprightAndStoreTheirRotation) {
  const std::string folder = ran();
  const auto figures = nlohmann::json::parse(read_file(folder + "/run.json"));
  const auto& up = figures["up"]["direction"];
  EXPECT_THAT(figures["up"]["source"].get<std::string>(), testing::AnyOf("planes", "camera"));
  EXPECT_EQ(figures["map"]["frame"], "z-up");
  const auto& q = figures["map"]["rotation_xyzw"];
  const Eigen::Quaterniond R_file_world(q[3].get<double>(), q[0].get<double>(), q[1].get<double>(),
                                        q[2].get<double>());
  const Eigen::Vector3d turned =
      R_file_world * Eigen::Vector3d(up[0].get<double>(), up[1].get<double>(), up[2].get<double>());
  EXPECT_LT((turned - Eigen::Vector3d::UnitZ()).norm(), 1e-9);
  const std::string cloud = read_file(folder + "/map.ply");
  EXPECT_THAT(cloud.substr(0, 400), HasSubstr("comment rotation_xyzw " + q[0].dump()));
  EXPECT_THAT(cloud.substr(0, 600), HasSubstr("property float nx"));

  ASSERT_EQ(run("export " + folder + " -q --frame camera --cloud " + at("camera.ply")), 0) << err_;
  EXPECT_THAT(read_file(at("camera.ply")).substr(0, 400), HasSubstr("comment frame camera"));
  EXPECT_EQ(run("export " + folder + " --frame level --cloud " + at("x.ply")), kWrongUse);
}

TEST_F(MapCommand, ExportsForOtherProgramsCoverTheWholeMap) {
  const std::string folder = ran();
  ASSERT_EQ(run("export " + folder + " -q --colmap " + at("model") + " --nerfstudio " + at("model") +
                " --mcap " + at("m.mcap") + " --cloud " + at("c.las") + " --trajectory " + at("t.csv")),
            0)
      << err_;
  ASSERT_EQ(run("map info --json " + folder), 0);
  const size_t images = nlohmann::json::parse(out_)["images"];
  const auto files_in = [](const std::string& name) {
    const std::filesystem::directory_iterator files(at(name));
    return static_cast<size_t>(std::distance(begin(files), end(files)));
  };
  EXPECT_EQ(files_in("model/images"), images);
  EXPECT_EQ(files_in("model/depth"), images);
  const auto transforms = nlohmann::json::parse(read_file(at("model/transforms.json")));
  ASSERT_EQ(transforms["frames"].size(), images);
  for (const auto& frame : transforms["frames"])
    EXPECT_TRUE(std::filesystem::exists(at("model/") + frame["file_path"].get<std::string>()));
  EXPECT_GT(read_table(at("model/sparse/0/points3D.txt")).size(), 50U);
  const size_t poses = read_table(folder + "/trajectory.txt").size();
  EXPECT_EQ(read_table(at("t.csv")).size(), poses + 1);
  const auto recording = open_mcap(at("m.mcap"));
  ASSERT_GE(recording->topics().size(), 3U);
  for (const BagTopic* topic : recording->topics()) {
    const bool of_images = topic->name.starts_with("/camera");
    EXPECT_EQ(topic->messages, topic->name == "/cloud" ? 1 : of_images ? images : poses) << topic->name;
  }
  EXPECT_EQ(read_file(at("c.las")).substr(0, 4), "LASF");
}

/// Number of images in a model that `export` wrote.
size_t images_of(const std::string& model) {
  const std::filesystem::directory_iterator files(model + "/images");
  return static_cast<size_t>(std::distance(begin(files), end(files)));
}

TEST_F(MapCommand, MoreImagesThanTheMapHoldsAreReadFromItsRecording) {
  constexpr size_t kAsked = 15, kFrames = 20;
  const std::string folder = ran();
  const auto asks = [&](const std::string& what, const std::string& model) {
    return run("export -q " + folder + " --colmap " + at(model) + " " + what);
  };
  ASSERT_EQ(asks("", "stored"), 0) << err_;
  ASSERT_LT(images_of(at("stored")), kAsked);
  ASSERT_EQ(asks("--images 15 --points 300", "more"), 0) << err_;
  EXPECT_EQ(images_of(at("more")), kAsked);
  EXPECT_EQ(read_table(at("more/sparse/0/points3D.txt")).size(),
            read_table(at("stored/sparse/0/points3D.txt")).size() + 300);
  EXPECT_EQ(asks("--images 1", "few"), 0) << err_;
  EXPECT_EQ(images_of(at("few")), images_of(at("stored"))) << "those of the map are there in any case";
  EXPECT_EQ(asks("--images 500", "all"), 0);
  EXPECT_EQ(images_of(at("all")), kFrames);
  EXPECT_THAT(err_, HasSubstr("only 20 images have a trusted pose, not 500"));
}

TEST_F(MapCommand, ARecordingThatCannotGiveTheImagesIsNamed) {
  SavedMap saved = MapReader(ran() + "/map.kinmap").read().first;
  const auto made_of = [&](const std::string& input) {
    saved.sessions.front().input = input;
    write_map(at("moved.kinmap"), saved, 0, {});
    return "export -q " + at("moved.kinmap") + " --images 15 --colmap " + at("moved");
  };
  EXPECT_EQ(run(made_of(at("gone"))), kBadInput);
  EXPECT_THAT(err_, HasSubstr("--recording names the recording of"));
  EXPECT_EQ(run(made_of("realsense")), kWrongUse);
  EXPECT_THAT(err_, HasSubstr("dense.frame_step"));
  EXPECT_EQ(run(made_of(at("gone")) + " --recording sim:room"), 0) << err_;
  EXPECT_EQ(images_of(at("moved")), 15U);
  EXPECT_EQ(run("export -q " + ran() + " --images 15 --cloud " + at("x.ply")), kWrongUse);
  EXPECT_THAT(err_, HasSubstr("--colmap"));
}

TEST_F(MapCommand, ExportOfImagesNeedsImages) {
  SavedMap saved = MapReader(ran() + "/map.kinmap").read().first;
  write_map(at("no_images.kinmap"), saved, 0, {});
  EXPECT_EQ(run("export " + at("no_images.kinmap") + " --colmap " + at("none")), kBadInput);
  EXPECT_THAT(err_, HasSubstr("no_images.kinmap: holds no images"));
  EXPECT_EQ(run("export " + at("no_images.kinmap") + " -q --mcap " + at("none.mcap")), 0) << err_;
  EXPECT_EQ(run("export " + ran() + " --mcap " + at("m.bag")), kWrongUse);
}

TEST_F(MapCommand, AMeshHasAtMostTheTrianglesThatAreAskedFor) {
  const int code = run("mesh " + ran() + " -q --voxel 0.03 --triangles 500 -o " + at("m.stl"));
  if (code == kWrongUse) {  // without one of them
    EXPECT_THAT(err_, testing::AnyOf(HasSubstr("install libcgal-dev"), HasSubstr("install libopenvdb-dev")));
    return;
  }
  ASSERT_EQ(code, 0) << err_;
  constexpr uintmax_t kHeader = 84, kTriangle = 50;
  const auto bytes = std::filesystem::file_size(at("m.stl"));
  EXPECT_LE(bytes, kHeader + 500 * kTriangle);
  EXPECT_GT(bytes, kHeader + 400 * kTriangle);
  EXPECT_EQ((bytes - kHeader) % kTriangle, 0U);
}

TEST_F(MapCommand, AMeshHasATextureOnRequest) {
  const std::string mesh = "mesh " + ran() + " --voxel 0.03 --texture ";
  const int code = run(mesh + "512 --threads 2 -o " + at("t.obj"));
  if (code == kWrongUse) {
    EXPECT_THAT(err_, HasSubstr("install libopenvdb-dev"));
    return;
  }
  ASSERT_EQ(code, 0) << err_;
  EXPECT_THAT(out_, testing::ContainsRegex("a texture of [0-9]+ x [0-9]+ pixels in [0-9]+ pieces"));
  EXPECT_THAT(read_file(at("t.mtl")), HasSubstr("map_Kd t.jpg"));
  const cv::Size size = decode_jpeg(read_file(at("t.jpg"))).size();
  EXPECT_LE(std::max(size.width, size.height), 512);
  EXPECT_GT(std::max(size.width, size.height), 200);

  ASSERT_EQ(run(mesh + "512 --threads 2 -q -o " + at("t.glb")), 0) << err_;
  ASSERT_EQ(run(mesh + "512 -q --threads 1 -o " + at("one.glb")), 0) << err_;
  EXPECT_TRUE(read_file(at("t.glb")) == read_file(at("one.glb"))) << "the number of threads matters";
  EXPECT_THAT(read_file(at("t.glb")), HasSubstr("image/jpeg"));
}

TEST_F(MapCommand, ATextureThatCannotBeSaysWhatToDo) {
  const auto refused = [](const std::string& words) {
    EXPECT_EQ(run("mesh " + ran() + " " + words), kWrongUse) << words;
    EXPECT_EQ(std::count(err_.begin(), err_.end(), '\n'), 1) << err_;
    return err_;
  };
  for (const std::string name : {"refused.ply", "refused.stl"}) {
    EXPECT_THAT(refused("--texture 512 -o " + at(name)),
                HasSubstr("has no texture; write .glb, .obj, .usda or .usdz"));
    EXPECT_THAT(refused("--set mesh.texture_px=512 -o " + at(name)), HasSubstr("has no texture; write .glb"));
    EXPECT_FALSE(std::filesystem::exists(at(name)));
  }
  EXPECT_THAT(refused("--texture 512 -o " + at("m.off")),
              HasSubstr("must end in .ply, .obj, .glb, .usda, .usdz or"));
  EXPECT_THAT(refused("--texture 10 -o " + at("m.glb")), HasSubstr("at least 64"));
  EXPECT_THAT(refused("--texture 20000 -o " + at("m.glb")), HasSubstr("mesh.texture_px"));
  EXPECT_THAT(refused("--texture large -o " + at("m.glb")), HasSubstr("mesh.texture_px"));
}

TEST_F(MapCommand, AMapWithoutImagesReplacesNoEarlierResult) {
  SavedMap saved = MapReader(ran() + "/map.kinmap").read().first;
  write_map(at("no_images.kinmap"), saved, 0, {});
  for (const std::string words : {"export --cloud earlier.ply", "export --grid earlier.pgm",
                                  "mesh -o earlier.ply", "mesh --texture 512 -o earlier.glb"}) {
    const size_t name = words.find("earlier");
    const std::string file = at(words.substr(name));
    write_file(file, "an earlier result");
    EXPECT_EQ(run(words.substr(0, name) + file + " " + at("no_images.kinmap")), kBadInput) << words;
    EXPECT_THAT(err_, HasSubstr("no_images.kinmap: holds no images")) << words;
    EXPECT_EQ(read_file(file), "an earlier result") << words;
  }
}

TEST_F(MapCommand, InfoSaysWhatAMapHolds) {
  const std::string folder = ran();
  ASSERT_EQ(run("map info --json " + folder), 0) << err_;
  const auto info = nlohmann::json::parse(out_);
  const auto figures = nlohmann::json::parse(read_file(folder + "/run.json"));
  EXPECT_EQ(info["keyframes"], figures["keyframes"]);
  EXPECT_EQ(info["landmarks"], figures["landmarks"]);
  EXPECT_EQ(info["frames"], 20);
  EXPECT_GE(info["images"], info["keyframes"]);  // with so few frames, some non-keyframes, too
  EXPECT_EQ(info["sessions"][0]["input"], "sim:room");
  EXPECT_EQ(info["lost"], "");
  ASSERT_EQ(run("map info " + folder + "/map.kinmap"), 0);
  EXPECT_THAT(out_, HasSubstr("damage     none"));
}

TEST_F(MapCommand, ContinuesAMapAndLocalisesInIt) {
  const std::string map = ran() + "/map.kinmap";
  const std::string before = read_file(map);
  ASSERT_EQ(
      run("run sim:room" + std::string(kSmall) + "-o " + at("there") + " --localize --load-map " + ran()), 0)
      << err_;
  for (const char* absent : {"map.kinmap", "map.ply", "report.html", "graph.g2o", "camera.yaml"})
    EXPECT_FALSE(std::filesystem::exists(at("there/") + absent)) << absent;
  for (const char* present : {"trajectory.txt", "covariances.txt", "frames.txt"})
    EXPECT_TRUE(std::filesystem::exists(at("there/") + present)) << present;
  const auto figures = nlohmann::json::parse(read_file(at("there") + "/run.json"));
  EXPECT_EQ(figures["frames"], 20);
  EXPECT_GE(figures["tracked"], 18);
  ASSERT_EQ(run("run sim:room" + std::string(kSmall) + "-o " + at("on") + " --save-map " + at("on.kinmap") +
                " --load-map " + map),
            0)
      << err_;
  EXPECT_TRUE(read_file(map) == before);
  ASSERT_EQ(run("map info --json " + at("on.kinmap")), 0);
  const auto info = nlohmann::json::parse(out_);
  EXPECT_EQ(info["sessions"].size(), 2U);
  EXPECT_EQ(info["frames"], 40);
  EXPECT_EQ(info["components"], 1);
}

TEST_F(MapCommand, LocalisingGivesCloudAndReportWhenAsked) {
  const std::string localize = "run sim:room" + std::string(kSmall) + "--localize --load-map " + ran();
  ASSERT_EQ(run(localize + " -o " + at("poses")), 0) << err_;
  ASSERT_EQ(run(localize + " --report -o " + at("all")), 0) << err_;
  EXPECT_EQ(read_file(at("all/trajectory.txt")), read_file(at("poses/trajectory.txt")));
  for (const char* present : {"map.ply", "report.html", "keyframes.txt"})
    EXPECT_TRUE(std::filesystem::exists(at("all/") + present)) << present;
  EXPECT_FALSE(std::filesystem::exists(at("all/map.kinmap")));
  EXPECT_EQ(run("run sim:room --report -o " + at("x")), kWrongUse);
}

TEST_F(MapCommand, MergesMaps) {
  const std::string folder = ran();
  ASSERT_EQ(run("map merge -q " + folder + " " + folder + " -o " + at("both.kinmap")), 0) << err_;
  ASSERT_EQ(run("map info --json " + at("both.kinmap")), 0);
  const auto info = nlohmann::json::parse(out_);
  EXPECT_EQ(info["components"], 1);
  EXPECT_EQ(info["frames"], 40);
  EXPECT_GE(info["images"], info["keyframes"]);
}

/// The relative poses of the first keyframe and each later one of a visit, by the keyframes' stamps.
std::map<int64_t, SE3> relative_poses(const MapData& map, uint32_t visit) {
  std::map<int64_t, SE3> poses;
  std::optional<SE3> first;
  for (const Keyframe& keyframe : map.keyframes) {
    if (keyframe.visit != visit) continue;
    if (!first) first = keyframe.T_world_camera;
    poses[keyframe.stamp_ns] = first->inverse() * keyframe.T_world_camera;
  }
  return poses;
}

/// Bends a visit, more with each keyframe, as a false loop might.
void bend(MapData& map, uint32_t visit) {
  double steps = 0;
  for (Keyframe& keyframe : map.keyframes) {
    if (keyframe.visit != visit) continue;
    keyframe.T_world_camera =
        SE3{exp_so3({0, 0.2 * steps, 0}), {0.5 * steps, 0, 0}} * keyframe.T_world_camera;
    ++steps;
  }
}

/// The words that name all loops of a map.
std::string all_loops(const MapData& map) {
  std::string words;
  for (const LoopClosure& loop : map.loop_closures) {
    words += " --loop " + format_stamp(map.keyframes[loop.a.value].stamp_ns) + "," +
             format_stamp(map.keyframes[loop.b.value].stamp_ns);
  }
  return words;
}

TEST_F(MapCommand, WithdrawnLoopsPartTheMapsThatTheyJoined) {
  const std::string folder = ran();
  ASSERT_EQ(run("map merge -q " + folder + " " + folder + " -o " + at("joined.kinmap")), 0) << err_;
  SavedMap joined = MapReader(at("joined.kinmap")).read().first;
  ASSERT_FALSE(joined.map.loop_closures.empty());
  const uint32_t second = joined.map.keyframes.back().visit;
  bend(joined.map, second);
  write_map(at("bent.kinmap"), joined, 0, {});
  ASSERT_EQ(run("map withdraw " + at("bent.kinmap") + all_loops(joined.map) + " -o " + at("parted.kinmap")),
            0)
      << err_;
  EXPECT_THAT(out_ + err_, HasSubstr("0 left"));

  const SavedMap parted = MapReader(at("parted.kinmap")).read().first;
  EXPECT_TRUE(parted.map.loop_closures.empty());
  ASSERT_EQ(parted.map.other_loops.size(), joined.map.loop_closures.size()) << "the map remembers them";
  EXPECT_EQ(parted.map.other_loops[0].stage, LoopStage::kWithdrawn);
  EXPECT_EQ(parted.map.other_loops[0].reason, LoopReason::kByUser);
  std::set<uint32_t> components;
  for (const Keyframe& keyframe : parted.map.keyframes) components.insert(keyframe.component);
  EXPECT_EQ(components.size(), 2U);
  EXPECT_EQ(parted.frames.size(), joined.frames.size());
  const MapData alone = MapReader(folder + "/map.kinmap").read().first.map;
  const auto expected = relative_poses(alone, alone.keyframes.front().visit);
  const auto found = relative_poses(parted.map, second);
  ASSERT_EQ(found.size(), expected.size());
  for (const auto& [stamp_ns, T_first_keyframe] : found) {
    const Eigen::Vector3d moved = T_first_keyframe.translation - expected.at(stamp_ns).translation;
    EXPECT_LT(moved.norm(), 0.01) << "m, at " << format_stamp(stamp_ns);
  }
}

TEST_F(MapCommand, WithdrawingMeasuresTheMotionBetweenKeyframesAnew) {
  SavedMap saved = MapReader(ran() + "/map.kinmap").read().first;
  const uint32_t visit = saved.map.keyframes.front().visit;
  const auto expected = relative_poses(saved.map, visit);
  ASSERT_GT(expected.size(), 1U);
  bend(saved.map, visit);
  const Sensor sensor = sensor_estimate(saved.sensor, make_sensor(saved.camera)).sensor;
  withdraw_loops(saved, {}, sensor, PlaceOptions());
  const auto found = relative_poses(saved.map, visit);
  ASSERT_EQ(found.size(), expected.size());
  for (const auto& [stamp_ns, T_first_keyframe] : found) {
    const Eigen::Vector3d moved = T_first_keyframe.translation - expected.at(stamp_ns).translation;
    EXPECT_LT(moved.norm(), 0.03) << "m, at " << format_stamp(stamp_ns);
  }
}

TEST_F(MapCommand, WithdrawNamesTheNearestLoops) {
  const std::string folder = ran();
  EXPECT_EQ(run("map withdraw " + folder + " --loop 1,2 -o " + at("w.kinmap")), kBadInput);
  EXPECT_THAT(err_, HasSubstr("has no loops"));
  ASSERT_EQ(run("map merge -q " + folder + " " + folder + " -o " + at("two.kinmap")), 0) << err_;
  const std::string withdraw = "map withdraw " + at("two.kinmap") + " -o ";
  const MapData map = MapReader(at("two.kinmap")).read().first.map;
  EXPECT_EQ(run(withdraw + at("w.kinmap") + " --loop 900,1000"), kBadInput);
  EXPECT_THAT(err_, HasSubstr("no loop joins 900,1000; the nearest: "));
  EXPECT_THAT(all_loops(map), HasSubstr(err_.substr(err_.rfind(' ') + 1, 17))) << "as --loop takes it";
  EXPECT_FALSE(std::filesystem::exists(at("w.kinmap")));
  EXPECT_EQ(run(withdraw + at("w.kinmap") + " --loop 900"), kWrongUse);
  EXPECT_EQ(run(withdraw + at("w.kinmap")), kWrongUse);
  EXPECT_EQ(run(withdraw + at("two.kinmap") + all_loops(map)), kWrongUse) << "the input is kept";
}

TEST_F(MapCommand, MapsOfOnePlaceAreCompared) {
  const std::string folder = ran();
  ASSERT_EQ(run("map diff --json " + folder + " " + folder + " -o " + at("diff.ply")), 0) << err_;
  const auto difference = nlohmann::json::parse(out_);
  EXPECT_EQ(difference["objects"], nlohmann::json::array());
  EXPECT_GT(difference["before"]["same"].get<int>(), 1000);
  EXPECT_EQ(difference["before"]["gone"], 0);
  EXPECT_EQ(read_ply(at("diff.ply")).size(),
            difference["before"]["points"].get<size_t>() + difference["after"]["points"].get<size_t>());
}

TEST_F(MapCommand, MapsOfTwoPlacesAreNotCompared) {
  ASSERT_EQ(run("run -q sim:room:9" + (kSmall + ("-o " + at("elsewhere")))), 0) << err_;
  EXPECT_EQ(run("map diff -q " + ran() + " " + at("elsewhere") + " -o " + at("none.ply")), kBadInput);
  EXPECT_THAT(err_, HasSubstr("no place of"));
  EXPECT_FALSE(std::filesystem::exists(at("none.ply")));
  EXPECT_EQ(run("view " + ran() + " --compare " + at("elsewhere") + " --port 0"), kBadInput);
  EXPECT_THAT(err_, HasSubstr("no place of"));
}

TEST_F(MapCommand, LocatesASequenceAmongSeveralMaps) {
  test::write_room(at("here"), "--frames 20");
  test::write_room(at("another"), "--seed 5 --frames 20");
  for (const char* room : {"here", "another"})
    ASSERT_EQ(run("run " + at(room) + " -q -o " + at(std::string(room) + "_map")), 0) << err_;
  ASSERT_EQ(run("map locate " + at("here") + " " + at("another_map") + " " + at("here_map")), 0) << err_;
  EXPECT_THAT(err_, HasSubstr("of 20 frames located in 2 map(s)"));
  int here = 0;
  for (const TextLine& line : read_table(folder_->write("located.txt", out_))) {
    if (line.fields[1] == "unknown") continue;
    ASSERT_EQ(line.fields.size(), 9U);
    EXPECT_EQ(line.fields.back(), at("here_map/map.kinmap"));
    ++here;
  }
  EXPECT_GE(here, 18);
  ASSERT_EQ(run("map locate -q " + at("here") + " " + at("another_map")), 0) << err_;
  EXPECT_EQ(err_, "");
  EXPECT_THAT(out_, Not(HasSubstr("kinmap"))) << "in no map that is given";
  // Of maps of several cameras those of this one are used.
  ASSERT_EQ(run("run -q sim:room --set sim.width=200 --set sim.height=150 --set sim.frames=20 -o " +
                at("other_camera")),
            0)
      << err_;
  ASSERT_EQ(run("map locate " + at("here") + " " + at("other_camera") + " " + at("here_map")), 0) << err_;
  EXPECT_THAT(err_, AllOf(HasSubstr("other_camera/map.kinmap: was recorded with another camera (200x150, "),
                          HasSubstr("it is skipped"), HasSubstr("located in 1 map(s)")));
  EXPECT_EQ(run("map locate " + at("here") + " " + at("other_camera")), kBadInput);
  EXPECT_THAT(err_, HasSubstr("here: no map is of this camera"));
  EXPECT_EQ(run("map locate " + at("here")), kWrongUse);
  EXPECT_EQ(run("map locate " + at("here") + " " + at("absent.kinmap")), kBadInput);
}

/// Numbers of the images of a COLMAP model that observe points.
std::set<size_t> images_with_points(const std::filesystem::path& model) {
  std::set<size_t> images;
  for (const TextLine& point : read_table(model / "sparse/0/points3D.txt")) {
    constexpr size_t kFirstObservation = 8;  // after id, position, colour and error
    for (size_t i = kFirstObservation; i < point.fields.size(); i += 2)
      images.insert(std::stoul(point.fields[i]));
  }
  return images;
}

TEST_F(MapCommand, BothHalvesOfAMergedMapAreExported) {
  const std::string folder = ran();
  ASSERT_EQ(run("map merge -q " + folder + " " + folder + " -o " + at("halves.kinmap")), 0) << err_;
  ASSERT_EQ(run("export -q " + folder + " --colmap " + at("one")), 0) << err_;
  ASSERT_EQ(run("export -q " + at("halves.kinmap") + " --colmap " + at("two")), 0) << err_;
  const auto one = images_with_points(at("one")), two = images_with_points(at("two"));
  EXPECT_EQ(two.size(), 2 * one.size());
  const auto all = [](const std::string& model) {
    return std::distance(std::filesystem::directory_iterator(at(model + "/images")), {});
  };
  EXPECT_EQ(all("two"), 2 * all("one"));
  EXPECT_GT(*two.rbegin(), static_cast<size_t>(all("one"))) << "images of the second map, too";
}

TEST_F(MapCommand, FailureToSaveTheMapDoesNotEndTheRun) {
  // Files above 50 KiB cannot be written, as on a disk that is nearly full.
  const std::string in_memory = "--set dense.image_memory_mib=64 --set dense.surfel_memory_mib=64 ";
  EXPECT_EQ(run("run sim:room" + (kSmall + in_memory) + "-o " + at("full"), "ulimit -f 100; "), kBadInput);
  EXPECT_THAT(err_, HasSubstr("cannot save the map"));
  EXPECT_TRUE(std::filesystem::exists(at("full/trajectory.txt")));
}

TEST_F(MapCommand, TextOfAMapFileDoesNotReachTheTerminalRaw) {
  SavedMap saved = MapReader(ran() + "/map.kinmap").read().first;
  saved.program = "x\x1b[31m";
  saved.sessions.front().input = "y\x1b[31m";
  write_map(at("colored.kinmap"), saved, 0, {});
  ASSERT_EQ(run("map info " + at("colored.kinmap")), 0) << err_;
  EXPECT_EQ(out_.find('\x1b'), std::string::npos);
}

TEST_F(MapCommand, ABadOptionOfAMapFileIsBadInput) {
  write_with_options(ran() + "/map.kinmap", at("options.kinmap"), {{"dense.voxel_m", "wide"}});
  EXPECT_EQ(run("export " + at("options.kinmap") + " --cloud " + at("o.ply")), kBadInput);
  EXPECT_THAT(err_, testing::AllOf(HasSubstr("options.kinmap: "), HasSubstr("dense.voxel_m")));
}

TEST_F(MapCommand, SaysWhatIsWrong) {
  EXPECT_EQ(run("run sim:room --localize -o " + at("x")), kWrongUse);
  EXPECT_THAT(err_, HasSubstr("--load-map"));
  EXPECT_EQ(run("run sim:room -o " + at("x") + " --save-map " + at("stderr/m.kinmap")), kBadInput);
  EXPECT_EQ(run("run sim:room -o " + at("x") + " --save-map " + folder_->path().string()), kBadInput);
  EXPECT_EQ(run("map info " + at("absent.kinmap")), kBadInput);
  EXPECT_THAT(err_, HasSubstr("absent.kinmap: no such file"));
  EXPECT_EQ(run("run sim:room -o " + at("x") + " --load-map " + at("stderr")), kBadInput);
  EXPECT_THAT(err_, HasSubstr("not a kinloop map"));
  EXPECT_EQ(run("export " + ran()), kWrongUse);
  EXPECT_EQ(run("export " + ran() + " --cloud x.jpg"), kWrongUse);
  EXPECT_EQ(run("export " + ran() + " --trajectory " + ran() + "/map.kinmap"), kWrongUse);
  EXPECT_EQ(run("export " + ran() + " --trajectory " + at("t") + " --keyframes " + at("./t")), kWrongUse);
  EXPECT_THAT(err_, testing::AllOf(HasSubstr("--trajectory"), HasSubstr("--keyframes")));
  EXPECT_EQ(run("map merge " + ran() + " " + ran() + " -o " + ran() + "/map.kinmap"), kWrongUse);
  EXPECT_THAT(err_, HasSubstr("give another name"));
  EXPECT_EQ(run("run sim:room --set sim.width=320 --set sim.height=240 --set sim.frames=3 -o " + at("x") +
                " --load-map " + ran() + "/map.kinmap"),
            kBadInput);
  EXPECT_THAT(err_, HasSubstr("another camera"));
}

/// The names and contents of all files in a folder.
std::map<std::string, std::string> contents_of(const std::filesystem::path& folder) {
  std::map<std::string, std::string> contents;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) contents[relative(entry.path(), folder)] = read_file(entry.path());
  return contents;
}

TEST_F(MapCommand, RecordingForRerunLeavesTheOtherExportsAsTheyAre) {
  const std::string folder = ran(), images = " --images 12 --points 100 -q ";
  ASSERT_EQ(run("export " + folder + images + "--colmap " + at("alone")), 0) << err_;
  ASSERT_EQ(run("export " + folder + images + "--colmap " + at("both") + " --rrd " + at("a.rrd"),
                with_python("echo recording >\"$3\"")),
            0)
      << err_;
  EXPECT_EQ(read_file(at("a.rrd")), "recording\n");
  EXPECT_GT(contents_of(at("alone")).size(), 12U);
  EXPECT_TRUE(contents_of(at("alone")) == contents_of(at("both")));
}

TEST_F(MapCommand, CtrlCWhileARecordingForRerunIsWrittenLeavesNothing) {
  const std::string folder = ran();
  for (const auto& [name, exit_code] : {std::pair("INT", 130), std::pair("TERM", 143)}) {
    std::filesystem::create_directories(at("temporary"));
    std::filesystem::create_directories(at("output"));
    EXPECT_EQ(
        run("export " + folder + " -q --rrd " + at("output/a.rrd"),
            "TMPDIR='" + at("temporary") + "' " +
                with_python("ls \"$2\" >'" + at("parts") + "'; kill -" + name + " $PPID; exec sleep 600")),
        exit_code)
        << err_;
    EXPECT_EQ(err_, "");
    EXPECT_THAT(read_file(at("parts")), HasSubstr("transforms.json"));  // there was something to leave
    EXPECT_TRUE(std::filesystem::is_empty(at("temporary")));
    EXPECT_TRUE(std::filesystem::is_empty(at("output")));
  }
}

}  // namespace
}  // namespace kinloop
