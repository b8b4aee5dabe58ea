#include <fmt/format.h>

#include "kinloop/core/files/byte_stream.hpp"
#include "kinloop/io/map_file/camera_values.hpp"
#include "kinloop/io/map_file/feature_serialization.hpp"
#include "kinloop/io/map_file/map_file.hpp"
#include "kinloop/io/map_file/map_tables.hpp"

namespace kinloop {
namespace {

namespace tables = map_tables;

const std::vector<std::string> kPoseColumns = {"x", "y", "z", "qx", "qy", "qz", "qw"};

std::vector<std::string> with_pose(std::vector<std::string> columns,
                                   const std::vector<std::string>& after = {}) {
  columns.insert(columns.end(), kPoseColumns.begin(), kPoseColumns.end());
  columns.insert(columns.end(), after.begin(), after.end());
  return columns;
}

void add_pose(Row& row, const SE3& pose) {
  for (int i = 0; i < 3; ++i) row.emplace_back(pose.translation(i));
  for (int i = 0; i < 4; ++i) row.emplace_back(pose.rotation.coeffs()(i));
}

void write_about(DatabaseWriter& file, const SavedMap& map, size_t image_count) {
  const auto landmarks = std::count_if(map.map.landmarks.begin(), map.map.landmarks.end(),
                                       [](const auto& landmark) { return landmark.has_value(); });
  const auto count = [](size_t n) { return Cell(static_cast<int64_t>(n)); };
  const std::vector<std::pair<std::string, Cell>> about = {
      {"program", map.program},
      {"components", int64_t{map.map.component_count}},
      {tables::kKeyframe, count(map.map.keyframes.size())},
      {tables::kLoopEdge, count(map.map.loop_closures.size())},
      {tables::kOtherLoop, count(map.map.other_loops.size())},
      {tables::kLandmark, int64_t{landmarks}},
      {tables::kFrame, count(map.frames.size())},
      {tables::kImage, count(image_count)},
  };
  file.create(tables::kAbout, {"key", "value"});
  int64_t id = 0;
  for (const auto& [key, value] : about) file.insert(tables::kAbout, id++, {key, value});
}

void write_settings(DatabaseWriter& file, const SavedMap& map) {
  int64_t id = 0;
  file.create(tables::kSession, {"input", "first_frame"});
  for (const SavedSession& session : map.sessions) {
    file.insert(tables::kSession, id++, {session.input, int64_t{session.first_frame.value}});
  }
  id = 0;
  file.create(tables::kOption, {"key", "value"});
  for (const auto& [key, value] : map.options) file.insert(tables::kOption, id++, {key, value});
  id = 0;
  file.create(tables::kSensor, {"value", "sigma", "used"});
  for (const SavedParameter& p : map.sensor)
    file.insert(tables::kSensor, id++, {p.value, p.sigma, int64_t{p.used}});
}

void write_camera(DatabaseWriter& file, const RgbdCamera& camera) {
  file.create(tables::kCamera, {"name", "value"});
  int64_t id = 0;
  for (const auto& [name, value] : camera_values(camera)) file.insert(tables::kCamera, id++, {name, value});
}

void write_keyframes(DatabaseWriter& file, const MapData& map) {
  file.create(tables::kKeyframe,
              with_pose({"frame", "stamp_ns", "component", "begins_component"}, {"features", "visit"}));
  for (size_t i = 0; i < map.keyframes.size(); ++i) {
    const Keyframe& keyframe = map.keyframes[i];
    Row row = {int64_t{keyframe.frame.value}, keyframe.stamp_ns, int64_t{keyframe.component},
               int64_t{keyframe.begins_component}};
    add_pose(row, keyframe.T_world_camera);
    row.emplace_back(Blob{serialize_features(*keyframe.features)});
    row.emplace_back(int64_t{keyframe.visit});
    file.insert(tables::kKeyframe, static_cast<int64_t>(i), row);
  }
}

/// The columns that edges and other loops have.
Row loop_row(const LoopClosure& loop) {
  Row row = {int64_t{loop.a.value}, int64_t{loop.b.value}};
  add_pose(row, loop.T_a_b);
  Blob information;
  put_values(information.bytes, loop.information.data(), static_cast<size_t>(loop.information.size()));
  row.emplace_back(std::move(information));
  row.emplace_back(int64_t{loop.evidence.inliers});
  row.emplace_back(int64_t{loop.support});
  return row;
}

void write_loop_closures(DatabaseWriter& file, const MapData& map) {
  file.create(tables::kLoopEdge, with_pose({"a", "b"}, {"information", "inliers", "support"}));
  int64_t id = 0;
  for (const LoopClosure& loop : map.loop_closures) file.insert(tables::kLoopEdge, id++, loop_row(loop));
}

void write_other_loops(DatabaseWriter& file, const MapData& map) {
  file.create(tables::kOtherLoop, with_pose({"a", "b"}, {"information", "inliers", "support", "scale",
                                                         "scale_sigma", "status", "reason"}));
  int64_t id = 0;
  for (const LoopClosure& loop : map.other_loops) {
    Row row = loop_row(loop);
    row.emplace_back(loop.evidence.scale.factor);
    row.emplace_back(loop.evidence.scale.sigma);
    row.emplace_back(std::string(name_of(loop.stage)));
    row.emplace_back(std::string(name_of(loop.reason)));
    file.insert(tables::kOtherLoop, id++, row);
  }
}

void write_landmarks(DatabaseWriter& file, const MapData& map) {
  file.create(tables::kLandmark, {"anchor", "x", "y", "z", "observations"});
  for (size_t i = 0; i < map.landmarks.size(); ++i) {
    if (!map.landmarks[i]) continue;
    const Landmark& landmark = *map.landmarks[i];
    Blob observations;
    put_list(observations.bytes, landmark.observations);
    file.insert(tables::kLandmark, static_cast<int64_t>(i),
                {int64_t{landmark.anchor.value}, landmark.p_anchor.x(), landmark.p_anchor.y(),
                 landmark.p_anchor.z(), std::move(observations)});
  }
}

/// The number of a frame's status in the file.
int64_t status_number(const FrameRecord& frame) {
  if (frame.is_lost()) return 2;
  return frame.method == TrackingMethod::kDense ? 1 : 0;
}

/// What stands in the place of a measurement: 1 = the image repeats the previous one, 2 = prediction; 0 =
/// nothing.
int64_t unmeasured_number(const FrameRecord& frame) {
  if (frame.method == TrackingMethod::kPredicted) return 2;
  return frame.is_repeat() ? 1 : 0;
}

void write_frames(DatabaseWriter& file, const std::vector<FrameRecord>& frames) {
  file.create(tables::kFrame, with_pose({"frame", "stamp_ns", "status", "reference", "keyframe", "repeat"},
                                        {"depth_lag_s", "doubtful"}));
  int64_t id = 0;
  for (const FrameRecord& frame : frames) {
    Row row = {int64_t{frame.id.value},       frame.stamp_ns,
               status_number(frame),          int64_t{frame.reference.value},
               int64_t{frame.keyframe.value}, unmeasured_number(frame)};
    add_pose(row, frame.T_reference_camera);
    row.emplace_back(static_cast<double>(frame.depth_stamp_difference_s));
    row.emplace_back(static_cast<int64_t>(frame.trust.cause));
    file.insert(tables::kFrame, id++, row);
  }
}

Blob blob_of(const std::vector<uint8_t>& bytes) {
  return {std::string(bytes.begin(), bytes.end())};
}

void write_images(DatabaseWriter& file, size_t count, const ImageLoader& images) {
  file.create(tables::kImage, {"frame", "rows", "cols", "color", "depth"});
  for (size_t i = 0; i < count; ++i) {
    const auto [frame, image] = images(i);
    file.insert(tables::kImage, static_cast<int64_t>(i),
                {int64_t{frame.value}, int64_t{image.rows}, int64_t{image.cols}, blob_of(image.color),
                 blob_of(image.depth)});
  }
}

}  // namespace

void write_map(const std::filesystem::path& path, const SavedMap& map, size_t image_count,
               const ImageLoader& images) {
  DatabaseWriter file(path, tables::kKind);
  // The most valuable data comes first, since damage mostly affects the end of a file.
  write_about(file, map, image_count);
  write_settings(file, map);
  write_camera(file, map.camera);
  write_keyframes(file, map.map);
  write_loop_closures(file, map.map);
  write_other_loops(file, map.map);
  write_landmarks(file, map.map);
  write_frames(file, map.frames);
  write_images(file, image_count, images);
  file.commit();
}

}  // namespace kinloop
