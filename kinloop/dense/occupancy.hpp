#pragma once
// In: posed depth images. Out: which parts of space are free, occupied or unknown, for robots: an OctoMap
// (Hornung et al. 2013), and a grid of the floor. z is up and the floor at 0: a robot's world, not the
// camera's. Cells are wider than what self-calibration finds of lens and depth, which is left out.

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "kinloop/base/progress.hpp"
#include "kinloop/dense/image_store.hpp"
#include "kinloop/dense/options.hpp"
#include "kinloop/dense/posed_image.hpp"

namespace kinloop {

/// Whether this build has OctoMap.
bool occupancy_available();

/// What is known of a patch of floor.
enum class Occupancy : uint8_t { kUnknown, kFree, kOccupied };

/// The floor from above: cell (0, 0) has the smallest x and y, x runs first.
struct OccupancyGrid {
  double cell_m = 0;
  double origin_x_m = 0, origin_y_m = 0;  ///< of the corner of cell (0, 0)
  int width = 0, height = 0;
  std::vector<Occupancy> cells;
};

/// Where the floor is, in the frame of the world.
struct Floor {
  SE3 T_floor_world;  ///< to a frame with z up, the floor at z = 0 and the first camera above the origin
};

/// The floor under what the views saw: the lowest that is seen more than by chance, `up` pointing up.
Floor find_floor(const ImageStore& images, std::span<const PosedImage> views, const PinholeCamera& camera,
                 const Eigen::Vector3d& up, const OccupancyOptions& options);

class OccupancyMap {
 public:
  /// Throws UsageError where this build has no OctoMap.
  OccupancyMap(const ImageStore& images, std::span<const PosedImage> views, const PinholeCamera& camera,
               const Floor& floor, const OccupancyOptions& options, const Progress& progress = {});
  ~OccupancyMap();
  OccupancyMap(const OccupancyMap&) = delete;
  OccupancyMap& operator=(const OccupancyMap&) = delete;

  /// A .bt file: free and occupied alone.
  [[nodiscard]] std::string serialize_binary() const;

  /// An .ot file: with probabilities.
  [[nodiscard]] std::string serialize_full() const;

  /// What stands in a robot's way between the heights of the options.
  [[nodiscard]] OccupancyGrid grid() const;

 private:
  struct Tree;

  OccupancyOptions options_;
  std::unique_ptr<Tree> tree_;
};

}  // namespace kinloop
