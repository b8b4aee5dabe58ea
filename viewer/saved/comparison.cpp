#include "viewer/saved/comparison.hpp"

#include <array>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "dense/up_direction.hpp"
#include "viewer/saved/sent_shapes.hpp"

namespace kinloop {
namespace {

using nlohmann::json;

constexpr Rgb kMovedFromColor = {150, 185, 255}, kMovedToColor = {40, 100, 245};

/// A hint of orange and of blue in the grey of what stayed, so that the two clouds can be told apart.
constexpr Rgb kRestBeforeColor = {190, 150, 105}, kRestAfterColor = {105, 150, 190};

constexpr std::array<std::pair<DifferenceLayer, const char*>, 5> kLayers = {
    {{DifferenceLayer::kGone, "gone"},
     {DifferenceLayer::kAdded, "added"},
     {DifferenceLayer::kMoved, "moved"},
     {DifferenceLayer::kRestBefore, "restBefore"},
     {DifferenceLayer::kRestAfter, "restAfter"}}};

/// Half of its brightness, half of the tint's colour: less prominent than what changed.
Rgb dimmed(const Rgb& color, const Rgb& tint) {
  Rgb mixed = gray_of(color);
  for (size_t c = 0; c < mixed.size(); ++c) mixed[c] = static_cast<uint8_t>((mixed[c] + tint[c]) / 2);
  return mixed;
}

/// Which points belong to objects that were moved.
std::vector<bool> moved_points(size_t count, const std::vector<ChangedObject>& objects,
                               std::vector<uint32_t> ChangedObject::*points) {
  std::vector<bool> moved(count, false);
  for (const ChangedObject& object : objects) {
    if (object.change != ObjectChange::kMoved) continue;
    for (const uint32_t i : object.*points) moved[i] = true;
  }
  return moved;
}

/// One side of a layer: the points of a cloud for which `is_in(i)` holds, in `paint(colour)`.
template <class IsIn, class Paint>
void append(const ColoredCloud& cloud, const IsIn& is_in, const Paint& paint, ColoredCloud& layer) {
  for (size_t i = 0; i < cloud.size(); ++i) {
    if (!is_in(i)) continue;
    layer.points.push_back(cloud.points[i]);
    layer.colors.push_back(paint(cloud.colors[i]));
  }
}

/// The corners of the upright box around some points, in the world: x fastest, z slowest.
json box_of(const ColoredCloud& cloud, const std::vector<uint32_t>& points,
            const Eigen::Quaterniond& R_file_world) {
  if (points.empty()) return nullptr;
  const Eigen::Matrix3f turn = R_file_world.toRotationMatrix().cast<float>();
  Eigen::AlignedBox3f box;
  for (const uint32_t i : points) box.extend(Eigen::Vector3f(turn * cloud.points[i]));
  json corners = json::array();
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3f p_world =
        turn.transpose() * box.corner(static_cast<Eigen::AlignedBox3f::CornerType>(corner));
    corners.push_back({p_world.x(), p_world.y(), p_world.z()});
  }
  return corners;
}

/// The figures of `kinloop map diff --json`, with the boxes of the objects.
json figures_of(const Comparison& comparison) {
  const MapDifference& difference = comparison.difference;
  json figures = to_json(difference, comparison.R_file_world);
  for (size_t i = 0; i < difference.objects.size(); ++i) {
    const ChangedObject& object = difference.objects[i];
    figures["objects"][i]["boxBefore"] =
        box_of(comparison.before.cloud, object.points_before, comparison.R_file_world);
    figures["objects"][i]["boxAfter"] =
        box_of(comparison.after.cloud, object.points_after, comparison.R_file_world);
  }
  return figures;
}

std::vector<Eigen::Vector3f> positions_of(const Trajectory& path) {
  std::vector<Eigen::Vector3f> positions;
  for (const StampedPose& pose : path) positions.emplace_back(pose.T_world_camera.translation.cast<float>());
  return positions;
}

void show_ways(Scene& scene, const Comparison& comparison) {
  std::vector<SE3> keyframes = camera_poses(comparison.before.keyframes);
  for (const SE3& pose : camera_poses(comparison.after.keyframes)) keyframes.push_back(pose);
  put_parts(scene, PartKind::kKeyframes, 0, keyframes.size(), [&](size_t begin, size_t end) {
    return encode_poses(std::span(keyframes).subspan(begin, end - begin));
  });
  const auto path = positions_of(comparison.before.path);
  put_parts(scene, PartKind::kPath, 0, path.size(), [&](size_t begin, size_t end) {
    std::vector<PathPoint> points;
    for (size_t i = begin; i < end; ++i) points.push_back({{}, path[i]});
    return encode_path(points);
  });
  scene.put(PartKind::kOtherPath, 0, encode_points(positions_of(comparison.after.path)));
  scene.put(PartKind::kLoops, 0, encode_pairs(comparison.loops));
}

/// The frames of both; keyframes are numbered as in the scene.
void show_timelines(Scene& scene, const Comparison& comparison) {
  scene.put(PartKind::kTimeline, 0, encode_timeline(comparison.before.timeline));
  std::vector<TimelineFrame> after = comparison.after.timeline;
  for (TimelineFrame& frame : after) {
    if (frame.keyframe.valid())
      frame.keyframe.value += static_cast<uint32_t>(comparison.before.keyframes.size());
  }
  scene.put(PartKind::kTimeline, 1, encode_timeline(after));
}

/// Sends the clouds, and returns which pieces belong to which layer: [first, end).
json show_layers(Scene& scene, const Comparison& comparison) {
  json pieces_of_layer;
  uint32_t index = 0;
  for (const auto& [layer, name] : kLayers) {
    const uint32_t first = index;
    for (const CloudPiece& piece : split_into_pieces(layer_of(comparison, layer)))
      scene.put(PartKind::kCloud, index++, encode_cloud(piece));
    pieces_of_layer[name] = {first, index};
  }
  return pieces_of_layer;
}

}  // namespace

ColoredCloud layer_of(const Comparison& comparison, DifferenceLayer layer) {
  const MapDifference& difference = comparison.difference;
  const ColoredCloud &before = comparison.before.cloud, &after = comparison.after.cloud;
  const auto from = moved_points(before.size(), difference.objects, &ChangedObject::points_before);
  const auto to = moved_points(after.size(), difference.objects, &ChangedObject::points_after);
  const auto changed = [](const std::vector<PointChange>& changes, size_t i) {
    return changes[i] == PointChange::kChanged;
  };
  const auto in = [](const Rgb& tint) { return [tint](const Rgb& color) { return tinted(color, tint); }; };
  const auto dim = [](const Rgb& tint) { return [tint](const Rgb& color) { return dimmed(color, tint); }; };
  ColoredCloud points;
  switch (layer) {
    case DifferenceLayer::kRestBefore:
      append(
          before, [&](size_t i) { return !changed(difference.before, i); }, dim(kRestBeforeColor), points);
      break;
    case DifferenceLayer::kRestAfter:
      append(
          after, [&](size_t i) { return !changed(difference.after, i); }, dim(kRestAfterColor), points);
      break;
    case DifferenceLayer::kGone:
      append(
          before, [&](size_t i) { return changed(difference.before, i) && !from[i]; }, in(kGoneColor),
          points);
      break;
    case DifferenceLayer::kAdded:
      append(
          after, [&](size_t i) { return changed(difference.after, i) && !to[i]; }, in(kAddedColor), points);
      break;
    case DifferenceLayer::kMoved:
      append(
          before, [&](size_t i) { return from[i]; }, in(kMovedFromColor), points);
      append(
          after, [&](size_t i) { return to[i]; }, in(kMovedToColor), points);
      break;
  }
  return points;
}

void show_comparison(Scene& scene, const Comparison& comparison) {
  const ComparedVisit &before = comparison.before, &after = comparison.after;
  const Eigen::Vector3d& up = comparison.up;
  scene.put(PartKind::kHello, 0,
            encode_json({{"run", scene.run()},
                         {"input", fmt::format("{} \u2192 {}", before.name, after.name)},
                         {"live", false},
                         {"colors", {"camera", "height"}},
                         {"upKnown", true},
                         {"frustum", {comparison.half_size_at_1m.x(), comparison.half_size_at_1m.y()}}}));
  show_ways(scene, comparison);
  scene.put(PartKind::kStatus, 0,
            encode_json({{"stage", "saved"},
                         {"up", {up.x(), up.y(), up.z()}},
                         {"keyframes", before.keyframes.size() + after.keyframes.size()},
                         {"points", before.cloud.size() + after.cloud.size()},
                         {"loops", comparison.loops.size()}}));
  json table = figures_of(comparison);
  table["names"] = {before.name, after.name};
  table["loopsBetween"] = comparison.loops_between;
  table["keyframesBefore"] = before.keyframes.size();
  table["pieces"] = show_layers(scene, comparison);
  scene.put(PartKind::kComparison, 0, encode_json(table));
  show_timelines(scene, comparison);
}

}  // namespace kinloop
