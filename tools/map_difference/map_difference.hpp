#pragma once
// In: two visits of a place in one frame. Out: what is gone, what was added and what was moved; as JSON and
// as a coloured cloud.

#include <nlohmann/json_fwd.hpp>

#include "tools/map_difference/changed_objects.hpp"

namespace kinloop {

/// A visit: its cloud (world frame), and the depth images that it was fused from.
struct Visit {
  const ColoredCloud& cloud;
  VisitViews views;
};

/// What happened to an object between the visits.
enum class ObjectChange { kGone, kAdded, kMoved };

/// Returns "gone", "added" or "moved".
const char* to_string(ObjectChange change);

struct ChangedObject {
  ObjectChange change = ObjectChange::kGone;
  /// Mean of its observed surface, world; before the change, and after it if the object was moved.
  Eigen::Vector3d center_m = Eigen::Vector3d::Zero(), moved_to_m = Eigen::Vector3d::Zero();
  double surface_m2 = 0;  ///< observed, roughly
  /// Its points: indices into the cloud before, if it was there, and into that after, if it is there now.
  std::vector<uint32_t> points_before, points_after;
};

struct MapDifference {
  std::vector<PointChange> before, after;  ///< for each point of the clouds
  std::vector<ChangedObject> objects;      ///< moved, gone, added; each the largest first
};

MapDifference compare_visits_of_place(const Visit& before, const Visit& after,
                                      const ComparisonOptions& options, const Progress& progress = {});

/// Returns both clouds as one: in red what is gone, in green what was added, and the rest in grey.
ColoredCloud color_difference(const ColoredCloud& before, const ColoredCloud& after,
                              const MapDifference& difference);

constexpr Rgb kGoneColor = {220, 40, 40}, kAddedColor = {30, 170, 80};

/// Returns `color` as grey of the same brightness.
Rgb gray_of(const Rgb& color);

/// Returns `tint` with some of the brightness of `color`.
Rgb tinted(const Rgb& color, const Rgb& tint);

/// The numbers; positions are rotated by `R_file_world`.
nlohmann::json to_json(const MapDifference& difference, const Eigen::Quaterniond& R_file_world);

}  // namespace kinloop
