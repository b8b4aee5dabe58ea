#pragma once
// In: the solids of a room. Out: where on its floor somebody of a given radius can stand and walk.

#include <vector>

#include <opencv2/core/mat.hpp>

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

}  // namespace kinloop::sim
