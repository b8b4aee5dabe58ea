// Stray Scanner: rgb.mp4, depth/000000.png (256 x 192, millimetres), confidence/000000.png (0 to 2),
// camera_matrix.csv, and odometry.csv with a line for each frame, which is that of the video by its number:
//   timestamp, frame, x, y, z, qx, qy, qz, qw[, fx, fy, cx, cy]
// The poses are those of a camera with y down, looking along z.

#include <algorithm>
#include <sstream>
#include <utility>

#include <fmt/format.h>

#include "drivers/datasets/layouts/layouts.hpp"
#include "drivers/datasets/phones/phone_camera.hpp"
#include "drivers/datasets/reading/images/image_bytes.hpp"
#include "drivers/datasets/reading/images/video_reader.hpp"
#include "drivers/datasets/reading/lists/image_pairs.hpp"
#include "drivers/datasets/reading/matrix_text.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "kinloop/core/time_unit.hpp"

namespace kinloop {
namespace {

namespace fs = std::filesystem;

constexpr const char* kStrayColumns = "timestamp, frame, x, y, z, qx, qy, qz, qw";

std::string stray_scanner_evidence(const fs::path&, const FolderContents& contents) {
  const bool fits = contents.has_file("rgb.mp4") && contents.has_file("odometry.csv");
  return fits ? "rgb.mp4, odometry.csv" : "";
}

/// The fields of each line after the header, without blanks.
std::vector<TextLine> read_csv(const fs::path& file) {
  require_size(file, kMostListBytes);
  std::istringstream content(read_file(file));
  std::vector<TextLine> lines;
  std::string text;
  for (size_t number = 1; std::getline(content, text); ++number) {
    std::erase_if(text, [](char c) { return c == ' ' || c == '\r' || c == '\t'; });
    if (number == 1 || text.empty()) continue;
    TextLine line{number, {}};
    std::istringstream fields(text);
    for (std::string field; std::getline(fields, field, ',');) line.fields.push_back(field);
    lines.push_back(std::move(line));
  }
  return lines;
}

constexpr size_t kColumns = 9;

void require_columns(const TextLine& line, const fs::path& file) {
  if (line.fields.size() < kColumns)
    throw_parse_error(file, line.number,
                      fmt::format("expected '{}', found {} fields", kStrayColumns, line.fields.size()));
}

/// A line of the odometry: the frame and the pose of its camera.
StampedPose parse_odometry(const TextLine& line, const fs::path& file) {
  constexpr size_t kPose = 2;
  const auto stamp_ns = parse_stamp_ns(line.fields[0]);
  if (!stamp_ns)
    throw_parse_error(file, line.number, fmt::format("'{}' is not a time in seconds", line.fields[0]));
  std::vector<double> pose;
  for (size_t i = kPose; i < kColumns; ++i) pose.push_back(parse_double(line.fields[i], file, line.number));
  const auto T_world_camera = motion_of(pose);
  if (!T_world_camera)
    throw_parse_error(file, line.number, "the quaternion is zero; correct or delete the line");
  return {*stamp_ns, *T_world_camera};
}

/// The number of a frame in the video: rows may be missing, or in another order.
size_t parse_frame(const TextLine& line, const fs::path& file) {
  constexpr size_t kMost = 10'000'000;  // four days at 30 Hz
  const auto number = parse_whole(line.fields[1]);
  if (!number || *number > kMost)
    throw_parse_error(
        file, line.number,
        fmt::format("'{}' is not the number of a frame; correct or delete the line", line.fields[1]));
  return static_cast<size_t>(*number);
}

/// The rows in the order of the video, with their frames in it.
std::vector<std::pair<size_t, TextLine>> rows_by_frame(const fs::path& file) {
  std::vector<std::pair<size_t, TextLine>> numbered;
  for (TextLine& line : read_csv(file)) {
    require_columns(line, file);
    const size_t frame = parse_frame(line, file);
    numbered.emplace_back(frame, std::move(line));
  }
  std::stable_sort(numbered.begin(), numbered.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  return numbered;
}

/// The lens of a frame, which newer versions of the app write.
std::optional<PinholeCamera> lens_in(const TextLine& line, const fs::path& file) {
  constexpr size_t kLens = 9;
  if (line.fields.size() < kLens + 4 || line.fields[kLens].empty()) return std::nullopt;
  std::vector<double> k;
  for (size_t i = kLens; i < kLens + 4; ++i) k.push_back(parse_double(line.fields[i], file, line.number));
  return make_lens({}, k[0], k[1], k[2], k[3]);
}

/// The lenses of all frames, or the one in camera_matrix.csv; nullopt if there are none.
std::optional<RgbdCamera> stray_camera(const fs::path& folder, std::vector<PinholeCamera> lenses,
                                       const RecordedSequence& sequence) {
  const fs::path matrix = folder / "camera_matrix.csv";
  std::error_code absent;
  if (lenses.empty() && !fs::exists(matrix, absent)) return std::nullopt;
  const cv::Size size = VideoReader(sequence.video).size();
  if (lenses.empty()) lenses = {read_lens(matrix, size)};
  for (PinholeCamera& lens : lenses) lens.width = size.width, lens.height = size.height;
  return phone_camera(lenses, image_size(sequence.frames, &RecordedFrame::depth), matrix);
}

RecordedSequence read_stray_scanner(const fs::path& folder) {
  RecordedSequence sequence;
  sequence.layout = "Stray Scanner folder";
  sequence.video = folder / "rgb.mp4";
  const fs::path file = folder / "odometry.csv";
  std::vector<PinholeCamera> lenses;
  for (const auto& [video_frame, line] : rows_by_frame(file)) {
    const auto [stamp_ns, T_world_camera] = parse_odometry(line, file);
    const fs::path image = line.fields[1] + ".png";
    RecordedFrame frame{stamp_ns, stamp_ns, {}, {folder / "depth" / image}, {}, video_frame};
    const fs::path confidence = folder / "confidence" / image;
    std::error_code absent;
    if (fs::exists(confidence, absent)) frame.confidence = confidence;
    if (!sequence.frames.empty() && stamp_ns <= sequence.frames.back().stamp_ns) {
      sequence.skipped.add(
          {image.string(), fmt::format("{}:{}: time does not increase", file.string(), line.number)});
      continue;
    }
    sequence.frames.push_back(frame);
    if (const auto lens = lens_in(line, file)) lenses.push_back(*lens);
    sequence.ground_truth.push_back({stamp_ns, T_world_camera});
  }
  if (sequence.frames.empty())
    throw InputError(fmt::format("{}: empty; expected lines '{}'", file.string(), kStrayColumns));
  sequence.camera_remedy = "no camera_matrix.csv; export the recording again";
  sequence.camera = stray_camera(folder, lenses, sequence);
  sequence.sensor = DepthSensorModel::kIphone;
  if (sequence.camera) sequence.camera->fps = median_rate_hz(sequence.frames, sequence.camera->fps);
  return sequence;
}

}  // namespace

SequenceLayout stray_scanner_layout() {
  return {"Stray Scanner", "rgb.mp4, depth/ and odometry.csv", stray_scanner_evidence, read_stray_scanner};
}

}  // namespace kinloop
