#include "dense/texture/view_candidates.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/Geometry>
#include <opencv2/imgproc.hpp>

#include "dense/sharpness.hpp"
#include "kinloop/core/quantile.hpp"
#include "kinloop/core/threads/parallel_for.hpp"

namespace kinloop {
namespace {

constexpr size_t kMaxCandidates = 16;

/// Largest difference between two depths of one surface, relative to the depth.
constexpr float kSameSurface = 0.02F;

/// A view with what is needed to judge how it shows a triangle.
struct JudgedView {
  cv::Mat color;      // 8UC3, smoothed, so that a pixel stands for its surroundings
  cv::Mat depth_m;    // as measured
  cv::Mat surface_m;  // of the mesh, undistorted
  SE3 T_camera_world;
  Velocity velocity;
  Eigen::Vector3f gain_bgr;
  float sharpness = 0;
};

JudgedView judged(const RgbdImages& images, const PosedImage& view, const ColoredMesh& mesh,
                  const DenseCamera& camera) {
  JudgedView result;
  const cv::Size window(5, 5);
  cv::GaussianBlur(images.color, result.color, window, 0);
  result.depth_m = images.depth_m;
  result.T_camera_world = view.T_world_camera.inverse();
  result.surface_m = render_depth(mesh, result.T_camera_world, camera.color);
  result.velocity = view.velocity;
  result.gain_bgr = view.color_gain.reverse();
  constexpr float kLeastSharpness = 0.01F;  // of an image without any contrast
  result.sharpness = std::max(fine_contrast(images.color), kLeastSharpness);
  return result;
}

template <class Pixel>
const Pixel& nearest(const cv::Mat& image, const Eigen::Vector2d& pixel) {
  return image.at<Pixel>(static_cast<int>(std::lround(pixel.y())), static_cast<int>(std::lround(pixel.x())));
}

/// What the samples of a triangle show.
struct SampleSums {
  Eigen::Vector3f color_bgr = Eigen::Vector3f::Zero();
  float samples = 0;
  float measured = 0;   // whose depth was measured and is that of the triangle
  float saturated = 0;  // whose colour is clipped
  double border_px = 1e9;
};

/// Adds the point `p` in camera axes; returns false if it is hidden or outside the image.
bool add_sample(const JudgedView& view, const Eigen::Vector3d& p, const DenseCamera& camera,
                SampleSums& sums) {
  constexpr double kMarginPx = 2;
  const Eigen::Vector2d ideal = camera.color.project(p);
  if (!camera.color.contains(ideal)) return false;
  const Eigen::Vector2d raw = camera.raw_color_pixel(p, view.velocity);
  if (!camera.color.contains(raw, kMarginPx)) return false;
  const auto z = static_cast<float>(p.z());
  const float tolerance_m = kSameSurface * z;
  if (nearest<float>(view.surface_m, ideal) < z - tolerance_m) return false;
  const float measured_m = nearest<float>(view.depth_m, raw);
  const bool behind_something = measured_m > 0 && measured_m < z - tolerance_m;
  if (behind_something) return false;
  const auto& bgr = nearest<cv::Vec3b>(view.color, raw);
  sums.color_bgr += Eigen::Vector3f(bgr[0], bgr[1], bgr[2]);
  sums.samples += 1;
  sums.measured += std::abs(measured_m - z) <= tolerance_m ? 1.0F : 0.0F;
  sums.saturated += std::max({bgr[0], bgr[1], bgr[2]}) >= kSaturatedIntensity ? 1.0F : 0.0F;
  sums.border_px = std::min({sums.border_px, raw.x(), raw.y(), camera.color.width - 1 - raw.x(),
                             camera.color.height - 1 - raw.y()});
  return true;
}

/// A triangle in camera axes.
struct CameraTriangle {
  Eigen::Vector3d a, b, c;

  [[nodiscard]] Eigen::Vector3d at(double share_b, double share_c) const {
    return a + share_b * (b - a) + share_c * (c - a);
  }
};

/// Samples the triangle at its corners, its centre and, if it is large in the image, every few pixels.
/// nullopt if some of it is hidden.
std::optional<SampleSums> sample(const JudgedView& view, const CameraTriangle& triangle, double longest_px,
                                 const DenseCamera& camera) {
  constexpr double kStepPx = 12;
  constexpr int kMaxSteps = 10;
  const int steps = std::clamp(static_cast<int>(longest_px / kStepPx), 1, kMaxSteps);
  SampleSums sums;
  if (!add_sample(view, triangle.at(1.0 / 3, 1.0 / 3), camera, sums)) return std::nullopt;
  for (int i = 0; i <= steps; ++i) {
    for (int k = 0; k <= steps - i; ++k) {
      if (!add_sample(view, triangle.at(static_cast<double>(i) / steps, static_cast<double>(k) / steps),
                      camera, sums))
        return std::nullopt;
    }
  }
  return sums;
}

/// Factor of quality for what spoils the samples.
float usefulness(const SampleSums& sums) {
  constexpr float kUnmeasured = 0.02F, kSaturated = 0.05F, kAtBorder = 0.3F;
  constexpr double kBorderPx = 24;
  const auto mixed = [](float share, float worst) { return worst + (1 - worst) * share; };
  return mixed(sums.measured / sums.samples, kUnmeasured) *
         mixed(1 - sums.saturated / sums.samples, kSaturated) *
         mixed(static_cast<float>(std::min(sums.border_px / kBorderPx, 1.0)), kAtBorder);
}

std::optional<ViewCandidate> candidate(const JudgedView& view, uint32_t number, const ColoredMesh& mesh,
                                       const Triangle& triangle, const DenseCamera& camera) {
  constexpr double kNearestM = 0.1, kLeastCosine = 0.15;
  const auto in_camera = [&](uint32_t vertex) -> Eigen::Vector3d {
    return view.T_camera_world * mesh.points[vertex].cast<double>();
  };
  const CameraTriangle corners{in_camera(triangle[0]), in_camera(triangle[1]), in_camera(triangle[2])};
  const auto& [a, b, c] = corners;
  if (std::min({a.z(), b.z(), c.z()}) < kNearestM) return std::nullopt;
  const Eigen::Vector3d normal = (b - a).cross(c - a);
  const double twice_area_m2 = normal.norm(), cosine = -normal.dot(a.normalized()) / twice_area_m2;
  if (!(cosine > kLeastCosine)) return std::nullopt;
  const Eigen::Vector2d pa = camera.color.project(a), pb = camera.color.project(b) - pa,
                        pc = camera.color.project(c) - pa;
  const auto sums = sample(view, corners, std::max({pb.norm(), pc.norm(), (pc - pb).norm()}), camera);
  if (!sums) return std::nullopt;
  const double pixels_per_m2 = std::abs(pb.x() * pc.y() - pb.y() * pc.x()) / twice_area_m2;
  const auto resolution = static_cast<float>(pixels_per_m2 * cosine);
  return ViewCandidate{number, resolution * view.sharpness * view.sharpness * usefulness(*sums),
                       (sums->color_bgr / sums->samples).cwiseProduct(view.gain_bgr)};
}

/// Keeps the candidates of highest quality; of equal ones the earlier.
void keep_best(std::vector<ViewCandidate>& candidates, const ViewCandidate& added) {
  if (candidates.size() < kMaxCandidates) {
    candidates.push_back(added);
    return;
  }
  const auto worst = std::min_element(candidates.begin(), candidates.end(),
                                      [](const auto& a, const auto& b) { return a.quality < b.quality; });
  if (worst->quality < added.quality) *worst = added;
}

/// Lowers the quality of candidates whose colour differs from the median.
void distrust_outliers(std::vector<ViewCandidate>& candidates) {
  constexpr size_t kLeastForMajority = 3;
  constexpr float kSigma = 25, kLeastTrust = 1e-3F;  // intensities, over three channels
  if (candidates.size() < kLeastForMajority) return;
  Eigen::Vector3f middle;
  for (int channel = 0; channel < 3; ++channel) {
    std::vector<float> values;
    for (const ViewCandidate& each : candidates) values.push_back(each.color_bgr(channel));
    middle(channel) = median(std::move(values));
  }
  for (ViewCandidate& each : candidates) {
    const float off = (each.color_bgr - middle).squaredNorm() / (kSigma * kSigma);
    each.quality *= std::max(std::exp(-off / 2), kLeastTrust);
  }
}

}  // namespace

ViewCandidates find_view_candidates(const ColoredMesh& mesh, const StoredViews& stored, int threads,
                                    const Progress& progress) {
  const std::span<const PosedImage> views = stored.views;
  ViewCandidates candidates(mesh.triangles.size());
  const auto batch_size = static_cast<size_t>(std::max(threads, 1));
  std::vector<JudgedView> batch(batch_size);
  for (size_t first = 0; first < views.size(); first += batch_size) {
    if (!report(progress, "choosing images", first, views.size())) break;
    const size_t count = std::min(batch_size, views.size() - first);
    parallel_for(count, threads, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i)
        batch[i] = judged(stored.images.load(views[first + i].image), views[first + i], mesh, stored.camera);
    });
    parallel_for(candidates.size(), threads, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        for (size_t k = 0; k < count; ++k) {
          const auto number = static_cast<uint32_t>(first + k);
          if (const auto found = candidate(batch[k], number, mesh, mesh.triangles[i], stored.camera))
            keep_best(candidates[i], *found);
        }
      }
    });
  }
  parallel_for(candidates.size(), threads, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      distrust_outliers(candidates[i]);
      std::sort(candidates[i].begin(), candidates[i].end(),
                [](const auto& a, const auto& b) { return a.view < b.view; });
    }
  });
  return candidates;
}

}  // namespace kinloop
