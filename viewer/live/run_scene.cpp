#include "viewer/live/run_scene.hpp"

#include <algorithm>
#include <limits>

#include <opencv2/imgproc.hpp>

#include "dense/up_direction.hpp"
#include "kinloop/sensor/images/jpeg_codec.hpp"
#include "kinloop/tracking/front_end.hpp"
#include "session/store/dense_recorder.hpp"
#include "tools/evaluation/evaluate.hpp"

namespace kinloop {
namespace {

using std::chrono::duration;

cv::Mat resized(const cv::Mat& image, int width_px, int interpolation) {
  cv::Mat small;
  const double scale = std::min(1.0, static_cast<double>(width_px) / image.cols);
  cv::resize(image, small, {}, scale, scale, interpolation);
  return small;
}

/// Near is warm, far is cold, unknown is black.
cv::Mat depth_image(const cv::Mat& depth_m, double max_depth_m) {
  constexpr double kGrays = 255;
  cv::Mat grays, colors;
  depth_m.convertTo(grays, CV_8U, -kGrays / max_depth_m, kGrays);
  cv::applyColorMap(grays, colors, cv::COLORMAP_TURBO);
  colors.setTo(cv::Scalar::all(0), depth_m <= 0);
  return colors;
}

std::vector<ShownFeature> shown_features(const ImageEvent& image) {
  const cv::Size image_size = image.frame->depth_m.size();
  const Eigen::Vector2f size(static_cast<float>(image_size.width), static_cast<float>(image_size.height));
  std::vector<ShownFeature> shown;
  for (const Eigen::Vector2f& pixel : image.frame->features->raw_pixels)
    shown.push_back({pixel.cwiseQuotient(size)});
  for (const LandmarkMatch& match : image.matches) shown[match.feature].tracked = true;
  return shown;
}

const char* status_name(const FrameEvent& frame) {
  if (frame.outcome == TrackingOutcome::kLost) return "lost";
  if (frame.doubtful) return "doubtful";
  if (frame.outcome == TrackingOutcome::kRelocalized) return "relocalised";
  return frame.method == TrackingMethod::kDense ? "by depth and intensities alone" : "tracking";
}

}  // namespace

RunScene::RunScene(Scene& scene, RunInfo info)
    : scene_(scene), info_(std::move(info)), cloud_(info_.camera, info_.options) {
  if (info_.up) up_ = *info_.up;
  if (info_.options.mesh) mesh_.emplace(info_.camera.color, info_.options);
  const PinholeCamera& camera = info_.camera.color;
  scene_.put(PartKind::kHello, 0,
             encode_json({{"run", scene_.run()},
                          {"input", info_.input},
                          {"live", true},
                          {"frustum", {(camera.width / camera.fx) / 2, (camera.height / camera.fy) / 2}}}));
  std::vector<Eigen::Vector3f> truth;
  for (const auto& pose : info_.truth) truth.emplace_back(pose.T_world_camera.translation.cast<float>());
  if (!truth.empty()) scene_.put(PartKind::kTruth, 0, encode_points(truth));
}

void RunScene::update(const RunEvents& events, const RunState& state, bool watched) {
  if (events.map) update_map(*events.map);
  add_frames(events);
  for (const ImageEvent& image : events.keyframes) add_keyframe(image);
  if (mesh_) update_mesh(events, state);
  if (!events.covisible.empty()) {
    const size_t first = covisible_.size();
    covisible_.insert(covisible_.end(), events.covisible.begin(), events.covisible.end());
    put_parts(scene_, PartKind::kCovisibility, first, covisible_.size(), [this](size_t begin, size_t end) {
      return encode_pairs(std::span(covisible_).subspan(begin, end - begin));
    });
  }
  if (!info_.truth.empty() && (events.replaces_all || Clock::now() >= next_comparison_)) compare_with_truth();
  if (events.latest && watched && Clock::now() >= next_image_) show_images(*events.latest);
  show_camera();
  show_status(state);
}

void RunScene::update_map(const MapSummary& map) {
  map_ = map;
  put_parts(scene_, PartKind::kKeyframes, 0, map_.T_world_keyframe.size(), [this](size_t begin, size_t end) {
    return encode_poses(std::span(map_.T_world_keyframe).subspan(begin, end - begin));
  });
  scene_.put(PartKind::kLoops, 0, encode_pairs(map_.loops));
}

void RunScene::add_frames(const RunEvents& events) {
  if (events.frames.empty()) return;
  if (events.replaces_all) frames_.clear();
  const size_t first = frames_.size();
  frames_.insert(frames_.end(), events.frames.begin(), events.frames.end());
  relocalizations_ += static_cast<size_t>(
      std::count_if(events.frames.begin(), events.frames.end(),
                    [](const FrameEvent& frame) { return frame.outcome == TrackingOutcome::kRelocalized; }));
  show_path(first);
}

void RunScene::show_path(size_t first) {
  put_parts(scene_, PartKind::kPath, first, frames_.size(), [this](size_t begin, size_t end) {
    std::vector<PathPoint> points;
    for (size_t i = begin; i < end; ++i) {
      const FrameEvent& frame = frames_[i];
      const bool lost = frame.outcome == TrackingOutcome::kLost;
      const Eigen::Vector3f nowhere = Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN());
      points.push_back(
          {frame.reference, lost ? nowhere : frame.T_reference_camera.translation.cast<float>()});
    }
    return encode_path(points);
  });
  show_doubt();
}

void RunScene::show_doubt() {
  const auto doubt = ranges_where(frames_.size(), [this](size_t i) {
    return frames_[i].doubtful || frames_[i].outcome == TrackingOutcome::kLost;
  });
  if (doubt == doubt_) return;
  doubt_ = doubt;
  scene_.put(PartKind::kDoubt, 0, encode_ranges(doubt_));
}

void RunScene::add_keyframe(const ImageEvent& image) {
  if (image.keyframe.value >= map_.T_world_keyframe.size()) return;
  const CloudPiece piece = cloud_.add_keyframe(image.keyframe, image.frame->color.bgr(),
                                               depth_at_rest_m(*image.frame, image.moved),
                                               map_.T_world_keyframe[image.keyframe.value]);
  if (piece.cloud.size() > 0) scene_.put(PartKind::kCloud, image.keyframe.value, encode_cloud(piece));
  if (info_.up || Clock::now() < next_up_) return;
  up_ = estimate_up_direction(cloud_.normals(), map_.T_world_keyframe).direction;
  next_up_ = Clock::now() + std::chrono::seconds(3);
}

void RunScene::update_mesh(const RunEvents& events, const RunState& state) {
  finished_ |= events.replaces_all;
  mesh_->add(events.mesh_frames);
  const SensorEstimate sensor = state.sensor.value_or(nominal_estimate(info_.camera));
  const auto changed =
      mesh_->update(map_.T_world_keyframe, time_calibrated_camera(info_.camera, sensor), finished_);
  for (const MeshPiece& piece : changed)
    scene_.put(PartKind::kMeshPiece, piece.index, encode_mesh_piece(piece));
}

void RunScene::show_images(const ImageEvent& image) {
  const ViewerOptions& options = info_.options;
  next_image_ =
      Clock::now() + std::chrono::duration_cast<Clock::duration>(duration<double>(1 / options.image_rate_hz));
  const cv::Mat color = resized(image.frame->color.bgr(), options.image_width_px, cv::INTER_AREA);
  const cv::Mat depth = resized(image.frame->depth_m, options.image_width_px, cv::INTER_NEAREST);
  scene_.put(PartKind::kColorImage, 0, encode_jpeg(color, options.jpeg_quality));
  scene_.put(PartKind::kDepthImage, 0,
             encode_jpeg(depth_image(depth, options.limits.max_depth_m), options.jpeg_quality));
  scene_.put(PartKind::kFeatures, 0, encode_features(shown_features(image)));
}

/// Updates the pose of the last frame, given the current map.
void RunScene::show_camera() {
  if (frames_.empty()) return;
  const FrameEvent& frame = frames_.back();
  if (frame.outcome == TrackingOutcome::kLost || frame.reference.value >= map_.T_world_keyframe.size())
    return;
  const SE3 pose = map_.T_world_keyframe[frame.reference.value] * frame.T_reference_camera;
  scene_.put(PartKind::kCamera, 0, encode_poses({&pose, 1}));
}

/// Like that of the trajectory file, without doubtful poses.
Trajectory RunScene::path() const {
  Trajectory path;
  for (const FrameEvent& frame : frames_) {
    if (frame.doubtful || frame.outcome == TrackingOutcome::kLost ||
        frame.reference.value >= map_.T_world_keyframe.size())
      continue;
    path.push_back({frame.stamp_ns, map_.T_world_keyframe[frame.reference.value] * frame.T_reference_camera});
  }
  return path;
}

void RunScene::compare_with_truth() {
  next_comparison_ = Clock::now() + std::chrono::seconds(1);
  const auto ate = absolute_trajectory_error(path(), info_.truth);
  if (!ate) return;
  ate_m_ = ate->error_m.rmse;
  const SE3 T_world_truth = ate->T_truth_estimate.inverse();
  scene_.put(PartKind::kTruthPose, 0, encode_poses({&T_world_truth, 1}));
}

/// Over the last second, or as long as known.
double RunScene::frames_per_second() {
  const auto now = Clock::now();
  counts_.emplace_back(now, frames_.size());
  while (counts_.size() > 2 && now - counts_.front().first > std::chrono::seconds(1)) counts_.pop_front();
  const double passed_s = duration<double>(now - counts_.front().first).count();
  return passed_s > 0 ? static_cast<double>(frames_.size() - counts_.front().second) / passed_s : 0;
}

void RunScene::show_status(const RunState& state) {
  constexpr double kTenths = 10;
  nlohmann::json status = {{"stage", state.stage},
                           {"message", state.message},
                           {"warnings", state.warnings},
                           {"hints", state.hints},
                           {"paused", state.paused},
                           {"frame", frames_.size()},
                           {"frames", info_.frames},
                           {"keyframes", map_.T_world_keyframe.size()},
                           {"landmarks", map_.landmarks},
                           {"loops", map_.loops.size()},
                           {"points", cloud_.size()},
                           {"relocalisations", relocalizations_},
                           {"framesPerSecond", std::round(kTenths * frames_per_second()) / kTenths}};
  if (!frames_.empty()) {
    status["tracking"] = status_name(frames_.back());
    status["inliers"] = frames_.back().inliers;
  }
  if (ate_m_ > 0) status["ateM"] = ate_m_;
  status["up"] = {up_.x(), up_.y(), up_.z()};
  scene_.put(PartKind::kStatus, 0, encode_json(status));
}

}  // namespace kinloop
