#include <limits>

#include <opencv2/imgproc.hpp>

#include "dense/usable_depth.hpp"
#include "kinloop/core/threads/parallel_for.hpp"
#include "tools/map_difference/map_difference.hpp"

namespace kinloop {
namespace {

/// A point is compared with all pixels at most this far away, since poses and edges of depth are inexact.
constexpr int kAroundPx = 2;
/// What two surfaces may differ by: error of the poses, noise of depth, voxels.
constexpr double kPoseError_m = 0.02, kSigmas = 4, kVoxels = 2;

/// What a view measured around each pixel.
struct Surroundings {
  cv::Mat nearest_m, farthest_m;  ///< 32FC1 of the known depths; infinite and 0 if there is none
  cv::Mat known;                  ///< 8UC1, nonzero where all depths around are known
};

Surroundings surroundings_of(const cv::Mat& depth_m, double focal_px, const DepthLimits& limits) {
  const cv::Mat usable = usable_pixels(depth_m, focal_px, limits);
  cv::Mat far = cv::Mat(depth_m.size(), CV_32FC1, cv::Scalar(std::numeric_limits<float>::infinity()));
  cv::Mat near = cv::Mat::zeros(depth_m.size(), CV_32FC1);
  depth_m.copyTo(far, usable);
  depth_m.copyTo(near, usable);
  const cv::Mat window = cv::Mat::ones(2 * kAroundPx + 1, 2 * kAroundPx + 1, CV_8UC1);
  Surroundings around;
  cv::erode(far, around.nearest_m, window);
  cv::dilate(near, around.farthest_m, window);
  cv::erode(usable, around.known, window);
  return around;
}

struct Votes {
  uint16_t through = 0, agree = 0;
};

/// Adds the vote of a view on the point at `p_camera`, metres.
void vote(const Surroundings& around, const PosedImage& view, const ComparisonOptions& options,
          const Eigen::Vector3d& p_camera, Votes& votes) {
  const DenseCamera& camera = options.camera;
  if (p_camera.z() < options.limits.min_depth_m) return;
  const Eigen::Vector3d p = camera.undo_deskew(p_camera, view.velocity, view.depth_stamp_difference_s);
  if (p.z() < options.limits.min_depth_m || !camera.color.contains(camera.color.project(p))) return;
  const Eigen::Vector2d pixel = camera.color.distort(camera.color.project(p));
  if (!camera.color.contains(pixel, kAroundPx + 1)) return;
  const cv::Point at(static_cast<int>(std::lround(pixel.x())), static_cast<int>(std::lround(pixel.y())));
  // The depth that the sensor would report of it, before correction.
  const double z = 1 / (1 / p.z() - camera.correct_inverse_depth(0, p.x() / p.z(), p.y() / p.z()));
  const double margin_m = kPoseError_m + kVoxels * options.voxel_m + kSigmas * camera.noise.sigma_m(z);
  const double nearest_m = around.nearest_m.at<float>(at), farthest_m = around.farthest_m.at<float>(at);
  if (nearest_m <= z + margin_m && farthest_m >= z - margin_m) {
    ++votes.agree;
  } else if (around.known.at<uint8_t>(at) != 0 && nearest_m > z + margin_m) {
    ++votes.through;
  }
}

}  // namespace

std::vector<PointChange> compare_points(const ColoredCloud& cloud, const VisitViews& other,
                                        const ComparisonOptions& options, const Progress& progress) {
  std::vector<Votes> votes(cloud.size());
  for (size_t v = 0; v < other.views.size(); ++v) {
    if (!report(progress, "compare", v, other.views.size())) break;
    const PosedImage& view = other.views[v];
    const Surroundings around =
        surroundings_of(other.images.load(view.image).depth_m, options.camera.color.fx, options.limits);
    const SE3 T_camera_world = view.T_world_camera.inverse();
    parallel_for(cloud.size(), options.threads, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i)
        vote(around, view, options, T_camera_world * cloud.points[i].cast<double>(), votes[i]);
    });
  }
  report(progress, "compare", other.views.size(), other.views.size());
  const int least = other.views.size() > 1 ? 2 : 1;
  std::vector<PointChange> changes;
  changes.reserve(votes.size());
  for (const Votes& of_point : votes) {
    const bool changed = of_point.through >= least && of_point.through > of_point.agree;
    changes.push_back(changed              ? PointChange::kChanged
                      : of_point.agree > 0 ? PointChange::kSame
                                           : PointChange::kUnseen);
  }
  return changes;
}

}  // namespace kinloop
