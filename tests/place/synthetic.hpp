#pragma once
// Descriptors with known truth: random bits, and noisy copies of known centres.

#include <cstring>
#include <vector>

#include <opencv2/core.hpp>

#include "kinloop/core/random.hpp"
#include "kinloop/place/vocabulary/descriptor_space.hpp"

namespace kinloop::test {

inline BinaryDescriptor random_descriptor(Random& random) {
  BinaryDescriptor descriptor;
  for (uint8_t& byte : descriptor) byte = static_cast<uint8_t>(random.next() & 0xff);
  return descriptor;
}

/// Each bit flipped with probability `p`.
inline BinaryDescriptor with_noise(BinaryDescriptor descriptor, double p, Random& random) {
  for (uint8_t& byte : descriptor) {
    for (unsigned bit = 0; bit < 8; ++bit) {
      if (random.uniform() < p) byte = static_cast<uint8_t>(byte ^ (1U << bit));
    }
  }
  return descriptor;
}

/// `count` descriptors around `centres` random centres.
inline std::vector<BinaryDescriptor> clustered_descriptors(int count, int centres, double noise,
                                                           uint64_t seed) {
  Random random(seed);
  std::vector<BinaryDescriptor> truth;
  truth.reserve(static_cast<size_t>(centres));
  for (int i = 0; i < centres; ++i) truth.push_back(random_descriptor(random));
  std::vector<BinaryDescriptor> points;
  points.reserve(static_cast<size_t>(count));
  for (int i = 0; i < count; ++i) {
    points.push_back(with_noise(truth[random.index(static_cast<uint32_t>(centres))], noise, random));
  }
  return points;
}

inline cv::Mat to_mat(const std::vector<BinaryDescriptor>& points) {
  cv::Mat mat(static_cast<int>(points.size()), kOrbBytes, CV_8UC1);
  for (size_t i = 0; i < points.size(); ++i) {
    std::memcpy(mat.ptr(static_cast<int>(i)), points[i].data(), kOrbBytes);
  }
  return mat;
}

/// `images` images of `per_image` descriptors each around shared centres.
inline std::vector<cv::Mat> clustered_images(int images, int per_image, int centres, uint64_t seed) {
  constexpr double kNoise = 0.08;
  const auto points = clustered_descriptors(images * per_image, centres, kNoise, seed);
  std::vector<cv::Mat> result;
  result.reserve(static_cast<size_t>(images));
  for (int i = 0; i < images; ++i) {
    result.push_back(to_mat({points.begin() + i * per_image, points.begin() + (i + 1) * per_image}));
  }
  return result;
}

inline int distance(const BinaryDescriptor& a, const BinaryDescriptor& b) {
  return hamming_distance(a.data(), b.data());
}

}  // namespace kinloop::test
