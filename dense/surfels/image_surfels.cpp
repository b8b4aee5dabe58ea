#include "dense/surfels/image_surfels.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include <opencv2/imgproc.hpp>

#include "dense/rounded.hpp"
#include "dense/sharpness.hpp"
#include "dense/usable_depth.hpp"
#include "kinloop/core/errors.hpp"

namespace kinloop {
namespace {

/// Distance of the pixels from which a slope is measured: short enough for small objects, long enough to
/// suppress noise.
constexpr int kSlopeReachPx = 6;

/// Inverse depth; 0 = unknown.
cv::Mat inverse(const cv::Mat& depth_m) {
  constexpr float kFar = std::numeric_limits<float>::infinity();
  cv::Mat result(depth_m.size(), CV_32FC1);
  for (int row = 0; row < depth_m.rows; ++row) {
    const auto* depths = depth_m.ptr<float>(row);
    auto* inverses = result.ptr<float>(row);
    const int cols = depth_m.cols;  // two loops, since the compiler vectorises them and not their combination
    for (int col = 0; col < cols; ++col) inverses[col] = depths[col] > 0 ? depths[col] : kFar;
    for (int col = 0; col < cols; ++col) inverses[col] = 1 / inverses[col];
  }
  return result;
}

/// Applies `function` to every pixel.
template <class Function>
void apply(cv::Mat& image, const Function& function) {
  for (int row = 0; row < image.rows; ++row) {
    auto* values = image.ptr<float>(row);
    for (int col = 0; col < image.cols; ++col) values[col] = function(values[col]);
  }
}

/// A plane is linear in inverse depth, and the noise of a sensor that triangulates is constant there (see
/// DepthNoise): a bilateral filter (Tomasi and Manduchi 1998) removes noise and preserves planes and edges.
/// That of time of flight is constant in atan(crossover * inverse depth) / crossover, where a plane is nearly
/// linear over a few pixels.
cv::Mat smoothed(const cv::Mat& inverse_depth, const DepthNoise& noise) {
  constexpr int kDiameterPx = 5;
  constexpr double kSigmaPx = 2;
  const auto crossover_m = static_cast<float>(noise.crossover_m);
  cv::Mat evened = inverse_depth, result;
  if (crossover_m > 0) {
    evened = inverse_depth.clone();
    apply(evened, [=](float value) { return std::atan(crossover_m * value) / crossover_m; });
  }
  cv::bilateralFilter(evened, result, kDiameterPx, 2.5 * noise.coefficient_per_m, kSigmaPx,
                      cv::BORDER_REPLICATE);
  if (crossover_m > 0) {
    apply(result, [=](float value) { return std::tan(crossover_m * value) / crossover_m; });
  }
  return result;
}

/// As many as positions of 16 bits allow.
int pixel_steps_of(const cv::Size& size) {
  constexpr int kPositions = std::numeric_limits<uint16_t>::max() + 1;
  int steps = ImageSurfels{}.pixel_steps;
  while (std::max(size.width, size.height) * steps > kPositions) steps /= 2;
  return steps;
}

/// Sums over the usable pixels of a block.
struct BlockSums {
  float inverse_depth = 0;
  int count = 0, rows = 0, cols = 0;
  int blue = 0, green = 0, red = 0;

  /// Adds a pixel if it is usable; without branches, since which pixels are is hard to predict.
  void add(int row, int col, bool usable, float inverse, const uint8_t* bgr) {
    const int one = static_cast<int>(usable);
    inverse_depth += usable ? inverse : 0;
    count += one;
    rows += one * row;
    cols += one * col;
    blue += one * bgr[0];
    green += one * bgr[1];
    red += one * bgr[2];
  }
};

/// Extracts the surfels of one image.
class SurfelExtractor {
 public:
  SurfelExtractor(const RgbdImages& images, const cv::Mat& inverse_depth, const SurfelCamera& camera,
                  const DenseOptions& options)
      : color_(images.color),
        pixel_steps_(pixel_steps_of(images.color.size())),
        focal_px_(camera.focal_px),
        voxel_m_(options.voxel_m),
        max_slope_(static_cast<float>(std::tan(options.limits.max_incidence_deg * M_PI / 180) *
                                      kSlopeReachPx / camera.focal_px)),
        inverse_depth_(smoothed(inverse_depth, camera.noise)),
        usable_(usable_pixels(images.depth_m, camera.focal_px, options.limits)) {}

  std::vector<Surfel> run() {
    points_.reserve(color_.total() / 4);
    for (int row = 0; row + kTilePx <= color_.rows; row += kTilePx) {
      for (int col = 0; col + kTilePx <= color_.cols; col += kTilePx) add_tile(row, col);
    }
    points_.shrink_to_fit();
    return std::move(points_);
  }

 private:
  /// Splits a tile if its surfel would be wider than a voxel, which would leave voxels between surfels empty.
  void add_tile(int row, int col) {
    const float nearest = nearest_in(row, col);
    if (!(nearest > 0)) return;
    const double z = 1 / static_cast<double>(nearest);
    const double most_px = voxel_m_ * focal_px_ / z;
    if (most_px >= 4) return add_blocks<4>(row, col);
    if (most_px >= 2) return add_blocks<2>(row, col);
    add_blocks<1>(row, col);
  }

  [[nodiscard]] float nearest_in(int row, int col) const {
    float nearest = 0;
    for (int r = row; r < row + kTilePx; ++r) {
      const auto* usable = usable_.ptr<uint8_t>(r) + col;
      const auto* inverses = inverse_depth_.ptr<float>(r) + col;
      for (int c = 0; c < kTilePx; ++c) nearest = std::max(nearest, usable[c] != 0 ? inverses[c] : 0);
    }
    return nearest;
  }

  template <int kSide>
  void add_blocks(int row, int col) {
    for (int r = row; r < row + kTilePx; r += kSide) {
      for (int c = col; c < col + kTilePx; c += kSide) add_block<kSide>(r, c);
    }
  }

  template <int kSide>
  void add_block(int row, int col) {
    BlockSums sums;
    for (int r = row; r < row + kSide; ++r) {
      const auto* usable = usable_.ptr<uint8_t>(r);
      const auto* inverses = inverse_depth_.ptr<float>(r);
      const auto* bgr = color_.ptr<uint8_t>(r);
      for (int c = col; c < col + kSide; ++c) sums.add(r, c, usable[c] != 0, inverses[c], bgr + 3 * c);
    }
    // Most blocks are complete: then the division is a shift.
    constexpr int kAll = kSide * kSide;
    if (sums.count == kAll) return add_surfel<kAll>(sums);
    if (sums.count > 0) add_surfel<0>(sums);
  }

  /// `kCount` is the number of pixels, or 0 if it is known only at run time.
  template <int kCount>
  void add_surfel(const BlockSums& sums) {
    const int count = kCount != 0 ? kCount : sums.count;
    const auto mean = [=](int sum) { return (sum + count / 2) / count; };
    const auto place = [&](int sum) { return static_cast<uint16_t>(mean(sum * pixel_steps_)); };
    const auto channel = [&](int sum) { return static_cast<uint8_t>(mean(sum)); };
    const int row = sums.rows / count, col = sums.cols / count;
    points_.push_back({sums.inverse_depth / static_cast<float>(count),
                       place(sums.cols),
                       place(sums.rows),
                       {channel(sums.red), channel(sums.green), channel(sums.blue)},
                       static_cast<uint8_t>(count),
                       slope(row, col, 0, kSlopeReachPx),
                       slope(row, col, kSlopeReachPx, 0)});
  }

  /// Relative change of inverse depth along a direction in the image, on the same surface.
  [[nodiscard]] int8_t slope(int row, int col, int down, int right) const {
    const float here = inverse_depth_.at<float>(row, col);
    if (!(here > 0)) return 0;
    float change = 0;
    int steps = 0;
    for (const int side : {-1, 1}) {
      const int r = row + side * down, c = col + side * right;
      if (r < 0 || c < 0 || r >= usable_.rows || c >= usable_.cols || usable_.at<uint8_t>(r, c) == 0)
        continue;
      const float other = inverse_depth_.at<float>(r, c);
      if (std::abs(other - here) > max_slope_ * here) continue;
      change += static_cast<float>(side) * (other - here);
      steps += kSlopeReachPx;
    }
    if (steps == 0) return 0;
    const float relative = change / static_cast<float>(steps) * static_cast<float>(focal_px_) / here;
    constexpr auto kMaxCount = static_cast<float>(std::numeric_limits<int8_t>::max());
    return static_cast<int8_t>(rounded(std::clamp(relative * kSlopeSteps, -kMaxCount, kMaxCount)));
  }

  const cv::Mat& color_;
  int pixel_steps_;
  double focal_px_, voxel_m_;
  float max_slope_;
  cv::Mat inverse_depth_, usable_;
  std::vector<Surfel> points_;
};

/// The nearest depth of every tile, in the units of ImageSurfels.
std::vector<uint16_t> nearest_depths(const cv::Mat& inverse_depth) {
  constexpr auto kMaxCount = static_cast<float>(std::numeric_limits<uint16_t>::max());
  std::vector<uint16_t> nearest;
  for (int row = 0; row + kTilePx <= inverse_depth.rows; row += kTilePx) {
    for (int col = 0; col + kTilePx <= inverse_depth.cols; col += kTilePx) {
      float most = 0, least = kMaxCount;
      for (int r = row; r < row + kTilePx; ++r) {
        const auto* values = inverse_depth.ptr<float>(r) + col;
        most = std::max(most, *std::max_element(values, values + kTilePx));
        least = std::min(least, *std::min_element(values, values + kTilePx));
      }
      const float steps = most / static_cast<float>(kTileStep_per_m);
      nearest.push_back(least > 0 && steps < kMaxCount ? static_cast<uint16_t>(steps) : uint16_t{0});
    }
  }
  return nearest;
}

/// Header of the serialised surfels.
struct Header {
  float sharpness = 0;
  int32_t pixel_steps = 0;
  uint32_t points = 0, tiles = 0;
};

/// An image may have no surfels, and memcpy takes no null pointer.
void copy_bytes(const void* from, size_t count, void* to) {
  if (count > 0) std::memcpy(to, from, count);
}

}  // namespace

ImageSurfels extract_surfels(const RgbdImages& images, const SurfelCamera& camera,
                             const DenseOptions& options) {
  require(images.color.type() == CV_8UC3 && images.depth_m.type() == CV_32FC1 &&
              images.color.size() == images.depth_m.size(),
          "extract_surfels: expected colour 8UC3 and depth 32FC1 of the same size");
  const cv::Mat inverse_depth = inverse(images.depth_m);
  return {image_sharpness(images.color), pixel_steps_of(images.color.size()),
          SurfelExtractor(images, inverse_depth, camera, options).run(), nearest_depths(inverse_depth)};
}

ImageSurfels thinned(const ImageSurfels& surfels, size_t max_points) {
  ImageSurfels some{surfels.sharpness, surfels.pixel_steps, {}, {}};
  const size_t step = surfels.points.size() / max_points + 1;
  for (size_t i = 0; i < surfels.points.size(); i += step) some.points.push_back(surfels.points[i]);
  return some;
}

std::vector<uint8_t> to_bytes(const ImageSurfels& surfels) {
  const Header header{surfels.sharpness, surfels.pixel_steps, static_cast<uint32_t>(surfels.points.size()),
                      static_cast<uint32_t>(surfels.nearest.size())};
  const size_t point_bytes = surfels.points.size() * sizeof(Surfel);
  const size_t tile_bytes = surfels.nearest.size() * sizeof(uint16_t);
  std::vector<uint8_t> bytes(sizeof(Header) + point_bytes + tile_bytes);
  std::memcpy(bytes.data(), &header, sizeof(Header));
  copy_bytes(surfels.points.data(), point_bytes, bytes.data() + sizeof(Header));
  copy_bytes(surfels.nearest.data(), tile_bytes, bytes.data() + sizeof(Header) + point_bytes);
  return bytes;
}

ImageSurfels surfels_from_bytes(std::span<const uint8_t> bytes) {
  Header header;
  require(bytes.size() >= sizeof(Header), "surfels_from_bytes: too short");
  std::memcpy(&header, bytes.data(), sizeof(Header));
  ImageSurfels surfels{header.sharpness, header.pixel_steps, std::vector<Surfel>(header.points),
                       std::vector<uint16_t>(header.tiles)};
  const size_t point_bytes = surfels.points.size() * sizeof(Surfel);
  const size_t tile_bytes = surfels.nearest.size() * sizeof(uint16_t);
  require(bytes.size() == sizeof(Header) + point_bytes + tile_bytes, "surfels_from_bytes: invalid data");
  copy_bytes(bytes.data() + sizeof(Header), point_bytes, surfels.points.data());
  copy_bytes(bytes.data() + sizeof(Header) + point_bytes, tile_bytes, surfels.nearest.data());
  return surfels;
}

}  // namespace kinloop
