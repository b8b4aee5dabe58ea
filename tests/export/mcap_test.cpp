#include <array>
#include <map>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "drivers/bags/bag_files.hpp"
#include "drivers/bags/chunk_decompression.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "kinloop/core/text/base64.hpp"
#include "tests/support/temp_folder.hpp"
#include "tests/support/value_at.hpp"
#include "tools/export/mcap/mcap_writer.hpp"
#include "tools/export/mcap/recording.hpp"

namespace kinloop {
namespace {

using nlohmann::json;
using test::value_at;

struct FileRecord {
  uint8_t opcode = 0;
  size_t start = 0, size = 0;  ///< of the content

  [[nodiscard]] size_t end() const { return start + size; }
};

constexpr size_t kSignatureBytes = 8, kRecordStart = 9;

FileRecord record_at(const std::string& file, size_t position) {
  return {value_at<uint8_t>(file, position), position + kRecordStart,
          static_cast<size_t>(value_at<uint64_t>(file, position + 1))};
}

/// The records outside of chunks.
std::vector<FileRecord> records_of(const std::string& file) {
  std::vector<FileRecord> records;
  for (size_t position = kSignatureBytes; position + kSignatureBytes < file.size();
       position = records.back().end()) {
    records.push_back(record_at(file, position));
  }
  EXPECT_EQ(records.back().end() + kSignatureBytes, file.size());
  return records;
}

uint32_t crc_of_bytes(const std::string& file, size_t begin, size_t end) {
  return crc32({reinterpret_cast<const uint8_t*>(file.data()) + begin, end - begin});
}

std::string message_of_size(size_t size, int number) {
  std::string text;
  for (size_t i = 0; i < size; ++i)
    text += static_cast<char>('a' + (i * i + static_cast<size_t>(number)) % 26);
  return text;
}

/// A file of several chunks and two topics.
std::string write_two_topics(const std::filesystem::path& path) {
  McapWriter writer(path);
  const uint16_t a = writer.add_topic({"/a", "A", "{}"}), b = writer.add_topic({"/b", "B", "{}"});
  for (int i = 0; i < 40; ++i) writer.write(i % 3 == 0 ? b : a, 1000 + i, message_of_size(100'000, i));
  writer.commit();
  return read_file(path);
}

TEST(McapWriter, TheReaderFindsEveryMessageAndNoDamage) {
  const test::TempFolder folder;
  write_two_topics(folder.path() / "a.mcap");
  const auto file = open_mcap(folder.path() / "a.mcap");
  std::map<std::string, size_t> counts;
  for (const BagTopic* topic : file->topics()) counts[topic->name] = topic->messages;
  EXPECT_EQ(counts, (std::map<std::string, size_t>{{"/a", 26}, {"/b", 14}}));
  file->select({"/a", "/b"});
  int i = 0;
  for (auto message = file->next(); message; message = file->next(), ++i) {
    EXPECT_EQ(message->topic->name, i % 3 == 0 ? "/b" : "/a");
    EXPECT_EQ(message->topic->encoding, "json");
    EXPECT_EQ(message->log_ns, 1000 + i);
    EXPECT_TRUE(as_text(message->data) == message_of_size(100'000, i));
  }
  EXPECT_EQ(i, 40);
  EXPECT_TRUE(file->damage().empty());
}

TEST(McapWriter, IndexesPointAtTheirMessages) {
  const test::TempFolder folder;
  const std::string file = write_two_topics(folder.path() / "a.mcap");
  constexpr uint8_t kChunk = 6, kMessageIndex = 7, kChunkIndex = 8;
  size_t chunks = 0, indexed = 0;
  for (const FileRecord& index : records_of(file)) {
    if (index.opcode != kChunkIndex) continue;
    ++chunks;
    const auto chunk_start = static_cast<size_t>(value_at<uint64_t>(file, index.start + 16));
    const FileRecord chunk = record_at(file, chunk_start);
    ASSERT_EQ(chunk.opcode, kChunk);
    EXPECT_EQ(chunk.end() - chunk_start, value_at<uint64_t>(file, index.start + 24));
    EXPECT_EQ(file.substr(chunk.start, 16), file.substr(index.start, 16)) << "first and last stamp";
    const auto size = value_at<uint64_t>(file, chunk.start + 16);
    const size_t data = chunk.start + 8 + 8 + 8 + 4 + 4 + 4 + 8;  // after "zstd" and its length
    const auto records = decompressed(
        "zstd", {reinterpret_cast<const uint8_t*>(file.data()) + data, chunk.end() - data}, size);
    EXPECT_EQ(crc32(records), value_at<uint32_t>(file, chunk.start + 24));
    const std::string text(records.begin(), records.end());
    const auto offsets_bytes = value_at<uint32_t>(file, index.start + 32);
    for (size_t at = index.start + 36; at < index.start + 36 + offsets_bytes; at += 10) {
      const auto topic = value_at<uint16_t>(file, at);
      const FileRecord messages = record_at(file, static_cast<size_t>(value_at<uint64_t>(file, at + 2)));
      ASSERT_EQ(messages.opcode, kMessageIndex);
      EXPECT_EQ(value_at<uint16_t>(file, messages.start), topic);
      for (size_t entry = messages.start + 6; entry < messages.end(); entry += 16, ++indexed) {
        const FileRecord message = record_at(text, static_cast<size_t>(value_at<uint64_t>(file, entry + 8)));
        EXPECT_EQ(value_at<uint16_t>(text, message.start), topic);
        EXPECT_EQ(value_at<uint64_t>(text, message.start + 6), value_at<uint64_t>(file, entry));
      }
    }
  }
  EXPECT_GT(chunks, 1U);
  EXPECT_EQ(indexed, 40U);
}

TEST(McapWriter, ChecksumsOfTheSectionsAreRight) {
  const test::TempFolder folder;
  const std::string file = write_two_topics(folder.path() / "a.mcap");
  constexpr uint8_t kFooter = 2, kSummaryOffset = 0x0E, kDataEnd = 0x0F;
  const auto records = records_of(file);
  const FileRecord footer = records.back();
  ASSERT_EQ(footer.opcode, kFooter);
  const auto summary = static_cast<size_t>(value_at<uint64_t>(file, footer.start));
  EXPECT_EQ(value_at<uint32_t>(file, footer.start + 16), crc_of_bytes(file, summary, footer.start + 16));
  int ends = 0, offsets = 0;
  for (const FileRecord& record : records) {
    if (record.opcode == kDataEnd) {
      ++ends;
      EXPECT_EQ(record.end(), summary);
      EXPECT_EQ(value_at<uint32_t>(file, record.start), crc_of_bytes(file, 0, record.start - kRecordStart));
    } else if (record.opcode == kSummaryOffset) {
      ++offsets;
      const auto group = static_cast<size_t>(value_at<uint64_t>(file, record.start + 1));
      EXPECT_EQ(value_at<uint8_t>(file, group), value_at<uint8_t>(file, record.start));
    }
  }
  EXPECT_EQ(ends, 1);
  EXPECT_GE(offsets, 1);
}

TEST(McapWriter, WithoutCommitThereIsNoFile) {
  const test::TempFolder folder;
  { const McapWriter writer(folder.path() / "a.mcap"); }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

/// The messages of a file by topic.
std::map<std::string, std::vector<json>> json_messages(const std::filesystem::path& path) {
  const auto file = open_mcap(path);
  std::set<std::string> names;
  for (const BagTopic* topic : file->topics()) names.insert(topic->name);
  file->select(names);
  std::map<std::string, std::vector<json>> messages;
  int64_t last_ns = 0;
  for (auto message = file->next(); message; message = file->next()) {
    EXPECT_GE(message->log_ns, last_ns) << "in order of time";
    last_ns = message->log_ns;
    const json content = json::parse(as_text(message->data));
    EXPECT_EQ(content["timestamp"]["sec"].get<int64_t>() * 1'000'000'000 +
                  content["timestamp"]["nsec"].get<int64_t>(),
              message->log_ns);
    messages[message->topic->name].push_back(content);
  }
  EXPECT_TRUE(file->damage().empty());
  return messages;
}

MapRecording some_recording() {
  MapRecording recording;
  for (int i = 0; i < 10; ++i) {
    Vector6d twist;
    twist << 0.1 * i, -0.2 * i, 0.3, 0.02 * i, 0, 0.1;
    recording.trajectory.push_back({1'700'000'000'000'000'123 + 33'000'000LL * i, SE3::exp(twist)});
  }
  recording.images = {{recording.trajectory[0].stamp_ns, 0}, {recording.trajectory[5].stamp_ns, 1}};
  recording.cloud = {{{1, 2, 3}, {4, 5, 6}}, {Rgb{255, 128, 0}, Rgb{1, 2, 3}}};
  const LensDistortion lens{LensModel::kBrownConrady, 0.26, -0.95, -0.005, 0.0026, 1.16};
  recording.camera = {640, 480, 517.3, 516.5, 318.6, 255.3, lens};
  recording.frame = z_up_frame({0.1, -1, 0.2}, SE3());
  return recording;
}

std::vector<uint8_t> fake_jpeg(size_t image) {
  return {0xff, 0xd8, static_cast<uint8_t>(image), 0, 7};
}

Eigen::Vector3d vector_of(const json& v) {
  return {v["x"].get<double>(), v["y"].get<double>(), v["z"].get<double>()};
}

TEST(MapRecording, HoldsPosesCloudAndImages) {
  const test::TempFolder folder;
  const MapRecording recording = some_recording();
  write_map_recording(folder.path() / "m.mcap", recording, fake_jpeg);
  auto messages = json_messages(folder.path() / "m.mcap");
  ASSERT_EQ(messages["/tf"].size(), 10U);
  ASSERT_EQ(messages["/pose"].size(), 10U);
  ASSERT_EQ(messages["/camera/image"].size(), 2U);
  ASSERT_EQ(messages["/camera/calibration"].size(), 2U);
  ASSERT_EQ(messages["/cloud"].size(), 1U);
  for (size_t i = 0; i < 10; ++i) {
    const SE3 T =
        SE3{recording.frame.R_file_world, Eigen::Vector3d::Zero()} * recording.trajectory[i].T_world_camera;
    const json& tf = messages["/tf"][i];
    const json& q = tf["rotation"];
    const Eigen::Quaterniond rotation(q["w"].get<double>(), q["x"].get<double>(), q["y"].get<double>(),
                                      q["z"].get<double>());
    EXPECT_LT((vector_of(tf["translation"]) - T.translation).norm(), 1e-12);
    EXPECT_LT(rotation.angularDistance(T.rotation), 1e-7);
    EXPECT_EQ(messages["/pose"][i]["pose"]["orientation"], q);
    EXPECT_EQ(messages["/pose"][i]["pose"]["position"], tf["translation"]);
    EXPECT_EQ(messages["/pose"][i]["frame_id"], tf["parent_frame_id"]);
  }
  const json& image = messages["/camera/image"][1];
  EXPECT_EQ(image["data"], base64({"\xff\xd8\x01\0\x07", 5}));
  EXPECT_EQ(image["frame_id"], messages["/tf"][0]["child_frame_id"]);
  EXPECT_EQ(messages["/camera/calibration"][0]["K"][5], 255.3);
  const json& cloud = messages["/cloud"][0];
  std::string points;
  for (size_t i = 0; i < 2; ++i) {
    const Eigen::Vector3f p = recording.frame.to_file(recording.cloud.points[i]);
    points.append(reinterpret_cast<const char*>(p.data()), 12);
    points.append(reinterpret_cast<const char*>(recording.cloud.colors[i].data()), 3);
    points += '\xff';
  }
  EXPECT_EQ(cloud["data"], base64(points));
  EXPECT_EQ(cloud["point_stride"], 16);
}

TEST(MapRecording, NamesTheModelOfTheLens) {
  const test::TempFolder folder;
  MapRecording recording = some_recording();
  const auto calibration = [&](const LensDistortion& lens) {
    recording.camera.lens = lens;
    write_map_recording(folder.path() / "m.mcap", recording, fake_jpeg);
    return json_messages(folder.path() / "m.mcap")["/camera/calibration"].at(0);
  };
  const json brown = calibration({LensModel::kBrownConrady, 0.26, -0.95, -0.005, 0.0026, 1.16});
  EXPECT_EQ(brown["distortion_model"], "plumb_bob");
  EXPECT_EQ(brown["D"], json({0.26, -0.95, -0.005, 0.0026, 1.16}));
  const json rational = calibration({LensModel::kRational, 1, 2, 3, 4, 5, 6, 7, 8});
  EXPECT_EQ(rational["distortion_model"], "rational_polynomial");
  EXPECT_EQ(rational["D"], json({1, 2, 3, 4, 5, 6, 7, 8}));
  const json fisheye = calibration(lens_with(LensModel::kKannalaBrandt, std::array{0.1, 0.2, 0.3, 0.4}));
  EXPECT_EQ(fisheye["distortion_model"], "kannala_brandt");
  EXPECT_EQ(fisheye["D"], json({0.1, 0.2, 0.3, 0.4}));
}

TEST(MapRecording, LeavesOutWhatIsNotFinite) {
  const test::TempFolder folder;
  MapRecording recording = some_recording();
  recording.trajectory[3].T_world_camera.translation.x() = std::numeric_limits<double>::quiet_NaN();
  recording.cloud.points[0].x() = std::numeric_limits<float>::infinity();
  write_map_recording(folder.path() / "m.mcap", recording, fake_jpeg);
  auto messages = json_messages(folder.path() / "m.mcap");
  EXPECT_EQ(messages["/tf"].size(), 9U);
  EXPECT_EQ(messages["/cloud"][0]["data"].get<std::string>().size(), base64(std::string(16, 'x')).size());
}

TEST(MapRecording, AnEmptyMapGivesAValidFile) {
  const test::TempFolder folder;
  write_map_recording(folder.path() / "m.mcap", {}, fake_jpeg);
  EXPECT_EQ(open_mcap(folder.path() / "m.mcap")->topics().size(), 5U);
  EXPECT_TRUE(json_messages(folder.path() / "m.mcap").empty());
}

}  // namespace
}  // namespace kinloop
