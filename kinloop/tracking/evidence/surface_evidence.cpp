#include "kinloop/tracking/evidence/surface_evidence.hpp"

#include <algorithm>

namespace kinloop {
namespace {

/// Fewer may be those of something that moves: in ten recordings and rooms without, 51 are the least.
constexpr int kMinLandmarks = 15;

bool is_above(const SurfaceAgreement& agreement, double max_contradicted_share) {
  return agreement.decides() && agreement.contradicted_share() > max_contradicted_share;
}

/// Share of the points that may be contradicted where a camera with a rolling shutter and delayed depth
/// turns.
double contradicted_by_turning(double turning_rad_s) {
  constexpr double kShare_s = 0.15, kMaxShare = 0.25;
  return std::min(kShare_s * turning_rad_s, kMaxShare);
}

}  // namespace

SurfaceAgreement agreement_with_reference(const LocalMap& local_map, const Frame& frame,
                                          const SE3& T_reference_camera) {
  if (!local_map.surfaces || !frame.surfaces) return {};
  return compare_surfaces(*local_map.surfaces, *frame.surfaces, T_reference_camera);
}

bool is_confident(const TrackedFrame& found, const Features& features) {
  constexpr int kMinInliers = 60;
  constexpr double kMinRatio = 0.25;
  return found.evidence.inliers >= kMinInliers && has_sufficient_inlier_ratio(found, features, kMinRatio);
}

bool contradicts_unexpected_pose(const SurfaceAgreement& agreement, const TrackedFrame& found,
                                 const Frame& frame, double turning_rad_s) {
  // Of right poses after gaps in redkitchen and two rendered rooms, at most 2 % of the points are
  // contradicted; of wrong ones 7 to 50 %.
  constexpr double kMaxContradicted = 0.04, kMaxContradictedIfConfident = 0.2;
  const bool confident = is_confident(found, *frame.features);
  // Without depth, nothing but the keypoints tells one place from another.
  if (!confident && frame.surfaces && !has_depth(*frame.surfaces)) return true;
  return is_above(agreement, (confident ? kMaxContradictedIfConfident : kMaxContradicted) +
                                 contradicted_by_turning(turning_rad_s));
}

DoubtCause cause_of_doubt(const TrackedFrame& tracked, bool doubtful_before, double max_sigma_m) {
  // Of the frames of redkitchen, none is contradicted by more than 8 %. Where a camera with a rolling shutter
  // and delayed depth turns fast, up to 36 % of the points are, since the grids are not
  // motion-compensated.
  constexpr double kMaxContradicted = 0.25, kMaxContradictedAfterDoubt = 0.1;
  constexpr double kMaxMoved = 0.5;  // of the image; if it is more, the rest may be what moves
  const TrackingEvidence& evidence = tracked.evidence;
  const double max_contradicted = (doubtful_before ? kMaxContradictedAfterDoubt : kMaxContradicted) +
                                  contradicted_by_turning(tracked.velocity.angular_rad_s.norm());
  if (is_above(evidence.surfaces, max_contradicted)) return DoubtCause::kSurfaces;
  if (evidence.moved_share > kMaxMoved) return DoubtCause::kMoving;
  if (tracked.method != TrackingMethod::kDense)
    return evidence.inliers < kMinLandmarks ? DoubtCause::kFewLandmarks : DoubtCause::kNone;
  return position_sigma_m(tracked.covariance) > max_sigma_m ? DoubtCause::kDrift : DoubtCause::kNone;
}

bool lacks_scale(const TrackedFrame& tracked, bool lacked_before) {
  if (tracked.evidence.with_depth >= kMinLandmarks) return false;
  // The motion from the previous frame has the scale of its depth.
  if (tracked.evidence.inliers < kMinLandmarks) return lacked_before;
  // Where a RealSense sees windows, 350 points or more are consistent.
  const bool surfaces_hold_it = tracked.evidence.surfaces.consistent >= SurfaceAgreement::kMinPoints;
  return lacked_before || (tracked.method != TrackingMethod::kDense && !surfaces_hold_it);
}

}  // namespace kinloop
