#pragma once
// In: two visits of a place in one frame. Out: what is gone, what was added and what was moved; as JSON and
// as a coloured cloud.

#include <span>

#include <nlohmann/json_fwd.hpp>

#include "dense/cloud/colored_cloud.hpp"
#include "dense/image_store.hpp"
#include "dense/options.hpp"
#include "dense/posed_image.hpp"
#include "kinloop/core/progress.hpp"

namespace kinloop {

enum class PointChange : uint8_t {
  kUnseen,   ///< the other visit did not look there
  kSame,     ///< it measured the surface
  kChanged,  ///< it saw through the place
};

/// The depth images of one visit.
struct VisitViews {
  const ImageStore& images;
  std::span<const PosedImage> views;
};

struct ComparisonOptions {
  DenseCamera camera;  ///< of both visits
  DepthLimits limits = {};
  double voxel_m = 0.01;  ///< of the clouds
  int threads = 1;
};

/// Returns for each point of `cloud` (world frame) what `other` says of it. A view sees through a point if
/// every pixel around it measured something clearly farther; at least two views must, or the only one, and
/// more than measured the surface there. Views are left out once `progress` asks to end.
std::vector<PointChange> compare_points(const ColoredCloud& cloud, const VisitViews& other,
                                        const ComparisonOptions& options, const Progress& progress = {});

/// Edge of the voxels in which changed points are grouped.
constexpr double kGroupVoxel_m = 0.05;

/// Points of one visit that changed and are connected.
struct PointGroup {
  std::vector<uint32_t> points;                        ///< indices into the cloud
  size_t voxels = 0;                                   ///< occupied, of kGroupVoxel_m
  Eigen::Vector3d center_m = Eigen::Vector3d::Zero();  ///< mean of the points, world
  Eigen::Vector3d spread_m = Eigen::Vector3d::Zero();  ///< standard deviations along its axes, largest first
  Eigen::Vector3d color = Eigen::Vector3d::Zero();     ///< mean red, green, blue, 0 to 255

  /// Returns about the size of the surface.
  [[nodiscard]] double surface_m2() const {
    return static_cast<double>(voxels) * (kGroupVoxel_m * kGroupVoxel_m);
  }
};

/// Returns the groups of at least some 300 cm^2, the largest first.
std::vector<PointGroup> group_changed_points(const ColoredCloud& cloud,
                                             const std::vector<PointChange>& changes);

/// A group before and one after that look like the same object.
struct MovedPair {
  size_t before = 0, after = 0;  ///< indices into the groups
};

/// Pairs groups of similar size, shape and colour, each at most once, the most alike first.
std::vector<MovedPair> find_moved(const std::vector<PointGroup>& before,
                                  const std::vector<PointGroup>& after);

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
