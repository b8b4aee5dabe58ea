#include "tools/export/sparse_model/sparse_model.hpp"

#include <algorithm>
#include <unordered_map>

#include <fmt/format.h>

#include "kinloop/core/random.hpp"

namespace kinloop {
namespace {

/// The image of each keyframe that has one.
using ImageOfKeyframe = std::unordered_map<KeyframeId, uint32_t>;

struct ImagePixel {
  uint32_t image = 0;
  Eigen::Vector2d pixel;
};

/// Returns the pixels at which the model's images see a landmark close to the projection of `p_file`.
std::vector<ImagePixel> consistent_pixels(const Map& map, const Landmark& landmark,
                                          const Eigen::Vector3d& p_file, const SparseModel& model,
                                          const ImageOfKeyframe& image_of,
                                          const ImageUndistorter& undistorter, double& mean_error_px) {
  std::vector<ImagePixel> found;
  double sum_px = 0;
  for (const Observation& observation : landmark.observations) {
    const auto known = image_of.find(observation.keyframe);
    if (known == image_of.end()) continue;
    const ModelImage& image = model.images[known->second];
    const Eigen::Vector3d p_camera = image.T_file_camera.inverse() * p_file;
    if (!(p_camera.z() > 0)) continue;
    const auto& raw = map.keyframe(observation.keyframe).features->raw_pixels[observation.feature];
    const Eigen::Vector2d pixel = undistorter.undistort(raw.cast<double>(), image.velocity);
    const double error_px = (model.camera.project(p_camera) - pixel).norm();
    if (!(error_px <= kMaxReprojectionErrorPx) || !model.camera.contains(pixel)) continue;
    found.push_back({known->second, pixel});
    sum_px += error_px;
  }
  if (!found.empty()) mean_error_px = sum_px / static_cast<double>(found.size());
  return found;
}

void add_point(SparseModel& model, ModelPoint point, const std::vector<ImagePixel>& pixels) {
  const auto id = static_cast<uint32_t>(model.points.size());
  for (const auto& [image, pixel] : pixels) {
    auto& observations = model.images[image].observations;
    point.track.push_back({image, static_cast<uint32_t>(observations.size())});
    observations.push_back({pixel, id});
  }
  model.points.push_back(std::move(point));
}

}  // namespace

SparseModel make_sparse_model(const Map& map, std::span<const FrameImage> views,
                              const ImageUndistorter& undistorter, const FileFrame& frame) {
  SparseModel model{undistorter.pinhole(), frame, {}, {}};
  const SE3 T_file_world = frame.T_file_world();
  std::unordered_map<FrameId, uint32_t> image_of_frame;
  for (const auto& [id, view, stamp_ns] : views) {
    if (!view.T_world_camera.is_finite()) continue;
    image_of_frame.emplace(id, static_cast<uint32_t>(model.images.size()));
    model.images.push_back({fmt::format("frame_{:06}", id.value),
                            view.image,
                            stamp_ns,
                            view.velocity,
                            T_file_world * view.T_world_camera,
                            {}});
  }
  ImageOfKeyframe image_of;
  for (const Keyframe& keyframe : map.keyframes()) {
    const auto image = image_of_frame.find(keyframe.frame);
    if (image != image_of_frame.end()) image_of.emplace(keyframe.id, image->second);
  }
  constexpr size_t kMinObservations = 2;
  for (const LandmarkId id : map.landmark_ids()) {
    const Landmark& landmark = map.landmark(id);
    const auto anchor = image_of.find(landmark.anchor);
    if (anchor == image_of.end() || !landmark.p_anchor.allFinite()) continue;
    ModelPoint point;
    point.p_file = model.images[anchor->second].T_file_camera * landmark.p_anchor;
    const auto pixels =
        consistent_pixels(map, landmark, point.p_file, model, image_of, undistorter, point.error_px);
    if (pixels.size() >= kMinObservations) add_point(model, std::move(point), pixels);
  }
  return model;
}

void add_cloud_points(SparseModel& model, const ColoredCloud& cloud, size_t count) {
  const SE3 T_file_world = model.frame.T_file_world();
  Random random(cloud.size());
  // Selection sampling (Knuth, The Art of Computer Programming 2, algorithm S): each point once, in their
  // order.
  size_t needed = std::min(count, cloud.size());
  for (size_t i = 0; needed > 0; ++i) {
    const auto left = static_cast<double>(cloud.size() - i);
    if (left * random.uniform() >= static_cast<double>(needed)) continue;
    model.points.push_back({T_file_world * cloud.points[i].cast<double>(), cloud.colors[i]});
    --needed;
  }
}

}  // namespace kinloop
