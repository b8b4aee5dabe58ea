#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drivers/bags/message_file.hpp"
#include "drivers/datasets/tum_source.hpp"
#include "drivers/ros/bag_source.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "kinloop/sensor/camera/registration.hpp"
#include "tests/drivers/bag_writers.hpp"
#include "tests/drivers/mutation.hpp"
#include "tests/drivers/sequence_folder.hpp"
#include "tests/support/expect_error.hpp"

namespace kinloop {
namespace {

using test::input_error;
using test::Serialization;
using testing::AllOf;
using testing::HasSubstr;

constexpr const char* kImageType = "sensor_msgs/msg/Image";
constexpr const char* kColorTopic = "/camera/color/image_raw";
constexpr const char* kColorInfoTopic = "/camera/color/camera_info";
constexpr const char* kAlignedTopic = "/camera/aligned_depth_to_color/image_raw";
constexpr const char* kDepthTopic = "/camera/depth/image_rect_raw";
constexpr const char* kDepthInfoTopic = "/camera/depth/camera_info";

PinholeCamera small_camera() {
  PinholeCamera camera;
  camera.width = test::kWidth, camera.height = test::kHeight;
  camera.fx = camera.fy = 25, camera.cx = 15.5, camera.cy = 11.5;
  return camera;
}

cv::Mat millimetres(const Frame& frame) {
  cv::Mat result;
  frame.depth_m.convertTo(result, CV_16UC1, 1000);
  return result;
}

/// A bag with the frames of a folder, as raw messages.
test::WrittenBag bag_of(const std::filesystem::path& folder, Serialization kind = Serialization::kCdrLittle) {
  test::WrittenBag bag;
  bag.push_back({kColorInfoTopic, "sensor_msgs/msg/CameraInfo", 1, test::info_message(kind, small_camera())});
  TumSource source(folder);
  while (const auto frame = source.next()) {
    const int64_t stamp = frame->stamp_ns;
    bag.push_back(
        {kColorTopic, kImageType, stamp, test::image_message(kind, stamp, frame->color.bgr(), "bgr8")});
    bag.push_back(
        {kAlignedTopic, kImageType, stamp, test::image_message(kind, stamp, millimetres(*frame), "16UC1")});
  }
  return bag;
}

size_t count_frames(FrameSource& source) {
  size_t frames = 0;
  while (source.next()) ++frames;
  return frames;
}

std::string reasons_of(const FrameSource& source) {
  std::string reasons;
  for (const auto& skipped : source.skipped()) reasons += skipped.reason + "\n";
  return reasons;
}

class Ros2BagTest : public testing::Test {
 protected:
  void expect_frames_of_folder(const std::filesystem::path& bag) const {
    TumSource expected(sequence.path());
    const auto source = open_bag(bag, {});
    EXPECT_EQ(source->info().frames, 8U);
    EXPECT_EQ(source->camera().color, small_camera());
    while (const auto frame = expected.next()) {
      const auto from_bag = source->next();
      ASSERT_TRUE(from_bag) << reasons_of(*source);
      EXPECT_EQ(from_bag->stamp_ns, frame->stamp_ns);
      EXPECT_EQ(cv::norm(from_bag->color.bgr(), frame->color.bgr(), cv::NORM_INF), 0);
      EXPECT_EQ(cv::norm(from_bag->depth_m, frame->depth_m, cv::NORM_INF), 0);
    }
    EXPECT_FALSE(source->next());
  }

  const test::SequenceFolder sequence{8};
  const test::TempFolder folder;
};

TEST_F(Ros2BagTest, EveryMcapLayoutGivesTheFramesOfTheFolder) {
  const auto bag = bag_of(sequence.path());
  for (const std::string compression : {"", "lz4", "zstd"}) {
    for (const bool summary : {true, false}) {
      SCOPED_TRACE(compression + (summary ? " with summary" : " without summary"));
      test::McapLayout layout;
      layout.compression = compression, layout.summary = summary;
      expect_frames_of_folder(folder.write("a.mcap", mcap_bytes(bag, layout)));
    }
  }
  test::McapLayout plain;
  plain.chunks = false;
  expect_frames_of_folder(folder.write("a.mcap", mcap_bytes(bag, plain)));
}

TEST_F(Ros2BagTest, EitherByteOrderAndRos1MessagesGiveTheFramesOfTheFolder) {
  expect_frames_of_folder(
      folder.write("a.mcap", mcap_bytes(bag_of(sequence.path(), Serialization::kCdrBig), {})));
  test::McapLayout ros1;
  ros1.encoding = "ros1";
  expect_frames_of_folder(
      folder.write("a.mcap", mcap_bytes(bag_of(sequence.path(), Serialization::kRos1), ros1)));
}

TEST_F(Ros2BagTest, SqliteGivesTheFramesOfTheFolder) {
  for (const bool zstd_messages : {false, true}) {
    write_db3(folder.path() / "a.db3", bag_of(sequence.path()), zstd_messages);
    expect_frames_of_folder(folder.path() / "a.db3");
  }
}

TEST_F(Ros2BagTest, AFolderIsReadFileAfterFile) {
  auto bag = bag_of(sequence.path());
  const test::WrittenBag rest(bag.begin() + 7, bag.end());
  bag.resize(7);
  write_db3(folder.path() / "bag_0.db3", bag);
  write_db3(folder.path() / "bag_1.db3", rest);
  expect_frames_of_folder(folder.path());  // the recorder was killed: no metadata.yaml
  const std::string metadata =
      "rosbag2_bagfile_information:\n  relative_file_paths:\n    - {}\n    - bag_1.db3\n";
  folder.write("metadata.yaml", fmt::format(fmt::runtime(metadata), "bag_0.db3"));
  expect_frames_of_folder(folder.path());
  for (const char* wrong : {"../bag_0.db3", "/tmp/bag_0.db3", "bag_0.db3.zstd", "bag_0.bin"}) {
    folder.write("metadata.yaml", fmt::format(fmt::runtime(metadata), wrong));
    EXPECT_THAT(input_error([&] { open_bag(folder.path(), {}); }), HasSubstr("bag_0"));
  }
  folder.write("metadata.yaml", "rosbag2_bagfile_information: [1");
  EXPECT_THAT(input_error([&] { open_bag(folder.path(), {}); }), HasSubstr("metadata.yaml"));
}

TEST_F(Ros2BagTest, DepthOfAnotherPoseIsRegisteredByTheStaticTransforms) {
  constexpr auto kKind = Serialization::kCdrLittle;
  RgbdCamera camera;
  camera.color = camera.depth.emplace(small_camera());
  camera.depth->fx = camera.depth->fy = 22;
  camera.T_color_depth = {exp_so3({0, 0.01, 0}), {0.05, 0, 0.002}};
  const SE3 T_base_color{exp_so3({0.3, 0.2, 0.1}), {1, 2, 3}};
  const test::WrittenBag bag = {
      {"/tf_static", "tf2_msgs/msg/TFMessage", 1,
       test::transform_message(kKind, "base", "color", T_base_color)},
      {"/tf_static", "tf2_msgs/msg/TFMessage", 1,
       test::transform_message(kKind, "base", "depth", T_base_color * camera.T_color_depth)},
      {kColorInfoTopic, "sensor_msgs/msg/CameraInfo", 1, test::info_message(kKind, camera.color)},
      {kDepthInfoTopic, "sensor_msgs/msg/CameraInfo", 1, test::info_message(kKind, *camera.depth)},
      {kColorTopic, kImageType, 2, test::image_message(kKind, 2, test::make_color(1), "bgr8", "color")},
      {kDepthTopic, kImageType, 2, test::image_message(kKind, 2, test::make_depth(1500), "16UC1", "depth")}};
  const auto source = open_bag(folder.write("a.mcap", mcap_bytes(bag, {})), {});
  ASSERT_TRUE(source->camera().depth);
  EXPECT_LT((source->camera().T_color_depth.inverse() * camera.T_color_depth).log().norm(), 1e-12);
  const auto frame = source->next();
  ASSERT_TRUE(frame);
  const cv::Mat expected =
      DepthRegistration(source->camera())(cv::Mat(test::make_depth(1500).size(), CV_32FC1, cv::Scalar(1.5)));
  EXPECT_LT(cv::norm(frame->depth_m, expected, cv::NORM_INF), 1e-6);
  EXPECT_GT(cv::countNonZero(frame->depth_m), 300);
  const test::WrittenBag without(bag.begin() + 1, bag.end());
  EXPECT_THAT(input_error([&] { open_bag(folder.write("b.mcap", mcap_bytes(without, {})), {}); }),
              AllOf(HasSubstr("b.mcap"), HasSubstr("--camera"), HasSubstr("'depth'")));
  EXPECT_TRUE(open_bag(folder.path() / "b.mcap", camera)->next());
}

/// A frame whose images have a coordinate frame each, which a transform connects.
test::WrittenBag bag_of_two_frames(const std::string& depth_topic, const PinholeCamera& depth_camera) {
  constexpr auto kKind = Serialization::kCdrLittle;
  const std::string depth_info = depth_topic.substr(0, depth_topic.rfind('/')) + "/camera_info";
  return {
      {"/tf_static", "tf2_msgs/msg/TFMessage", 1,
       test::transform_message(kKind, "color", "depth", {{}, {0.05, 0, 0.002}})},
      {kColorInfoTopic, "sensor_msgs/msg/CameraInfo", 1, test::info_message(kKind, small_camera())},
      {depth_info, "sensor_msgs/msg/CameraInfo", 1, test::info_message(kKind, depth_camera)},
      {kColorTopic, kImageType, 2, test::image_message(kKind, 2, test::make_color(1), "bgr8", "color")},
      {depth_topic, kImageType, 2, test::image_message(kKind, 2, test::make_depth(1500), "16UC1", "depth")}};
}

TEST_F(Ros2BagTest, DepthThatIsAlignedByItsTopicIsNotRegisteredAgain) {
  PinholeCamera other = small_camera();
  other.fx = other.fy = 22;
  const auto bag = bag_of_two_frames(kAlignedTopic, other);
  testing::internal::CaptureStdout();
  const auto source = open_bag(folder.write("a.mcap", mcap_bytes(bag, {})), {});
  EXPECT_THAT(testing::internal::GetCapturedStdout(),
              AllOf(HasSubstr("taken as registered"), HasSubstr(kAlignedTopic), HasSubstr("'depth'")));
  EXPECT_FALSE(source->camera().depth);
  EXPECT_FLOAT_EQ(source->next()->depth_m.at<float>(0, 0), 1.5F);
}

TEST_F(Ros2BagTest, DepthWithTheIntrinsicsOfColourIsNotRegisteredAgain) {
  const auto bag = bag_of_two_frames(kDepthTopic, small_camera());
  testing::internal::CaptureStdout();
  const auto source = open_bag(folder.write("a.mcap", mcap_bytes(bag, {})), {});
  EXPECT_THAT(testing::internal::GetCapturedStdout(), HasSubstr("both have the same intrinsics"));
  EXPECT_FALSE(source->camera().depth);
  EXPECT_FLOAT_EQ(source->next()->depth_m.at<float>(0, 0), 1.5F);
}

TEST_F(Ros2BagTest, DepthOfAnUnknownCameraAsksForIt) {
  PinholeCamera other = small_camera();
  other.fx = other.fy = 22;
  auto bag = bag_of_two_frames(kDepthTopic, other);
  bag.erase(bag.begin() + 2);
  write_db3(folder.path() / "a.db3", bag);
  const auto mcap = folder.write("a.mcap", mcap_bytes(bag, {}));
  for (const auto& path : {folder.path() / "a.db3", mcap}) {
    EXPECT_THAT(input_error([&] { open_bag(path, {}); }),
                AllOf(HasSubstr(path.string()), HasSubstr(kDepthInfoTopic), HasSubstr("--camera")));
    RgbdCamera camera;
    camera.color = small_camera();
    EXPECT_TRUE(open_bag(path, camera)->next());
  }
}

TEST_F(Ros2BagTest, TheUnitOfDepthIsThatOfTheGivenCamera) {
  const auto path = folder.write("a.mcap", mcap_bytes(bag_of(sequence.path()), {}));
  const float depth_m = open_bag(path, {})->next()->depth_m.at<float>(0, 0);
  ASSERT_GT(depth_m, 0);
  EXPECT_EQ(open_bag(path, {})->camera().depth_scale, 1000);
  RgbdCamera camera;
  camera.color = small_camera();
  camera.depth_scale = 2000;
  testing::internal::CaptureStdout();
  EXPECT_FLOAT_EQ(open_bag(path, camera)->next()->depth_m.at<float>(0, 0), depth_m / 2);
  EXPECT_THAT(testing::internal::GetCapturedStdout(), AllOf(HasSubstr("2000 units"), HasSubstr("1000")));
  BagRequest request;
  request.path = path;
  request.depth_scale = 500;  // without a camera
  EXPECT_FLOAT_EQ(open_bag(request)->next()->depth_m.at<float>(0, 0), depth_m * 2);
  request.camera = camera;
  EXPECT_FLOAT_EQ(open_bag(request)->next()->depth_m.at<float>(0, 0), depth_m * 2);
  request.depth_scale.reset();
  request.camera_has_depth_scale = false;  // a camera file of another program
  EXPECT_FLOAT_EQ(open_bag(request)->next()->depth_m.at<float>(0, 0), depth_m);
}

TEST_F(Ros2BagTest, ABagCompressedAsAWholeIsToldToBeDecompressed) {
  for (const char* name : {"a.db3.zstd", "a.mcap.zst"}) {
    const auto path = folder.write(name, "zstd");
    EXPECT_TRUE(is_bag(path));
    EXPECT_THAT(input_error([&] { open_bag(path, {}); }), AllOf(HasSubstr(name), HasSubstr("zstd -d")));
  }
  EXPECT_FALSE(is_bag(folder.write("a.txt.zst", "zstd")));
}

TEST_F(Ros2BagTest, DepthInMetresHasNoOtherUnit) {
  auto bag = bag_of_two_frames(kAlignedTopic, small_camera());
  bag.back().data = test::image_message(
      Serialization::kCdrLittle, 2, cv::Mat(test::make_depth(1).size(), CV_32FC1, cv::Scalar(1.5)), "32FC1");
  const auto path = folder.write("a.mcap", mcap_bytes(bag, {}));
  RgbdCamera camera;
  camera.color = small_camera();
  camera.depth_scale = 2000;
  EXPECT_FLOAT_EQ(open_bag(path, camera)->next()->depth_m.at<float>(0, 0), 1.5F);
}

TEST_F(Ros2BagTest, ARationalLensIsThatOfTheCamera) {
  constexpr auto kKind = Serialization::kCdrLittle;
  PinholeCamera camera = small_camera();
  camera.lens = {LensModel::kRational, 0.5, -2.5, 0.001, -0.001, 1.4, 0.4, -2.3, 1.3};
  const test::WrittenBag bag = {
      {kColorInfoTopic, "sensor_msgs/msg/CameraInfo", 1,
       test::info_message(kKind, camera, "rational_polynomial")},
      {kColorTopic, kImageType, 2, test::image_message(kKind, 2, test::make_color(1), "bgr8")},
      {kAlignedTopic, kImageType, 2, test::image_message(kKind, 2, test::make_depth(1500), "16UC1")}};
  const auto source = open_bag(folder.write("a.mcap", mcap_bytes(bag, {})), {});
  EXPECT_EQ(source->camera().color, camera);
  const auto frame = source->next();
  ASSERT_TRUE(frame);
  EXPECT_EQ(cv::norm(frame->color.bgr(), test::make_color(1), cv::NORM_INF), 0);
}

TEST_F(Ros2BagTest, CompressedTopicsAreRead) {
  constexpr auto kKind = Serialization::kCdrLittle;
  const std::string header(12, '\0');
  const cv::Mat color = test::make_color(1);
  const test::WrittenBag bag = {
      {kColorInfoTopic, "sensor_msgs/msg/CameraInfo", 1, test::info_message(kKind, small_camera())},
      {kColorTopic + std::string("/compressed"), "sensor_msgs/msg/CompressedImage", 2,
       test::compressed_message(kKind, 2, "bgr8; png compressed bgr8", test::encoded(color, ".png"))},
      {kAlignedTopic + std::string("/compressedDepth"), "sensor_msgs/msg/CompressedImage", 2,
       test::compressed_message(kKind, 2, "16UC1; compressedDepth",
                                header + test::encoded(test::make_depth(1234), ".png"))}};
  write_db3(folder.path() / "a.db3", bag);
  const auto frame = open_bag(folder.path() / "a.db3", {})->next();
  ASSERT_TRUE(frame);
  EXPECT_EQ(cv::norm(frame->color.bgr(), color, cv::NORM_INF), 0);
  EXPECT_FLOAT_EQ(frame->depth_m.at<float>(0, 0), 1.234F);
}

TEST_F(Ros2BagTest, ATruncatedMcapGivesItsFirstFrames) {
  const auto bag = bag_of(sequence.path());
  for (const std::string compression : {"", "zstd"}) {
    test::McapLayout layout;
    layout.compression = compression;
    const std::string whole = mcap_bytes(bag, layout);
    size_t before = 0;
    for (size_t size = 0; size < whole.size(); size += 97) {
      const auto path = folder.write("cut.mcap", whole.substr(0, size));
      size_t frames = 0;
      try {
        const auto source = open_bag(path, {});
        frames = count_frames(*source);
        EXPECT_TRUE(frames == 8 || reasons_of(*source).find("truncated") != std::string::npos);
      } catch (const InputError& error) {
        EXPECT_THAT(error.what(), HasSubstr("cut.mcap"));
      }
      EXPECT_GE(frames, before);
      before = frames;
    }
    EXPECT_EQ(before, 8U);
  }
}

TEST_F(Ros2BagTest, ATruncatedDatabaseGivesFramesOrAnError) {
  write_db3(folder.path() / "whole.db3", bag_of(sequence.path()));
  const auto size = std::filesystem::file_size(folder.path() / "whole.db3");
  for (size_t cut = 0; cut < size; cut += 1024) {
    std::filesystem::copy_file(folder.path() / "whole.db3", folder.path() / "cut.db3",
                               std::filesystem::copy_options::overwrite_existing);
    std::filesystem::resize_file(folder.path() / "cut.db3", cut);
    try {
      EXPECT_LE(count_frames(*open_bag(folder.path() / "cut.db3", {})), 8U);
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr("cut.db3"));
    }
  }
}

constexpr size_t kPageBytes = 4096;

std::string big_endian(uint64_t value, int bytes) {
  std::string text;
  for (int i = bytes - 1; i >= 0; --i) text += static_cast<char>(value >> (8 * i));
  return text;
}

/// An interior page of a table whose children are all the same page.
std::string page_of_one_child(uint32_t child) {
  constexpr size_t kCells = 100, kCellBytes = 5;
  std::string page = '\x05' + big_endian(0, 2) + big_endian(kCells, 2) +
                     big_endian(kPageBytes - kCells * kCellBytes, 2) + '\0' + big_endian(child, 4);
  for (size_t i = 0; i < kCells; ++i) page += big_endian(kPageBytes - (kCells - i) * kCellBytes, 2);
  page.resize(kPageBytes - kCells * kCellBytes);
  for (size_t i = 0; i < kCells; ++i) page += big_endian(child, 4) + static_cast<char>(i + 1);
  return page;
}

/// The root page of the table of messages.
uint32_t root_of_messages(const std::filesystem::path& path) {
  sqlite3* database = nullptr;
  sqlite3_stmt* statement = nullptr;
  sqlite3_open(path.c_str(), &database);
  sqlite3_prepare_v2(database, "SELECT rootpage FROM sqlite_master WHERE name='messages'", -1, &statement,
                     nullptr);
  sqlite3_step(statement);
  const auto root = static_cast<uint32_t>(sqlite3_column_int64(statement, 0));
  sqlite3_finalize(statement);
  sqlite3_close(database);
  return root;
}

TEST_F(Ros2BagTest, ATreeOfSharedPagesEnds) {
  const auto path = folder.path() / "a.db3";
  const test::SequenceFolder two(2);
  write_db3(path, bag_of(two.path()));
  std::string file = read_file(path);
  const size_t root = (root_of_messages(path) - 1) * kPageBytes;
  file += file.substr(root, kPageBytes);
  constexpr int kLevels = 8;  // of 101 children: 10^16 rows
  for (int i = 0; i < kLevels; ++i) {
    const std::string parent = page_of_one_child(static_cast<uint32_t>(file.size() / kPageBytes));
    if (i + 1 < kLevels) file += parent;
    if (i + 1 == kLevels) file.replace(root, kPageBytes, parent);
  }
  file.replace(28, 4, big_endian(file.size() / kPageBytes, 4));
  const auto source = open_bag(folder.write("b.db3", file), {});
  EXPECT_EQ(count_frames(*source), 2U);
  EXPECT_THAT(reasons_of(*source), HasSubstr("damaged from here on"));
}

TEST_F(Ros2BagTest, ADamagedChunkIsSkippedAndCounted) {
  std::string file = mcap_bytes(bag_of(sequence.path()), {});
  file[file.size() / 2] = static_cast<char>(file[file.size() / 2] ^ 0x55);
  const auto source = open_bag(folder.write("a.mcap", file), {});
  const size_t frames = count_frames(*source);
  EXPECT_GE(frames, 5U);
  EXPECT_LT(frames, 8U);
  EXPECT_THAT(reasons_of(*source), HasSubstr("checksum"));
}

TEST_F(Ros2BagTest, SizesThatCannotBeAreNotAllocated) {
  const std::string start = test::mcap_bytes({}, {.compression = "", .summary = false});
  const std::string bomb = test::compressed("zstd", std::string(size_t{1} << 24U, '\0'));
  for (const uint64_t claimed : {uint64_t{1} << 40U, uint64_t{1} << 28U}) {
    const std::string chunk = test::McapRecord()
                                  .number(uint64_t{0})
                                  .number(uint64_t{0})
                                  .number(claimed)
                                  .number(uint32_t{0})
                                  .text("zstd")
                                  .number(uint64_t{bomb.size()})
                                  .raw(bomb)
                                  .with_opcode(6);
    EXPECT_THAT(input_error([&] { open_bag(folder.write("a.mcap", start + chunk), {}); }),
                HasSubstr("a.mcap"));
  }
  const std::string record = test::McapRecord().number(uint8_t{5}).number(uint64_t{1} << 60U).bytes();
  EXPECT_THAT(input_error([&] { open_bag(folder.write("a.mcap", start + record), {}); }),
              HasSubstr("a.mcap"));
}

TEST_F(Ros2BagTest, MillionsOfBadRecordsAreCountedNotListed) {
  std::string records;  // messages too short for their header
  constexpr size_t kRecords = 1'000'000;
  const std::string record = test::McapRecord().with_opcode(5);
  for (size_t i = 0; i < kRecords; ++i) records += record;
  const std::string data = test::compressed("zstd", records);
  const std::string chunk = test::McapRecord()
                                .number(uint64_t{0})
                                .number(uint64_t{0})
                                .number(uint64_t{records.size()})
                                .number(uint32_t{0})
                                .text("zstd")
                                .number(uint64_t{data.size()})
                                .raw(data)
                                .with_opcode(6);
  const std::string start = test::mcap_bytes({}, {.compression = "", .summary = false});
  const auto damage = open_message_file(folder.write("a.mcap", start + chunk))->damage();
  EXPECT_GT(damage.size(), SkippedFrames::kKept);
  EXPECT_LT(damage.size(), kRecords / 10);
  EXPECT_EQ(std::distance(damage.begin(), damage.end()), SkippedFrames::kKept);
}

TEST_F(Ros2BagTest, NamesWhatIsMissing) {
  auto bag = bag_of(sequence.path());
  bag.erase(bag.begin());
  EXPECT_THAT(input_error([&] { open_bag(folder.write("a.mcap", mcap_bytes(bag, {})), {}); }),
              AllOf(HasSubstr(kColorInfoTopic), HasSubstr("--camera")));
  EXPECT_THAT(input_error([&] { open_bag(folder.write("a.mcap", test::mcap_bytes({bag[0]}, {})), {}); }),
              AllOf(HasSubstr("--topics"), HasSubstr(kColorTopic)));
  EXPECT_THAT(input_error([&] { open_bag(folder.write("a.mcap", "text"), {}); }), HasSubstr("a.mcap"));
  EXPECT_THAT(input_error([&] { open_bag(folder.write("a.db3", "text"), {}); }), HasSubstr("a.db3"));
  EXPECT_THAT(input_error([&] { open_bag(folder.write("a.db3", ""), {}); }), HasSubstr("a.db3"));
  EXPECT_THAT(input_error([&] { open_bag(folder.path() / "absent.mcap", {}); }), HasSubstr("no such file"));
  test::McapLayout json;
  json.encoding = "json";
  EXPECT_THAT(
      input_error([&] { open_bag(folder.write("a.mcap", mcap_bytes(bag_of(sequence.path()), json)), {}); }),
      HasSubstr("a.mcap"));
}

TEST_F(Ros2BagTest, NoMutatedFileBreaksTheReader) {
  const test::SequenceFolder two(2);
  const auto bag = bag_of(two.path());
  std::vector<std::string> seeds;
  for (const std::string compression : {"", "lz4", "zstd"}) {
    test::McapLayout layout;
    layout.compression = compression;
    seeds.push_back(mcap_bytes(bag, layout));
  }
  test::McapLayout plain;
  plain.chunks = plain.summary = false;
  seeds.push_back(mcap_bytes(bag, plain));
  Random random(19);
  for (int i = test::mutations(2000); i > 0; --i)
    test::read_all(
        folder.write("m.mcap", test::mutated(seeds[static_cast<size_t>(i) % seeds.size()], random)));
  write_db3(folder.path() / "seed.db3", bag);
  std::ifstream file(folder.path() / "seed.db3", std::ios::binary);
  const std::string database((std::istreambuf_iterator<char>(file)), {});
  for (int i = test::mutations(2000); i > 0; --i)
    test::read_all(folder.write("m.db3", test::mutated(database, random)));
}

}  // namespace
}  // namespace kinloop
