#pragma once
// In: the size of a room, a palette and the path of the camera in it. Out: walls, furniture and lamps that
// keep clear of the path.

#include <optional>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "kinloop/geometry/trajectory.hpp"
#include "simulator/render/lighting.hpp"
#include "simulator/room/furniture.hpp"

namespace kinloop::sim {

/// Minimum distance of any part of a room from the camera.
constexpr double kPathClearance_m = 0.3;

/// Where a room has its door. Positions are in the frame of its wall: x along it, y outwards, z up, with the
/// origin `wall_distance_m` from the middle of the room.
struct DoorPlace {
  float wall_yaw_rad = 0, wall_distance_m = 0;
  float along_m = 0, width_m = 0, height_m = 0;  ///< of the door
  size_t wall_part = 0, board_part = 0;          ///< the solids of the wall and of its skirting board
  size_t first_part = 0, part_count = 0;         ///< the solids of the door and of what hangs on it
};

/// How much stands away from the walls. A corridor has nothing but doors and notice boards, the same every
/// `kCorridorPeriod_m`.
enum class Furnishing { kDense, kSpacious, kCorridor };

constexpr float kCorridorPeriod_m = 4;

/// Furnishes one room.
class RoomLayout {
 public:
  /// `path`: camera poses in the room frame. Rooms of one seed on two floors of a building differ in their
  /// pictures and in what lies on the floor.
  RoomLayout(const Palette& palette, const Eigen::Vector3f& size_m, const Trajectory& path, uint64_t seed,
             Furnishing furnishing = Furnishing::kDense, uint64_t floor = 0);

  Parts release_parts() { return std::move(parts_); }
  [[nodiscard]] const std::vector<Light>& lights() const { return lights_; }
  [[nodiscard]] const DoorPlace& door() const { return door_; }

 private:
  /// A wall seen from inside: `along` points right; furniture backs stand against it.
  struct Wall {
    float yaw_rad;
    float length_m;
    float distance_m;                          ///< from the middle of the room
    std::vector<Eigen::AlignedBox2f> covered;  ///< (along, z) occupied by furniture and pictures
    size_t first_part;                         ///< its solid; that of the skirting board follows
  };

  [[nodiscard]] size_t least_viewed_wall() const;
  void build_shell();
  void add_ceiling_lamps();
  void add_window(Wall& wall);
  void add_door(Wall& wall);
  [[nodiscard]] Parts door_leaf();
  void line_with_doors(Wall& wall, const Parts& door, const Parts& board);
  void furnish_corridor();
  void furnish_room(std::optional<uint64_t> floor_seed);
  void furnish_wall(Wall& wall);
  void hang_pictures(Wall& wall);
  void furnish_viewed_areas();
  void scatter_on_floor();

  [[nodiscard]] Parts place_at_wall(const Wall& wall, Parts piece, float along_m, float z) const;
  [[nodiscard]] bool is_free(const Parts& piece, double margin_m = kPathClearance_m) const;
  [[nodiscard]] bool clear_of_path(const Parts& piece, double margin_m = kPathClearance_m) const;
  bool try_place_at_wall(Wall& wall, const Parts& piece, float along_m);
  void add_floor_piece(const Parts& piece);
  [[nodiscard]] cv::Mat view_count_integral() const;
  [[nodiscard]] Parts place_where_most_viewed(const Parts& piece, const cv::Mat& sums) const;
  Parts wall_piece();

  Random random_;
  FurnitureBuilder builder_;
  Eigen::Vector3f size_m_;
  Furnishing furnishing_;
  std::vector<Eigen::Vector3f> path_, view_;  ///< camera positions and optical axes
  std::vector<Wall> walls_;
  std::vector<Eigen::AlignedBox2f> footprints_;
  Parts parts_;
  DoorPlace door_;
  std::vector<Light> lights_;
};

}  // namespace kinloop::sim
