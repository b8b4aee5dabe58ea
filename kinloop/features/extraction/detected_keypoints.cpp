#include <algorithm>
#include <cmath>

#include <opencv2/features2d.hpp>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/random.hpp"
#include "kinloop/features/extraction/corner_detector.hpp"
#include "kinloop/features/extraction/surf.hpp"
#include "kinloop/features/hamming.hpp"

namespace kinloop {
namespace {

/// Random planes as columns: their normals, with zero mean over the components of each kind.
cv::Mat random_planes(int dimensions, int count, int kinds) {
  constexpr uint64_t kSeed = 256;  // vocabularies depend on this value
  Random random(hash(kSeed, static_cast<uint64_t>(dimensions)));
  cv::Mat planes(dimensions, count, CV_32FC1);
  for (int plane = 0; plane < count; ++plane) {
    std::vector<double> mean(static_cast<size_t>(kinds), 0);
    for (int d = 0; d < dimensions; ++d) {
      const double weight = random.gaussian();
      planes.at<float>(d, plane) = static_cast<float>(weight);
      mean[static_cast<size_t>(d % kinds)] += weight * kinds / dimensions;
    }
    for (int d = 0; d < dimensions; ++d) {
      planes.at<float>(d, plane) -= static_cast<float>(mean[static_cast<size_t>(d % kinds)]);
    }
  }
  return planes;
}

/// Assigns sizes to the levels of a pyramid that begins at `smallest_px`.
DetectedKeypoints on_levels(const std::vector<cv::KeyPoint>& keypoints, float smallest_px,
                            const FeatureOptions& options) {
  constexpr double kLargestShare = 32;  // larger keypoints go to the top level
  const double step = std::log(options.scale_factor);
  DetectedKeypoints image;
  image.level_count = static_cast<int>(std::ceil(std::log(kLargestShare) / step)) + 1;
  for (const cv::KeyPoint& key_point : keypoints) {
    const double level = std::log(static_cast<double>(key_point.size / smallest_px)) / step;
    image.points.push_back({{key_point.pt.x, key_point.pt.y},
                            std::clamp(static_cast<int>(std::lround(level)), 0, image.level_count - 1),
                            key_point.angle});
  }
  return image;
}

}  // namespace

cv::Mat binarize_descriptors(const cv::Mat& descriptors, int kinds) {
  constexpr int kBits = 8 * kOrbBytes;
  cv::Mat bits(descriptors.rows, kOrbBytes, CV_8UC1, cv::Scalar(0));
  if (descriptors.empty()) return bits;
  require(descriptors.type() == CV_32FC1 && descriptors.cols % kinds == 0,
          "binarize_descriptors: expected floats, equally many of each kind");
  const cv::Mat sides = descriptors * random_planes(descriptors.cols, kBits, kinds);
  for (int i = 0; i < bits.rows; ++i) {
    const float* side = sides.ptr<float>(i);
    for (int bit = 0; bit < kBits; ++bit) {
      if (side[bit] > 0) bits.at<uint8_t>(i, bit / 8) |= static_cast<uint8_t>(1 << (bit % 8));
    }
  }
  return bits;
}

DetectedKeypoints detect_float_keypoints(const cv::Mat& gray, const FeatureOptions& options) {
  std::vector<cv::KeyPoint> keypoints;
  if (options.kind == FeatureKind::kSift) {
    constexpr float kSmallestPx = 2;  // diameter
    constexpr int kKinds = 1;         // all components are histogram bins
    cv::Mat descriptors;
    cv::SIFT::create(options.count)->detectAndCompute(gray, cv::noArray(), keypoints, descriptors);
    DetectedKeypoints image = on_levels(keypoints, kSmallestPx, options);
    image.descriptors = binarize_descriptors(descriptors, kKinds);
    return image;
  }
  constexpr float kSmallestPx = 3;
  constexpr int kKinds = 4;  // sums of dx, dy, |dx|, |dy|
  const SurfFeatures surf = detect_surf(gray, options.count);
  DetectedKeypoints image = on_levels(surf.keypoints, kSmallestPx, options);
  image.descriptors = binarize_descriptors(surf.descriptors, kKinds);
  return image;
}

}  // namespace kinloop
