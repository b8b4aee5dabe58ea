#pragma once
// In: the keypoints of two images with their words. Out: pairs that look alike, and how many of them agree
// on where the one image lies in the other: what tells a place from one that has the same words elsewhere.

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "kinloop/features/features.hpp"
#include "kinloop/features/matcher.hpp"
#include "kinloop/place/vocabulary.hpp"

namespace kinloop {

/// A keypoint as the index keeps it.
struct QuantizedKeypoint {
  WordId word;
  /// 64 bits that tell points of one word apart (Hamming embedding, Jegou et al. 2008): of descriptors of
  /// bits the first, which ORB orders by how much they tell; of others, which components are above the word's
  /// own.
  uint64_t signature = 0;
  Eigen::Vector2f pixel;
  float angle_rad = 0;
  float scale = 1;  ///< size of its surroundings in the image
};

/// The keypoints of an image in the order of their words.
using ImageWords = std::vector<QuantizedKeypoint>;

/// What the index keeps of an image; `words` are those of its descriptors.
ImageWords image_words(const Features& features, std::span<const WordId> words, const Vocabulary& vocabulary);

/// For each point of `a` the point of `b` with the same word and the nearest signature, where that differs in
/// at most `max_signature_distance` bits.
std::vector<Match> match_words(const ImageWords& a, const ImageWords& b, int max_signature_distance);

/// Matches that agree, within `tolerance_px`, with the best similarity between the images (shift, turn and
/// scale). One match makes a hypothesis, by its angle and scale (Philbin et al. 2007, "fast spatial
/// matching"), so that all can be tried: no random numbers.
size_t geometric_support(const ImageWords& a, const ImageWords& b, std::span<const Match> matches,
                         double tolerance_px);

/// Guided matching by the direct index: pairs of descriptors (N x 32 of 8UC1) that are each other's nearest
/// among those of the same node, ties to the lower index; in the order of `a`.
std::vector<Match> match_within_nodes(const cv::Mat& a, std::span<const NodeId> nodes_a, const cv::Mat& b,
                                      std::span<const NodeId> nodes_b);

}  // namespace kinloop
