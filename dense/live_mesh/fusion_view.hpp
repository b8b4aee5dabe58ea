#pragma once
// In: the images of a view. Out: what its fusion needs of them.

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "dense/cloud/colored_cloud.hpp"
#include "dense/image_store.hpp"
#include "dense/options.hpp"
#include "dense/posed_image.hpp"

namespace kinloop {

/// Factors for red, green and blue.
using ColorGain = Eigen::Array3f;

/// The colour of one surface in a view and in the mesh.
struct ColorPair {
  Rgb view{}, mesh{};
};

/// Returns the factors that make up for the exposure and white balance of a view: they take its colours to
/// those of the mesh, each the median over the pairs; nullopt if too few are well exposed. At most 3, at
/// least 1/3: more is not the exposure. (dense/cloud/color_gains solves for all views together instead.)
std::optional<ColorGain> view_gain(const std::vector<ColorPair>& pairs);

/// The images of an ideal camera, and how it moved.
struct FusionView {
  DenseCamera camera;
  Velocity velocity = {};               ///< in camera axes
  double depth_stamp_difference_s = 0;  ///< PosedImage::depth_stamp_difference_s
  cv::Mat color;                        ///< 8UC3, BGR
  ColorGain color_gain = ColorGain::Ones();
  /// 32FC1, m: positive where a pixel may define a surface, negative where it only tells of free space (at
  /// depth edges it may be a mean of both sides), 0 where nothing is known.
  cv::Mat depth_m;

  /// Returns how long after the stamp of colour the depth of a row was measured.
  [[nodiscard]] double lag_s(double row) const {
    return depth_stamp_difference_s + camera.time_of_row_s(row);
  }
};

/// Makes a view of raw images. `raw_pixels` as of undistortion_of.
FusionView make_fusion_view(const RgbdImages& images, const DenseCamera& camera, const cv::Mat& raw_pixels,
                            const DepthLimits& limits);

/// Returns points of the surfaces in view, one per `stride_px` squared pixels, in camera axes at the stamp.
std::vector<Eigen::Vector3f> sampled_surface(const FusionView& view, int stride_px);

/// Returns the colour of the image at a point in camera axes; nullopt outside.
std::optional<Rgb> color_at(const FusionView& view, const Eigen::Vector3f& p_camera);

/// The least and the greatest depth in squares of pixels.
class DepthTiles {
 public:
  struct Range {
    float nearest_m, farthest_m;  ///< nearest > farthest: no depth is known
  };

  explicit DepthTiles(const cv::Mat& depth_m);

  /// Returns the range in a rectangle of pixels inside the image, or in one that is slightly larger.
  [[nodiscard]] Range range(const cv::Rect& pixels) const;

 private:
  [[nodiscard]] size_t index(int row, int col) const {
    return static_cast<size_t>(row) * static_cast<size_t>(columns_) + static_cast<size_t>(col);
  }

  int columns_ = 0;
  std::vector<Range> tiles_;
};

}  // namespace kinloop
