#include "dense/cloud/point_colors.hpp"

#include <algorithm>
#include <cmath>

#include "dense/sharpness.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/threads/parallel_for.hpp"

namespace kinloop {
namespace {

/// Largest difference between a point and the measured depth at its pixel, relative to that depth; beyond it
/// the point is occluded or another surface.
constexpr float kSameSurface = 0.02F;

/// An image used for colouring.
struct ColoringImage {
  RgbdImages images;
  SE3 T_camera_world;
  Velocity velocity;
  float sharpness = 0;
  Eigen::Vector3f gain_bgr = Eigen::Vector3f::Ones();
};

/// Sum of colours (blue, green, red) and of their weights.
using ColorSum = Eigen::Vector4f;

/// Bilinear interpolation of colour.
Eigen::Vector3f sample(const cv::Mat& color, const Eigen::Vector2d& pixel) {
  const int col = static_cast<int>(pixel.x()), row = static_cast<int>(pixel.y());
  const auto right = static_cast<float>(pixel.x() - col), down = static_cast<float>(pixel.y() - row);
  const auto at = [&](int r, int c) {
    const auto& bgr = color.at<cv::Vec3b>(r, c);
    return Eigen::Vector3f(bgr[0], bgr[1], bgr[2]);
  };
  return (1 - down) * ((1 - right) * at(row, col) + right * at(row, col + 1)) +
         down * ((1 - right) * at(row + 1, col) + right * at(row + 1, col + 1));
}

/// Weighted colour of a point in one image; weight 0 if the point is not visible.
ColorSum observe_color(const ColoringImage& photo, const Eigen::Vector3f& point,
                       const Eigen::Vector3f& normal, const DenseCamera& camera) {
  const Eigen::Vector3d p = photo.T_camera_world * point.cast<double>();
  if (!(p.z() > 0)) return ColorSum::Zero();
  if (!camera.color.contains(camera.color.project(p))) return ColorSum::Zero();
  const Eigen::Vector2d pixel = camera.raw_color_pixel(p, photo.velocity);
  if (!camera.color.contains(pixel, 2)) return ColorSum::Zero();
  const auto z = static_cast<float>(p.z());
  const float depth_m = photo.images.depth_m.at<float>(static_cast<int>(std::lround(pixel.y())),
                                                       static_cast<int>(std::lround(pixel.x())));
  if (!(std::abs(depth_m - z) < kSameSurface * z)) return ColorSum::Zero();
  const Eigen::Vector3d n = photo.T_camera_world.rotation * normal.cast<double>();
  const auto frontal = static_cast<float>(-n.dot(p.normalized()));
  if (!(frontal > 0)) return ColorSum::Zero();
  // Pixels per square metre of surface. The fourth power makes the best few images dominate.
  const float detail = photo.sharpness * frontal / (z * z);
  const Eigen::Vector3f measured = sample(photo.images.color, pixel);
  // Clipped intensities have lost their colour; they count only if no image is better.
  const float exposed = measured.maxCoeff() < kSaturatedIntensity ? 1 : 1e-3F;
  const float weight = exposed * detail * detail * detail * detail;
  const Eigen::Vector3f color = weight * measured.cwiseProduct(photo.gain_bgr);
  return {color.x(), color.y(), color.z(), weight};
}

std::optional<Rgb> color_of(const ColorSum& sum) {
  if (!(sum.w() > 0)) return std::nullopt;
  const auto channel = [&](int i) {
    return static_cast<uint8_t>(std::clamp(std::lround(sum(i) / sum.w()), 0L, 255L));
  };
  return Rgb{channel(2), channel(1), channel(0)};
}

}  // namespace

std::vector<std::optional<Rgb>> observed_colors(std::span<const Eigen::Vector3f> points,
                                                std::span<const Eigen::Vector3f> normals,
                                                const StoredViews& stored, int threads,
                                                const Progress& progress) {
  require(points.size() == normals.size(), "observed_colors: expected one normal per point");
  const std::span<const PosedImage> views = stored.views;
  std::vector<ColorSum> sums(points.size(), ColorSum::Zero());
  const auto batch_size = static_cast<size_t>(std::max(threads, 1));
  std::vector<ColoringImage> batch(batch_size);
  for (size_t first = 0; first < views.size(); first += batch_size) {
    if (!report(progress, "colouring", first, views.size())) break;
    const size_t count = std::min(batch_size, views.size() - first);
    parallel_for(count, threads, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        const PosedImage& view = views[first + i];
        const float gain = view.color_gain.mean();
        batch[i] = {stored.images.load(view.image), view.T_world_camera.inverse(), view.velocity, 0,
                    view.color_gain.reverse()};
        batch[i].sharpness = gain * gain * image_sharpness(batch[i].images.color);
      }
    });
    parallel_for(points.size(), threads, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        for (size_t k = 0; k < count; ++k)
          sums[i] += observe_color(batch[k], points[i], normals[i], stored.camera);
      }
    });
  }
  report(progress, "colouring", views.size(), views.size());
  std::vector<std::optional<Rgb>> colors;
  colors.reserve(sums.size());
  for (const ColorSum& sum : sums) colors.push_back(color_of(sum));
  return colors;
}

std::vector<Rgb> color_points(std::span<const Eigen::Vector3f> points,
                              std::span<const Eigen::Vector3f> normals, const StoredViews& stored,
                              int threads, const Progress& progress) {
  constexpr Rgb kGrey = {128, 128, 128};
  std::vector<Rgb> colors;
  colors.reserve(points.size());
  for (const auto& color : observed_colors(points, normals, stored, threads, progress))
    colors.push_back(color.value_or(kGrey));
  return colors;
}

}  // namespace kinloop
