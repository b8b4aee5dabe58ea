#include <nlohmann/json.hpp>

#include "kinloop/core/files/byte_stream.hpp"
#include "kinloop/core/text/base64.hpp"
#include "kinloop/core/text/json.hpp"
#include "kinloop/core/time.hpp"
#include "tools/export/mcap/messages.hpp"

namespace kinloop::foxglove {
namespace {

using nlohmann::json;

// Foxglove's numbers of field types.
constexpr int kUint8 = 1, kFloat32 = 7;

json object_schema(const char* title, const json& properties) {
  return {{"title", title}, {"type", "object"}, {"properties", properties}};
}

json array_schema(const json& items) {
  return {{"type", "array"}, {"items", items}};
}

json number_schema() {
  return {{"type", "number"}};
}

json integer_schema() {
  return {{"type", "integer"}, {"minimum", 0}};
}

json string_schema() {
  return {{"type", "string"}};
}

json bytes_schema() {
  return {{"type", "string"}, {"contentEncoding", "base64"}};
}

json time_schema() {
  return object_schema("time", {{"sec", integer_schema()}, {"nsec", integer_schema()}});
}

json vector_schema() {
  return object_schema("foxglove.Vector3",
                       {{"x", number_schema()}, {"y", number_schema()}, {"z", number_schema()}});
}

json quaternion_schema() {
  return object_schema(
      "foxglove.Quaternion",
      {{"x", number_schema()}, {"y", number_schema()}, {"z", number_schema()}, {"w", number_schema()}});
}

json pose_schema() {
  return object_schema("foxglove.Pose",
                       {{"position", vector_schema()}, {"orientation", quaternion_schema()}});
}

McapTopic topic(const std::string& name, const char* schema_name, json properties) {
  properties["timestamp"] = time_schema();
  return {name, schema_name, json_text(object_schema(schema_name, properties))};
}

json to_json(const Eigen::Vector3d& v) {
  return {{"x", v.x()}, {"y", v.y()}, {"z", v.z()}};
}

json to_json(const Eigen::Quaterniond& q) {
  return {{"x", q.x()}, {"y", q.y()}, {"z", q.z()}, {"w", q.w()}};
}

json to_json(const SE3& T) {
  return {{"position", to_json(T.translation)}, {"orientation", to_json(T.rotation)}};
}

json time_of(int64_t stamp_ns) {
  const auto [seconds, nanoseconds] = split_stamp(stamp_ns);
  return {{"sec", seconds}, {"nsec", nanoseconds}};
}

const char* distortion_model(LensModel model) {
  if (model == LensModel::kKannalaBrandt) return "kannala_brandt";
  return model == LensModel::kRational ? "rational_polynomial" : "plumb_bob";
}

json field(const char* name, int offset, int type) {
  return {{"name", name}, {"offset", offset}, {"type", type}};
}

}  // namespace

McapTopic frame_transform_topic(const std::string& name) {
  return topic(name, "foxglove.FrameTransform",
               {{"parent_frame_id", string_schema()},
                {"child_frame_id", string_schema()},
                {"translation", vector_schema()},
                {"rotation", quaternion_schema()}});
}

McapTopic pose_topic(const std::string& name) {
  return topic(name, "foxglove.PoseInFrame", {{"frame_id", string_schema()}, {"pose", pose_schema()}});
}

McapTopic point_cloud_topic(const std::string& name) {
  const json field_schema =
      object_schema("foxglove.PackedElementField",
                    {{"name", string_schema()}, {"offset", integer_schema()}, {"type", integer_schema()}});
  return topic(name, "foxglove.PointCloud",
               {{"frame_id", string_schema()},
                {"pose", pose_schema()},
                {"point_stride", integer_schema()},
                {"fields", array_schema(field_schema)},
                {"data", bytes_schema()}});
}

McapTopic image_topic(const std::string& name) {
  return topic(name, "foxglove.CompressedImage",
               {{"frame_id", string_schema()}, {"data", bytes_schema()}, {"format", string_schema()}});
}

McapTopic calibration_topic(const std::string& name) {
  const json numbers = array_schema(number_schema());
  return topic(name, "foxglove.CameraCalibration",
               {{"frame_id", string_schema()},
                {"width", integer_schema()},
                {"height", integer_schema()},
                {"distortion_model", string_schema()},
                {"D", numbers},
                {"K", numbers},
                {"R", numbers},
                {"P", numbers}});
}

std::string frame_transform(int64_t stamp_ns, const std::string& parent, const std::string& child,
                            const SE3& T_parent_child) {
  return json_text({{"timestamp", time_of(stamp_ns)},
                    {"parent_frame_id", parent},
                    {"child_frame_id", child},
                    {"translation", to_json(T_parent_child.translation)},
                    {"rotation", to_json(T_parent_child.rotation)}});
}

std::string pose(int64_t stamp_ns, const std::string& frame_id, const SE3& pose) {
  return json_text({{"timestamp", time_of(stamp_ns)}, {"frame_id", frame_id}, {"pose", to_json(pose)}});
}

std::string point_cloud(int64_t stamp_ns, const std::string& frame_id, const ColoredCloud& cloud,
                        const FileFrame& frame) {
  constexpr uint8_t kOpaque = 255;
  constexpr size_t kStride = 16;
  std::string data;
  data.reserve(cloud.size() * kStride);
  for (size_t i = 0; i < cloud.size(); ++i) {
    const Eigen::Vector3f p = frame.to_file(cloud.points[i]);
    if (!p.allFinite()) continue;
    put_values(data, p.data(), 3);
    put_values(data, cloud.colors[i].data(), 3);
    put_values(data, &kOpaque, 1);
  }
  const json fields = {field("x", 0, kFloat32),   field("y", 4, kFloat32),    field("z", 8, kFloat32),
                       field("red", 12, kUint8),  field("green", 13, kUint8), field("blue", 14, kUint8),
                       field("alpha", 15, kUint8)};
  return json_text({{"timestamp", time_of(stamp_ns)},
                    {"frame_id", frame_id},
                    {"pose", to_json(SE3())},
                    {"point_stride", kStride},
                    {"fields", fields},
                    {"data", base64(data)}});
}

std::string jpeg_image(int64_t stamp_ns, const std::string& frame_id, std::string_view jpeg) {
  return json_text(
      {{"timestamp", time_of(stamp_ns)}, {"frame_id", frame_id}, {"format", "jpeg"}, {"data", base64(jpeg)}});
}

std::string calibration(int64_t stamp_ns, const std::string& frame_id, const PinholeCamera& camera) {
  const PinholeCamera& c = camera;
  return json_text({{"timestamp", time_of(stamp_ns)},
                    {"frame_id", frame_id},
                    {"width", c.width},
                    {"height", c.height},
                    {"distortion_model", distortion_model(c.lens.model)},
                    {"D", lens_coefficients(c.lens)},
                    {"K", {c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1}},
                    {"R", {1, 0, 0, 0, 1, 0, 0, 0, 1}},
                    {"P", {c.fx, 0, c.cx, 0, 0, c.fy, c.cy, 0, 0, 0, 1, 0}}});
}

}  // namespace kinloop::foxglove
