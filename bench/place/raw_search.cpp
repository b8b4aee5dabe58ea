#include "bench/place/raw_search.hpp"

#include <algorithm>

#include <opencv2/flann.hpp>

#include "kinloop/core/threads/parallel_for.hpp"
#include "kinloop/place/vocabulary/descriptor_space.hpp"

namespace kinloop {
namespace {

constexpr int kMaxDistance = 64;  ///< bits; farther descriptors do not vote

constexpr int kNeighbours = 20;  // per descriptor, before removing those that are too recent

/// The image with the most votes; its share of the query's descriptors is the score.
std::vector<PlaceCandidate> top_voted(const std::vector<uint32_t>& votes, size_t descriptors) {
  const auto most = std::max_element(votes.begin(), votes.end());
  return {{id_of(static_cast<size_t>(most - votes.begin())),
           static_cast<double>(*most) / static_cast<double>(descriptors)}};
}

std::span<const BinaryDescriptor> rows_of(const cv::Mat& descriptors) {
  return as_points<HammingSpace>(std::span(descriptors.ptr(0), descriptors.total()));
}

/// The descriptors of all images, concatenated.
struct AllDescriptors {
  cv::Mat rows;
  std::vector<size_t> image_of;  ///< by row
};

AllDescriptors all_descriptors(std::span<const Place> places) {
  AllDescriptors all;
  for (size_t i = 0; i < places.size(); ++i) {
    all.rows.push_back(places[i].features.descriptors);
    all.image_of.resize(static_cast<size_t>(all.rows.rows), i);
  }
  return all;
}

/// Expands each bit to a number.
cv::Mat bits_of(const cv::Mat& descriptors) {
  cv::Mat bits(descriptors.rows, 8 * descriptors.cols, CV_32F);
  for (int row = 0; row < bits.rows; ++row) {
    const auto* bytes = descriptors.ptr<uint8_t>(row);
    for (int bit = 0; bit < bits.cols; ++bit) {
      bits.at<float>(row, bit) = static_cast<float>(bytes[bit / 8] >> (bit % 8) & 1);
    }
  }
  return bits;
}

/// The nearest admissible neighbour of each row gets a vote. `nearest` has the rows' neighbours, nearest
/// first.
std::vector<PlaceCandidate> vote(std::span<const Place> places, size_t query,
                                 const std::vector<size_t>& image_of, const cv::Mat& nearest,
                                 const cv::Mat& distances) {
  std::vector<uint32_t> votes(places.size(), 0);
  for (int row = 0; row < nearest.rows; ++row) {
    for (int i = 0; i < nearest.cols; ++i) {
      const int found = nearest.at<int>(row, i);
      if (found < 0 || distances.at<float>(row, i) > kMaxDistance) break;
      const size_t image = image_of[static_cast<size_t>(found)];
      if (image == query || !is_admissible(places[query], places[image])) continue;
      ++votes[image];
      break;
    }
  }
  return top_voted(votes, static_cast<size_t>(nearest.rows));
}

/// Queries a FLANN index over `all`; `form` converts an image's descriptors to its rows.
Recognition by_flann(std::span<const Place> places, const AllDescriptors& all, cv::flann::Index& index,
                     const std::function<cv::Mat(const cv::Mat&)>& form, int checks) {
  return recognize(places, [&](size_t query) {
    const cv::Mat rows = form(places[query].features.descriptors);
    cv::Mat nearest(rows.rows, kNeighbours, CV_32S, cv::Scalar(-1)), distances;
    index.knnSearch(rows, nearest, distances, kNeighbours, cv::flann::SearchParams(checks));
    distances.convertTo(distances, CV_32F);
    return vote(places, query, all.image_of, nearest, distances);
  });
}

}  // namespace

Recognition by_brute_force(std::span<const Place> places) {
  return recognize(places, [&](size_t query) {
    const auto rows = rows_of(places[query].features.descriptors);
    std::vector<uint32_t> votes(places.size(), 0), winner(rows.size(), 0);
    parallel_for(rows.size(), hardware_threads(), [&](size_t begin, size_t end) {
      std::vector<uint32_t> nearest(end - begin), distance(end - begin);
      std::vector<uint32_t> best(end - begin, kMaxDistance + 1);
      for (size_t i = 0; i < places.size(); ++i) {
        if (i == query || !is_admissible(places[query], places[i])) continue;
        assign_to_nearest<HammingSpace>(rows.subspan(begin, end - begin),
                                        rows_of(places[i].features.descriptors), nearest.data(),
                                        distance.data());
        for (size_t j = 0; j < best.size(); ++j) {
          if (distance[j] >= best[j]) continue;
          best[j] = distance[j];
          winner[begin + j] = static_cast<uint32_t>(i + 1);
        }
      }
    });
    for (const uint32_t image : winner) {
      if (image > 0) ++votes[image - 1];
    }
    return top_voted(votes, rows.size());
  });
}

Recognition by_lsh(std::span<const Place> places, uint64_t seed) {
  // The bits of ORB are correlated: with the 12 bits of OpenCV's examples some buckets hold thousands of
  // descriptors, all of which are searched.
  constexpr int kTables = 6, kKeyBits = 20, kProbes = 1;
  const AllDescriptors all = all_descriptors(places);
  cvflann::seed_random(static_cast<unsigned>(seed));
  cv::flann::Index index(all.rows, cv::flann::LshIndexParams(kTables, kKeyBits, kProbes),
                         cvflann::FLANN_DIST_HAMMING);
  return by_flann(
      places, all, index, [](const cv::Mat& descriptors) { return descriptors; }, 0);
}

Recognition by_kd_trees(std::span<const Place> places, uint64_t seed) {
  constexpr int kTrees = 4, kLeavesVisited = 64;
  const AllDescriptors all = all_descriptors(places);
  const cv::Mat bits = bits_of(all.rows);
  cvflann::seed_random(static_cast<unsigned>(seed));
  cv::flann::Index index(bits, cv::flann::KDTreeIndexParams(kTrees), cvflann::FLANN_DIST_L2);
  return by_flann(places, all, index, bits_of, kLeavesVisited);
}

}  // namespace kinloop
