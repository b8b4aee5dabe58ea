#include "tools/feature_comparison/detectors.hpp"

#include <numbers>

#include <opencv2/features2d.hpp>

#include "kinloop/features/extraction/extractor.hpp"
#include "kinloop/features/extraction/surf.hpp"
#include "kinloop/sensor/sensor.hpp"

namespace kinloop {
namespace {

/// Converts OpenCV's and dlib's keypoints. A single level, since their scales are not levels of kinloop's
/// pyramid.
Features to_features(const std::vector<cv::KeyPoint>& keypoints, const cv::Mat& descriptors,
                     const PinholeCamera& camera) {
  Features features;
  features.level_count = 1;
  features.descriptors = descriptors;
  for (const auto& key_point : keypoints) {
    const Eigen::Vector2f raw(key_point.pt.x, key_point.pt.y);
    features.raw_pixels.push_back(raw);
    features.pixels.push_back(camera.undistort(raw.cast<double>()).cast<float>());
    features.depths_m.push_back(0);
    features.levels.push_back(0);
    features.angles_rad.push_back(key_point.angle * std::numbers::pi_v<float> / 180.0F);
    features.sigmas_px.push_back(1);
  }
  return features;
}

Detector opencv_detector(const std::string& name, const std::string& id, const cv::Ptr<cv::Feature2D>& method,
                         const PinholeCamera& camera) {
  return {name, id, [method, camera](const cv::Mat& gray) {
            std::vector<cv::KeyPoint> keypoints;
            cv::Mat descriptors;
            method->detectAndCompute(gray, cv::noArray(), keypoints, descriptors);
            return to_features(keypoints, descriptors, camera);
          }};
}

}  // namespace

std::vector<Detector> make_detectors(const FeatureOptions& options, const PinholeCamera& camera) {
  std::vector<Detector> detectors;
  detectors.push_back(opencv_detector("SIFT (OpenCV)", "sift", cv::SIFT::create(options.count), camera));
  if (surf_available()) {
    detectors.push_back({"SURF (dlib)", "surf", [options, camera](const cv::Mat& gray) {
                           const SurfFeatures points = detect_surf(gray, options.count);
                           return to_features(points.keypoints, points.descriptors, camera);
                         }});
  }
  const auto orb = cv::ORB::create(options.count, static_cast<float>(options.scale_factor), options.levels);
  detectors.push_back(opencv_detector("ORB (OpenCV)", "orb-opencv", orb, camera));
  FeatureOptions ours = options;
  ours.kind = FeatureKind::kOrb;
  detectors.push_back({"ORB (ours)", "orb", [options = ours, camera](const cv::Mat& gray) {
                         return extract_features(gray, cv::Mat(), Sensor{camera}, options);
                       }});
  return detectors;
}

}  // namespace kinloop
