#include "kinloop/tracking/direct/patch_search.hpp"

namespace kinloop {

Features refine_keypoints(const Frame& frame, std::span<const LandmarkMatch> matches,
                          const SE3& T_reference_camera, const PatchSearch& search) {
  constexpr float kMaxShift_px = 2;    // on the octave of the patch: as far as corners are detected off
  constexpr float kSigmaRatio = 0.5F;  // aligned patch to detected corner
  Features refined = *frame.features;
  if (frame.octaves.empty()) return refined;
  const PatchPredictor predictor(search, T_reference_camera);
  for (const auto& [landmark, feature] : matches) {
    const auto known = search.local_map.index_of.find(landmark);
    if (known == search.local_map.index_of.end()) continue;
    const auto expected = predictor.expect(known->second, refined.raw_pixels[feature].cast<double>());
    if (!expected) continue;
    const auto found = find_patch(frame.octaves, *expected, search.local_map, kMaxShift_px);
    if (!found) continue;
    refined.raw_pixels[feature] = found->raw.cast<float>();
    refined.measured_pixels[feature] = search.sensor.camera.undistort(found->raw).cast<float>();
    refined.sigmas_px[feature] *= kSigmaRatio;
  }
  return refined;
}

}  // namespace kinloop
