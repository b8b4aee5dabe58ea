#pragma once
// In: the cloud of one visit and the posed depth images of another. Out: which points the other visit
// contradicts.

#include <span>

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

}  // namespace kinloop
