#pragma once
// In: the free floor of a room and the path of the camera. Out: walks that keep clear of furniture, of the
// camera and of each other.

#include <vector>

#include <opencv2/core/mat.hpp>

#include "kinloop/core/random.hpp"
#include "simulator/camera_path.hpp"
#include "simulator/movers/people/walk.hpp"
#include "simulator/room/furniture.hpp"

namespace kinloop::sim {

/// The free part of a floor, on a grid.
class FreeFloor {
 public:
  /// `radius_m` is kept from everything between ankle and head, and from the walls.
  FreeFloor(const Parts& room, const Eigen::Vector3f& size_m, float radius_m);

  /// Takes a rectangle, grown by the radius, from the free floor.
  void block(const Eigen::AlignedBox2f& area);

  [[nodiscard]] bool is_free(const Eigen::Vector2d& p) const;

  /// Returns whether the straight way is free.
  [[nodiscard]] bool is_free(const Eigen::Vector2d& from, const Eigen::Vector2d& to) const;

  /// Returns the middles of the cells of the largest connected free region.
  [[nodiscard]] std::vector<Eigen::Vector2d> largest_region() const;

  static constexpr double kCell_m = 0.1;

 private:
  [[nodiscard]] cv::Point cell_of(const Eigen::Vector2d& p) const;

  Eigen::Vector2d half_;  ///< of the room, m
  double radius_m_;
  cv::Mat free_;  ///< 8UC1, 255 = free
};

/// The camera on the floor plan at one time.
struct FloorView {
  Eigen::Vector2d position, direction;  ///< m; unit vector, or zero for a camera that looks up or down
};

/// The camera on the floor plan at regular times.
struct FloorTrack {
  std::vector<FloorView> views;  ///< every `kStep_s` from the first pose on, at least one

  static constexpr double kStep_s = 0.1;

  /// Returns the view nearest to a time since the first pose.
  [[nodiscard]] const FloorView& at(double time_s) const;
  [[nodiscard]] double seconds() const { return kStep_s * static_cast<double>(views.size() - 1); }
};

/// Samples a path in the room frame.
FloorTrack floor_track(const CameraPath& path);

/// Returns whether a thing at `p` is in front of the camera and within the range of depth sensors.
bool in_view(const FloorView& camera, const Eigen::Vector2d& p);

/// Plans a walk as long as the track: straight ways at 0.8 to 1.4 m/s, turns and pauses. Of the next places
/// it takes one that the camera sees the walker go to, unless that is too close to the camera or to one of
/// `others`. Throws InputError if there is no free floor.
Walk plan_walk(const FreeFloor& floor, const FloorTrack& camera, const std::vector<Walk>& others,
               Random& random);

}  // namespace kinloop::sim
