// The content shown by kinloop view, from files to messages for a browser.

#include "viewer/saved/saved_run.hpp"

#include <cmath>
#include <cstring>
#include <limits>

#include <gmock/gmock.h>

#include "dense/files/mesh_file.hpp"
#include "dense/files/ply.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "kinloop/core/time.hpp"
#include "kinloop/sensor/images/jpeg_codec.hpp"
#include "tests/io/sample_map.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/temp_folder.hpp"
#include "tests/viewer/scene_parts.hpp"
#include "viewer/saved/keyframe_images.hpp"
#include "viewer/saved/sent_shapes.hpp"

namespace kinloop {
namespace {

using nlohmann::json;
using testing::HasSubstr;

const ColoredMesh& triangle() {
  static const ColoredMesh kMesh{
      {{0, 0, 1}, {1, 0, 1}, {1, 1, 1}}, {{255, 0, 1}, {0, 255, 2}, {3, 0, 255}}, {{0, 1, 2}}};
  return kMesh;
}

class SavedRunTest : public testing::Test {
 protected:
  std::optional<ScenePart> part(const SavedRun& run, PartKind kind) {
    Scene scene("x");
    show_saved_run(scene, run);
    return test::part(scene, kind);
  }
  json hello(const SavedRun& run) { return test::json_of(*part(run, PartKind::kHello)); }
  std::string error(const std::string& name, const std::string& bytes) {
    const auto path = folder_.write(name, bytes);
    return test::input_error([&] { read_saved_run(path); });
  }

  const test::TempFolder folder_;
};

TEST_F(SavedRunTest, MarksThePathWhereFramesAreInDoubt) {
  folder_.write(
      "trajectory.txt",
      "# 1 doubtful pose left out\n1 0 0 0 0 0 0 1\n2 1 0 0 0 0 0 1\n4 2 0 0 0 0 0 1\n5 3 0 0 0 0 0 1\n");
  folder_.write("frames.txt",
                "# stamp_s status features tracked ms sigma_m\n1 tracked 9 9 1 0.001\n2 tracked 9 9 1 0.001\n"
                "3 doubtful 9 9 1 0.1\n4 tracked 9 9 1 0.001\n5 tracked 9 9 1 0.001\n6 lost 9 0 1 0\n");
  const auto marked = part(read_saved_run(folder_.path()), PartKind::kDoubt);
  ASSERT_TRUE(marked);
  EXPECT_EQ(*marked->body, encode_ranges(std::vector<FrameRange>{{2, 3}})) << "the way over the gap";
  folder_.write("frames.txt", "1 tracked 9 9 1\n2 tracked 9 9 1\n");
  EXPECT_FALSE(part(read_saved_run(folder_.path()), PartKind::kDoubt));
}

TEST_F(SavedRunTest, HasATimelineOfAllItsFrames) {
  folder_.write("trajectory.txt", "1 0 0 0 0 0 0 1\n2 1 0 0 0 0 0 1\n");
  folder_.write("keyframes.txt", "2 1 0 0 0 0 0 1\n");
  folder_.write("frames.txt", "1 tracked 9 7 5 0.25\n2 doubtful 9 6 5 0.5\n3 lost 9 0 5 0\n");
  const auto frames = timeline_of(read_saved_run(folder_.path()));
  ASSERT_EQ(frames.size(), 3U);
  EXPECT_EQ(frames[0].stamp_s, 1);
  EXPECT_EQ(frames[0].tracked, 7);
  EXPECT_EQ(frames[0].sigma_m, 0.25F);
  EXPECT_EQ(frames[0].ms, 5);
  EXPECT_FALSE(frames[0].keyframe.valid());
  EXPECT_EQ(frames[1].status, FrameStatus::kDoubtful);
  EXPECT_EQ(frames[1].keyframe, KeyframeId{0});
  EXPECT_EQ(frames[1].T_world_camera->translation.x(), 1);
  EXPECT_EQ(frames[2].status, FrameStatus::kLost);
  EXPECT_FALSE(frames[2].T_world_camera);

  const WireBytes bytes = encode_timeline(frames);
  ASSERT_EQ(bytes.size(), 3U * 64);
  float last = 0;
  std::memcpy(&last, bytes.data() + bytes.size() - sizeof last, sizeof last);
  EXPECT_TRUE(std::isnan(last)) << "a lost frame has no pose";
}

TEST_F(SavedRunTest, HasATimelineOfItsPathWithoutAFrameTable) {
  SavedRun run;
  EXPECT_TRUE(timeline_of(run).empty());
  EXPECT_FALSE(part(run, PartKind::kTimeline));
  run.path = {{kNsPerSecond, {}}, {2 * kNsPerSecond, {}}};
  run.doubt_ns = {2 * kNsPerSecond};
  const auto frames = timeline_of(run);
  ASSERT_EQ(frames.size(), 2U);
  EXPECT_EQ(frames[0].status, FrameStatus::kTracked);
  EXPECT_EQ(frames[1].status, FrameStatus::kDoubtful);
  EXPECT_TRUE(part(run, PartKind::kTimeline));
}

TEST_F(SavedRunTest, ItsTimelineHasTheErrorsOfFramesThatHaveTheTruth) {
  SavedRun run;
  run.path = {{1, {}}, {2, {}}, {3, {}}};
  const std::vector<PoseError> errors = {{1, 0.5}, {3, 0.25}};
  const auto frames = timeline_of(run, errors);
  ASSERT_EQ(frames.size(), 3U);
  EXPECT_EQ(frames[0].error_m, 0.5F);
  EXPECT_EQ(frames[1].error_m, 0) << "unknown";
  EXPECT_EQ(frames[2].error_m, 0.25F);
}

TEST_F(SavedRunTest, HasTheErrorsOfItsKeyframesWhereThereIsTruth) {
  folder_.write("trajectory.txt",
                "1 0 0 0 0 0 0 1\n2 1 0 0 0 0 0 1\n3 2 1 0 0 0 0 1\n4 3 0 0 0 0 0 1\n5 4 0 1 0 0 0 1\n");
  folder_.write("keyframes.txt", "1 0 0 0 0 0 0 1\n3 2 1.5 0 0 0 0 1\n5 4 0 1 0 0 0 1\n");
  EXPECT_FALSE(part(read_saved_run(folder_.path()), PartKind::kTruthErrors)) << "without truth";
  // The true path, turned by 90 degrees about z: (x, y) is at (-y, x). There is none at the last keyframe.
  folder_.write("groundtruth.txt", "1 0 0 0 0 0 0 1\n2 0 1 0 0 0 0 1\n3 -1 2 0 0 0 0 1\n4 0 3 0 0 0 0 1\n");
  const auto errors = part(read_saved_run(folder_.path()), PartKind::kTruthErrors);
  ASSERT_TRUE(errors);
  std::vector<float> numbers(errors->body->size() / sizeof(float));
  std::memcpy(numbers.data(), errors->body->data(), errors->body->size());
  const std::vector<float> expected = {0, 0, 0, 0, 0, 0, 2, 1.5, 0, 2, 1, 0};
  EXPECT_THAT(numbers, testing::Pointwise(testing::FloatNear(1e-4F), expected)) << "aligned to the truth";
}

TEST_F(SavedRunTest, HasTheErrorsOfSomeFramesWithoutKeyframes) {
  SavedRun run;
  for (int i = 0; i < 1001; ++i) {
    const double x = 0.01 * i;
    run.path.push_back({i * kNsPerSecond, {Eigen::Quaterniond::Identity(), {x, x * x, 0}}});
  }
  run.truth = run.path;
  EXPECT_EQ(part(run, PartKind::kTruthErrors)->body->size(), 334 * 6 * sizeof(float)) << "every third";
}

TEST_F(SavedRunTest, ShowsTheMeshInTheFolderInTheWorldFrame) {
  folder_.write("trajectory.txt", "1 0 0 0 0 0 0 1\n");
  write_mesh(folder_.path() / "mesh.ply", triangle(), z_up_frame({0, -1, 0}, SE3()));
  const SavedRun run = read_saved_run(folder_.path());
  ASSERT_EQ(run.mesh.points.size(), 3U);
  for (size_t i = 0; i < 3; ++i)
    EXPECT_NEAR((run.mesh.points[i] - triangle().points[i]).norm(), 0, 1e-6) << i;
}

TEST_F(SavedRunTest, StatesTheFieldOfViewOfItsCamera) {
  folder_.write("trajectory.txt", "1 0 0 0 0 0 0 1\n");
  folder_.write("camera.yaml",
                "width: 640\nheight: 480\nfx: 400\nfy: 300\ncx: 320\ncy: 240\ndistortion: [0, 0, 0, 0, "
                "0]\ndepth_scale: 5000\nfps: 30\n");
  EXPECT_EQ(hello(read_saved_run(folder_.path()))["frustum"], (json{0.8, 0.8}));
}

TEST(KeyframeImages, AreThoseOfTheShownKeyframes) {
  const test::TempFolder folder;
  const auto path = folder.path() / "map.kinmap";
  const auto damaged = [](size_t index) {
    SavedImages images = test::some_images(index);
    if (index == 1) images.images.color.resize(10);
    return images;
  };
  write_map(path, test::some_saved_map(), test::kImages, damaged);
  // Keyframe k of the map has the stamp 100 k, and the images are those of the first five.
  const Trajectory shown = {{0, {}}, {100, {}}, {300, {}}, {1100, {}}};
  const auto images = read_keyframe_images(path, shown);
  ASSERT_EQ(images.size(), 2U) << "one is damaged, and one has none";
  EXPECT_EQ(images[0].keyframe, 0U);
  EXPECT_EQ(images[1].keyframe, 2U);
  const auto& jpeg = images[1].jpeg;
  EXPECT_EQ(jpeg_size({reinterpret_cast<const char*>(jpeg.data()), jpeg.size()}), cv::Size(160, 120));
  folder.write("noise.kinmap", "noise");
  EXPECT_THROW(read_keyframe_images(folder.path() / "noise.kinmap", shown), InputError);
}

TEST_F(SavedRunTest, OfACloudAloneIsItsPointsWithoutTimes) {
  write_ply(folder_.path() / "map.PLY", {triangle().points, triangle().colors});
  const SavedRun run = read_saved_run(folder_.path() / "map.PLY");
  EXPECT_EQ(run.cloud.size(), 3U);
  EXPECT_EQ(run.name, "map.PLY");
  EXPECT_EQ(hello(run)["colors"], (json{"camera", "height"}));
  EXPECT_TRUE(part(run, PartKind::kCloud));
  EXPECT_FALSE(part(run, PartKind::kMesh));
}

TEST_F(SavedRunTest, OfACloudWithoutColoursIsColouredByHeight) {
  const auto path = folder_.write(
      "c.pcd",
      "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 2\nHEIGHT 1\nDATA ascii\n1 2 3\n4 5 6\n");
  const SavedRun run = read_saved_run(path);
  EXPECT_EQ(run.cloud.size(), 2U);
  EXPECT_EQ(hello(run)["colors"], (json{"height"}));
  EXPECT_EQ(run.up, Eigen::Vector3d::UnitZ()) << "as in most programs";
}

TEST_F(SavedRunTest, OfAPlyWithFacesIsAMesh) {
  write_mesh(folder_.path() / "m.ply", triangle());
  const SavedRun run = read_saved_run(folder_.path() / "m.ply");
  const auto mesh = part(run, PartKind::kMesh);
  ASSERT_TRUE(mesh);
  EXPECT_EQ(mesh->body->size(), 12U + 3 * 12 + 12 + 3 * 4);
  EXPECT_EQ(hello(run)["colors"], (json{"camera"}));
}

TEST_F(SavedRunTest, OfAGlbFileIsItsBytes) {
  write_mesh(folder_.path() / "m.glb", triangle());
  const SavedRun run = read_saved_run(folder_.path() / "m.glb");
  const std::string bytes = read_file(folder_.path() / "m.glb");
  EXPECT_EQ(*part(run, PartKind::kModel)->body, WireBytes(bytes.begin(), bytes.end()));
}

TEST_F(SavedRunTest, ADamagedGlbIsReportedBeforeServing) {
  write_mesh(folder_.path() / "m.glb", triangle());
  const std::string good = read_file(folder_.path() / "m.glb");
  const auto edited = [&](const std::string& from, const std::string& to) {
    std::string bytes = good;
    EXPECT_EQ(from.size(), to.size());
    return bytes.replace(bytes.find(from), from.size(), to);
  };
  EXPECT_THAT(error("a.glb", "<html>"), HasSubstr("a.glb: not a GLB file"));
  EXPECT_THAT(error("a.glb", "glTF"), HasSubstr("not a GLB file"));
  EXPECT_THAT(error("a.glb", good.substr(0, good.size() - 4)), HasSubstr("truncated"));
  EXPECT_THAT(error("a.glb", edited("\"asset\"", "\"asset,")), HasSubstr("JSON part is damaged"));
  EXPECT_THAT(error("a.glb", edited("\"POSITION\"", "\"POSITIVE\"")), HasSubstr("no positions"));
  EXPECT_THAT(error("a.glb", edited("\"meshes\"", "\"mashes\"")), HasSubstr("holds no mesh"));
  EXPECT_THAT(error("a.glb", edited("\"count\":3", "\"count\":9")), HasSubstr("out of range"));
  EXPECT_THAT(error("a.glb", edited("\"bufferView\":0", "\"bufferView\":7")), HasSubstr("is not glTF"));
  std::string index = good;
  constexpr size_t kNormalBytes = 3 * 3 * sizeof(float);     // stored after the triangles
  index[good.size() - kNormalBytes - sizeof(uint32_t)] = 3;  // the last corner of the triangle
  EXPECT_THAT(error("a.glb", index), HasSubstr("refers to vertex 3 of 3"));
}

TEST_F(SavedRunTest, SaysWhatCannotBeShown) {
  EXPECT_THAT(error("a.obj", "v 1 2 3"), HasSubstr(".kinmap, .ply, .pcd or .glb"));
  EXPECT_THAT(test::input_error([&] { read_saved_run(folder_.path() / "none.ply"); }),
              HasSubstr("no such file"));
  EXPECT_THAT(test::input_error([&] { read_saved_run(folder_.path() / "none"); }),
              HasSubstr("no such file or folder"));
  EXPECT_THAT(error("a.ply",
                    "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\n"
                    "property float z\nend_header\n"),
              HasSubstr("holds no points"));
}

TEST(SavedRunBatches, TheFirstPictureNeedsLittleOfALargeCloudAndBatchesGiveAllOfIt) {
  constexpr size_t kPoints = 1'300'000;
  SavedRun run;
  for (size_t i = 0; i < kPoints; ++i)
    run.cloud.points.emplace_back(1e-4F * static_cast<float>(i % 1000), 1e-4F * static_cast<float>(i / 1000),
                                  0);
  run.cloud.colors.resize(kPoints);
  run.mesh = triangle();
  const std::vector<CloudPiece> pieces = split_into_pieces(run.cloud);
  Scene first("x"), all("x");
  show_first(first, run, pieces);
  EXPECT_LT(first.bytes(), 300'000U);
  EXPECT_TRUE(test::part(first, PartKind::kCloud));
  EXPECT_EQ(test::json_of(*test::part(first, PartKind::kStatus))["points"], kPoints);
  EXPECT_FALSE(test::part(first, PartKind::kMesh));
  show_saved_run(all, run);
  size_t bytes = 0;
  for (size_t i = 0; i < batch_count(pieces); ++i) {
    for (EncodedPart& part : encode_batch(run, pieces, i)) {
      bytes += part.body.size();
      first.put(part.kind, part.index, std::move(part.body));
    }
  }
  EXPECT_GT(batch_count(pieces), 2U);
  EXPECT_GT(bytes, 9 * kPoints) << "nine bytes and more for a point";
  EXPECT_EQ(first.bytes(), all.bytes());
}

TEST(SavedCloud, PointsThatAreNowhereAreLeftOut) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  ColoredCloud cloud;
  for (int i = 0; i < 100; ++i) cloud.points.emplace_back(0.01F * static_cast<float>(i), 0.5F, 0.1F);
  for (int i = 0; i < 100; ++i) cloud.points.emplace_back(i % 2 == 0 ? kNan : kInfinity, -kInfinity, 3e38F);
  cloud.colors.resize(cloud.points.size());
  const auto pieces = split_into_pieces(cloud);
  ASSERT_EQ(pieces.size(), 1U);
  EXPECT_EQ(pieces[0].cloud.size(), 100U);
  cloud.points.assign(3, Eigen::Vector3f::Constant(kNan));
  cloud.colors.resize(3);
  EXPECT_TRUE(split_into_pieces(cloud).empty());
}

TEST(SavedCloud, FarPointsDoNotCoarsenTheOthers) {
  ColoredCloud cloud;
  for (int i = 0; i < 1000; ++i) cloud.points.emplace_back(0.001F * static_cast<float>(i), 0.5F, 0.1F);
  cloud.points.emplace_back(1e6F, 0, 0);
  cloud.colors.resize(cloud.points.size());
  const auto pieces = split_into_pieces(cloud);
  ASSERT_EQ(pieces.size(), 2U);
  EXPECT_EQ(pieces[0].cloud.size(), 1000U);
  float unit_m = 0;
  std::memcpy(&unit_m, encode_cloud(pieces[0]).data() + 8, sizeof unit_m);
  EXPECT_FLOAT_EQ(unit_m, 1e-4F);
}

}  // namespace
}  // namespace kinloop
