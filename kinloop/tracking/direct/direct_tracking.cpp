#include "kinloop/tracking/direct/direct_tracking.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "kinloop/features/extraction/extractor.hpp"
#include "kinloop/features/keypoint_measurements.hpp"
#include "kinloop/sensor/surfaces/mask.hpp"
#include "kinloop/tracking/direct/alignment.hpp"
#include "kinloop/tracking/evidence/confirmed_first.hpp"
#include "kinloop/tracking/motion/motion_compensation.hpp"

namespace kinloop {
namespace {

/// Moves the prediction by aligning the image with the previous one around its landmarks.
SE3 align_with_previous(const Frame& frame, const SE3& T_reference_predicted,
                        const DirectTrackingContext& c) {
  constexpr size_t kMaxPoints = 150;
  const auto& index_of = c.search.local_map.index_of;
  const SE3 T_predicted_reference = T_reference_predicted.inverse();
  std::vector<AlignmentPoint> points;
  const Features& before = c.previous.features();
  const std::vector<LandmarkId> landmark_of = landmark_of_keypoint(c.previous);
  for (size_t i = 0; i < before.size(); ++i) {
    const auto known = index_of.find(landmark_of[i]);
    if (known == index_of.end()) continue;
    const Eigen::Vector3d p_camera = T_predicted_reference * c.search.local_map.p_reference[known->second];
    const auto raw = raw_pixel_of(c.search.sensor, p_camera, c.search.velocity);
    if (raw) points.push_back({p_camera, before.raw_pixels[i].cast<double>(), *raw});
  }
  if (points.size() > kMaxPoints) {  // evenly over the list, which begins with the finest level
    for (size_t i = 0; i < kMaxPoints; ++i) points[i] = points[i * points.size() / kMaxPoints];
    points.resize(kMaxPoints);
  }
  return T_reference_predicted *
         align_images(c.previous.frame->octaves, frame.octaves, points, c.search.sensor.camera);
}

/// A step that visits all of `count` indices in an order without relation to them: the local map begins with
/// the landmarks of its reference keyframe, which must not be preferred, or the reference would never change.
uint32_t coprime_step(uint32_t count) {
  auto step = static_cast<uint32_t>(std::lround(0.618 * count));
  while (std::gcd(step, count) != 1) ++step;
  return step;
}

/// Chooses landmarks in view, evenly over the image.
std::vector<ExpectedPatch> choose_landmarks(const SE3& T_reference_camera, const cv::Mat& mask,
                                            const DirectTrackingContext& c) {
  constexpr int kCell_px = 40, kMaxPerCell = 4;
  constexpr double kMargin_px = 8, kMinViewingCosine = 0.5;
  const PatchPredictor predictor(c.search, T_reference_camera);
  const int columns = c.search.sensor.camera.width / kCell_px + 1,
            rows = c.search.sensor.camera.height / kCell_px + 1;
  Eigen::ArrayXXi taken = Eigen::ArrayXXi::Zero(rows, columns);
  std::vector<ExpectedPatch> chosen;
  const auto count_all = static_cast<uint32_t>(c.search.local_map.size());
  const uint32_t step = coprime_step(count_all);
  for (uint32_t k = 0, i = 0; k < count_all; ++k, i = (i + step) % count_all) {
    const Eigen::Vector3d from_camera = c.search.local_map.p_reference[i] - T_reference_camera.translation;
    if (-c.search.local_map.viewing_directions[i].dot(from_camera) < kMinViewingCosine * from_camera.norm())
      continue;
    const auto nominal = predictor.nominal_pixel(i);
    if (!nominal || !c.search.sensor.camera.contains(*nominal)) continue;
    int& count = taken(static_cast<int>(nominal->y()) / kCell_px, static_cast<int>(nominal->x()) / kCell_px);
    if (count >= kMaxPerCell) continue;
    const auto raw = predictor.raw_pixel(i);
    if (!raw || !c.search.sensor.camera.contains(*raw, kMargin_px)) continue;
    if (!is_used(mask, raw->cast<float>())) continue;
    if (const auto expected = predictor.expect(i, *raw)) {
      chosen.push_back(*expected);
      ++count;
    }
  }
  return chosen;
}

/// The found landmarks in the form of keypoints.
Features as_features(const std::vector<FoundPatch>& found, const Frame& frame,
                     const DirectTrackingContext& c) {
  const Features& like = *c.search.local_map.features;
  Features features;
  features.scale_factor = like.scale_factor;
  features.level_count = like.level_count;
  features.depth_stamp_difference_s = depth_stamp_difference_s(frame);
  for (const FoundPatch& patch : found) {
    // Alignment is precise, but it finds the keypoint of the keyframe with that keypoint's error.
    const KeypointSample sample = sample_keypoint(
        frame.depth_m, patch.raw, static_cast<float>(1 << patch.octave), c.search.sensor, c.features);
    features.raw_pixels.push_back(patch.raw.cast<float>());
    features.pixels.push_back(sample.pixel);
    features.depths_m.push_back(sample.depth_m);
    features.inverse_depth_gradients.push_back(sample.inverse_depth_gradient);
    features.levels.push_back(static_cast<int>(std::lround(patch.octave / std::log2(like.scale_factor))));
    features.angles_rad.push_back(0);
    features.sigmas_px.push_back(sample.sigma_px);
  }
  features.measured_pixels = features.pixels;
  features.measured_depths_m = features.depths_m;
  return features;
}

/// Whether a pose explains enough of the landmarks found. A part of the image that is masked leaves less to
/// see, but not less certain.
bool is_confident(const VotedPose& pose, size_t found, bool masked, const TrackingOptions& options) {
  const bool few = masked || pose.voters < static_cast<int>(found);
  return pose.inlier_count >= (few ? kMinConfirmed : options.min_confident_inliers) &&
         pose.inlier_count >= kMinConsistent * pose.voters;
}

/// Estimates the pose from the landmarks found, whose positions are `compensated` for motion.
std::optional<TrackedFrame> solve_pose(const Frame& frame, const Features& compensated,
                                       const std::vector<FoundPatch>& found, const SE3& guess,
                                       const DirectTrackingContext& c) {
  std::vector<PoseObservation> observations;
  std::vector<bool> confirmed;
  for (size_t i = 0; i < found.size(); ++i) {
    observations.push_back(
        {compensated_measurement(compensated, i), c.search.local_map.p_reference[found[i].index]});
    confirmed.push_back(c.search.local_map.confirmed[found[i].index]);
  }
  const auto solution =
      solve_by_confirmed_first(c.search.sensor, observations, confirmed, guess, c.options.pose);
  if (!solution || !is_confident(*solution, found.size(), !frame.ignored.empty(), c.options))
    return std::nullopt;
  TrackedFrame tracked = unlocated(frame);
  tracked.outcome = TrackingOutcome::kTracked;
  tracked.method = TrackingMethod::kPatches;
  tracked.reference = c.search.local_map.reference;
  tracked.T_reference_camera = solution->T_reference_camera;
  tracked.covariance = covariance_from_information(solution->information);
  for (uint32_t i = 0; i < found.size(); ++i) {
    if (solution->inliers[i]) tracked.matches.push_back({c.search.local_map.ids[found[i].index], i});
  }
  tracked.evidence.inliers = static_cast<int>(tracked.matches.size());
  return tracked;
}

}  // namespace

std::optional<TrackedFrame> track_directly(const Frame& frame, const SE3& T_reference_predicted,
                                           const DirectTrackingContext& c) {
  constexpr float kMaxShift_px = 4;
  if (c.previous.frame->octaves.empty() || frame.octaves.empty()) return std::nullopt;
  const SE3 T_reference_aligned = align_with_previous(frame, T_reference_predicted, c);
  const auto expected = choose_landmarks(T_reference_aligned, used_pixels(frame.ignored), c);
  const int min_expected = frame.ignored.empty() ? c.options.min_confident_inliers : kMinConfirmed;
  if (static_cast<int>(expected.size()) < min_expected) return std::nullopt;
  std::vector<FoundPatch> found;
  for (const ExpectedPatch& patch : expected) {
    if (const auto at = find_patch(frame.octaves, patch, c.search.local_map, kMaxShift_px))
      found.push_back(*at);
  }
  Frame with_landmarks = frame;
  with_landmarks.features = std::make_shared<const Features>(as_features(found, frame, c));
  const Features& features = *with_landmarks.features;
  const Features compensated = needs_deskewing(features, c.search.sensor)
                                   ? deskew_features(features, c.search.sensor, c.search.velocity)
                                   : features;
  auto tracked = solve_pose(with_landmarks, compensated, found, T_reference_aligned, c);
  if (!tracked) return std::nullopt;
  if (tracked->evidence.inliers < c.options.min_inlier_ratio * static_cast<double>(expected.size()))
    return std::nullopt;
  tracked->evidence.visible_landmarks = static_cast<int>(expected.size());
  tracked->evidence.attempts = 1;
  tracked->frame = std::make_shared<const Frame>(std::move(with_landmarks));
  return tracked;
}

}  // namespace kinloop
