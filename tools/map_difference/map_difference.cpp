#include "tools/map_difference/map_difference.hpp"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "kinloop/core/text/rounded_number.hpp"

namespace kinloop {
namespace {

using nlohmann::json;

constexpr double kMmPerM = 1e3;

/// Adds the groups that no pair has.
void add_unpaired(ObjectChange change, const std::vector<PointGroup>& groups,
                  const std::vector<MovedPair>& moved, size_t MovedPair::*side,
                  std::vector<uint32_t> ChangedObject::*points, std::vector<ChangedObject>& objects) {
  for (size_t i = 0; i < groups.size(); ++i) {
    if (std::ranges::any_of(moved, [=](const MovedPair& pair) { return pair.*side == i; })) continue;
    objects.push_back({change, groups[i].center_m, groups[i].center_m, groups[i].surface_m2(), {}, {}});
    objects.back().*points = groups[i].points;
  }
}

/// Appends the points of a visit, those that changed in `tint` with some of their brightness.
void append(const ColoredCloud& cloud, const std::vector<PointChange>& changes, const Rgb& tint,
            ColoredCloud& all) {
  for (size_t i = 0; i < cloud.size(); ++i) {
    all.points.push_back(cloud.points[i]);
    if (!cloud.normals.empty()) all.normals.push_back(cloud.normals[i]);
    const Rgb& color = cloud.colors[i];
    all.colors.push_back(changes[i] == PointChange::kChanged ? tinted(color, tint) : gray_of(color));
  }
}

json position(const Eigen::Vector3d& p_file) {
  json coordinates = json::array();
  for (const double value : p_file) coordinates.push_back(rounded_number(value, kMmPerM));
  return coordinates;
}

json counts(const std::vector<PointChange>& changes, const char* changed) {
  const auto count = [&](PointChange change) { return std::ranges::count(changes, change); };
  return {{"points", changes.size()},
          {"same", count(PointChange::kSame)},
          {changed, count(PointChange::kChanged)},
          {"unseen", count(PointChange::kUnseen)}};
}

}  // namespace

const char* to_string(ObjectChange change) {
  switch (change) {
    case ObjectChange::kGone:
      return "gone";
    case ObjectChange::kAdded:
      return "added";
    case ObjectChange::kMoved:
      return "moved";
  }
  return "";
}

MapDifference compare_visits_of_place(const Visit& before, const Visit& after,
                                      const ComparisonOptions& options, const Progress& progress) {
  MapDifference difference;
  difference.before = compare_points(before.cloud, after.views, options, progress);
  difference.after = compare_points(after.cloud, before.views, options, progress);
  const auto gone = group_changed_points(before.cloud, difference.before);
  const auto added = group_changed_points(after.cloud, difference.after);
  const auto moved = find_moved(gone, added);
  for (const MovedPair& pair : moved) {
    const PointGroup &from = gone[pair.before], &to = added[pair.after];
    difference.objects.push_back(
        {ObjectChange::kMoved, from.center_m, to.center_m, from.surface_m2(), from.points, to.points});
  }
  add_unpaired(ObjectChange::kGone, gone, moved, &MovedPair::before, &ChangedObject::points_before,
               difference.objects);
  add_unpaired(ObjectChange::kAdded, added, moved, &MovedPair::after, &ChangedObject::points_after,
               difference.objects);
  return difference;
}

Rgb gray_of(const Rgb& color) {
  constexpr int kRed = 77, kGreen = 150, kBlue = 29, kSum = 256;  // luma of BT.601
  const auto gray = static_cast<uint8_t>((kRed * color[0] + kGreen * color[1] + kBlue * color[2]) / kSum);
  return {gray, gray, gray};
}

Rgb tinted(const Rgb& color, const Rgb& tint) {
  Rgb mixed = gray_of(color);
  for (size_t c = 0; c < mixed.size(); ++c) mixed[c] = static_cast<uint8_t>((3 * tint[c] + mixed[c]) / 4);
  return mixed;
}

ColoredCloud color_difference(const ColoredCloud& before, const ColoredCloud& after,
                              const MapDifference& difference) {
  ColoredCloud all;
  append(before, difference.before, kGoneColor, all);
  append(after, difference.after, kAddedColor, all);
  return all;
}

json to_json(const MapDifference& difference, const Eigen::Quaterniond& R_file_world) {
  json objects = json::array();
  for (const ChangedObject& object : difference.objects) {
    json entry = {{"change", to_string(object.change)},
                  {"center_m", position(R_file_world * object.center_m)},
                  {"surface_m2", rounded_number(object.surface_m2)}};
    if (object.change == ObjectChange::kMoved) {
      entry["moved_to_m"] = position(R_file_world * object.moved_to_m);
      entry["moved_by_m"] = rounded_number((object.moved_to_m - object.center_m).norm(), kMmPerM);
    }
    objects.push_back(entry);
  }
  return {{"before", counts(difference.before, "gone")},
          {"after", counts(difference.after, "added")},
          {"objects", objects}};
}

}  // namespace kinloop
