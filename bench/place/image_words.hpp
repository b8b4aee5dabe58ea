#pragma once
// In: the keypoints of two images with their words. Out: matches, and the number that agree on one similarity
// transform between the images. This distinguishes a place from another one with the same words elsewhere.

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "kinloop/features/features.hpp"
#include "kinloop/features/matcher.hpp"
#include "kinloop/place/vocabulary/vocabulary.hpp"

namespace kinloop {

/// A keypoint as stored in the index.
struct QuantizedKeypoint {
  WordId word;
  /// 64 bits that distinguish keypoints of one word (Hamming embedding, Jegou et al. 2008): the first bits of
  /// binary descriptors, which ORB orders by discriminative power; for others, which components exceed those
  /// of the word's centre.
  uint64_t signature = 0;
  Eigen::Vector2f pixel;
  float angle_rad = 0;
  float scale = 1;  ///< size of its neighbourhood in the image
};

/// The keypoints of an image sorted by word.
using ImageWords = std::vector<QuantizedKeypoint>;

/// Returns the index entry of an image; `words` are those of its descriptors.
ImageWords image_words(const Features& features, std::span<const WordId> words, const Vocabulary& vocabulary);

/// Matches each point of `a` with the point of `b` that has the same word and the nearest signature, if that
/// differs in at most `max_signature_distance` bits.
std::vector<Match> match_words(const ImageWords& a, const ImageWords& b, int max_signature_distance);

/// Returns the number of matches that agree within `tolerance_px` with the best similarity between the images
/// (translation, rotation and scale). A single match defines a hypothesis, by its angle and scale (Philbin et
/// al. 2007, "fast spatial matching"), so all can be tried without random sampling.
size_t geometric_support(const ImageWords& a, const ImageWords& b, std::span<const Match> matches,
                         double tolerance_px);

/// Guided matching by the direct index: pairs of descriptors (N x 32 of 8UC1) that are mutual nearest
/// neighbours within the same node, ties to the lower index; in the order of `a`.
std::vector<Match> match_within_nodes(const cv::Mat& a, std::span<const NodeId> nodes_a, const cv::Mat& b,
                                      std::span<const NodeId> nodes_b);

}  // namespace kinloop
