#pragma once
// In: posed depth images. Out: free, occupied and unknown space for robots: an OctoMap (Hornung et al. 2013)
// and a 2D grid of the floor. The frame is z up with the floor at z = 0. The self-calibrated corrections of
// lens and depth are not applied, since they are smaller than a cell.

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "dense/image_store.hpp"
#include "dense/options.hpp"
#include "dense/posed_image.hpp"
#include "kinloop/core/progress.hpp"

namespace kinloop {

/// Returns whether this build has OctoMap.
bool occupancy_available();

/// State of a floor cell.
enum class Occupancy : uint8_t { kUnknown, kFree, kOccupied };

/// The floor seen from above, row-major: cell (0, 0) has the smallest x and y, x runs first.
struct OccupancyGrid {
  double cell_m = 0;
  double origin_x_m = 0, origin_y_m = 0;  ///< of the corner of cell (0, 0)
  int width = 0, height = 0;
  std::vector<Occupancy> cells;
};

/// Pose of the floor.
struct Floor {
  SE3 T_floor_world;  ///< to a frame with z up, the floor at z = 0 and the first camera above the origin
};

/// Finds the lowest surface with more than chance support, given the up direction `up`.
Floor find_floor(const ImageStore& images, std::span<const PosedImage> views, const PinholeCamera& camera,
                 const Eigen::Vector3d& up, const OccupancyOptions& options);

class OccupancyMap {
 public:
  /// Throws UsageError if the build has no OctoMap.
  OccupancyMap(const ImageStore& images, std::span<const PosedImage> views, const PinholeCamera& camera,
               const Floor& floor, const OccupancyOptions& options, const Progress& progress = {});
  ~OccupancyMap();
  OccupancyMap(const OccupancyMap&) = delete;
  OccupancyMap& operator=(const OccupancyMap&) = delete;

  /// Content of a .bt file: free and occupied only.
  [[nodiscard]] std::string serialize_binary() const;

  /// Content of an .ot file, with probabilities.
  [[nodiscard]] std::string serialize_full() const;

  /// Returns the obstacles within the height range of the options.
  [[nodiscard]] OccupancyGrid grid() const;

 private:
  struct Tree;

  OccupancyOptions options_;
  std::unique_ptr<Tree> tree_;
};

}  // namespace kinloop
