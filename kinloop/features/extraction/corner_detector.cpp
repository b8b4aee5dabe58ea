#include "kinloop/features/extraction/corner_detector.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>
#include <span>

#include <opencv2/imgproc.hpp>

#include "kinloop/features/kernels/corner_scores.hpp"
#include "kinloop/features/kernels/gaussian_blur.hpp"
#include "kinloop/features/kernels/steered_brief.hpp"

namespace kinloop {
namespace {

/// All pixels read around a corner must lie inside the level: the compared pixels including the radius of the
/// blur, and the disc that gives the orientation.
constexpr int kBorder = std::max(kBriefMarginPx + kBlurRadius, kDiscMarginPx);

/// Keypoints per level, in proportion to the level's side length, as in ORB.
std::vector<int> quota_per_level(const FeatureOptions& options) {
  std::vector<double> share(static_cast<size_t>(options.levels));
  for (size_t level = 0; level < share.size(); ++level) {
    share[level] = std::pow(options.scale_factor, -static_cast<double>(level));
  }
  const double total = std::accumulate(share.begin(), share.end(), 0.0);
  std::vector<int> quota;
  for (const double s : share) quota.push_back(static_cast<int>(std::ceil(options.count * s / total)));
  return quota;
}

/// Sorts the corners by falling contrast; equal ones stay in reading order.
std::vector<RawCorner> sort_by_score(std::span<const RawCorner> corners) {
  constexpr size_t kContrasts = 256;
  std::array<size_t, kContrasts + 1> next{};  // counting sort: next output index of each contrast
  const auto bin = [](const RawCorner& corner) {
    return kContrasts - 1 - static_cast<size_t>(corner.contrast);
  };
  for (const RawCorner& corner : corners) ++next[bin(corner) + 1];
  std::partial_sum(next.begin(), next.end(), next.begin());
  std::vector<RawCorner> sorted(corners.size());
  for (const RawCorner& corner : corners) sorted[next[bin(corner)]++] = corner;
  return sorted;
}

/// Selects at most `quota` corners of a level. Choosing the strongest alone would crowd them where contrast
/// is high; choosing the same number from every cell would keep many weak ones that the next image does not
/// show again. So the n-th corner of a cell counts with its contrast / n.
std::vector<RawCorner> distribute_evenly(std::span<const RawCorner> corners, const cv::Size& size,
                                         size_t quota, int cell_px) {
  const int columns = size.width / cell_px + 1, rows = size.height / cell_px + 1;
  std::vector<int> taken(static_cast<size_t>(columns) * static_cast<size_t>(rows));
  const auto cell_of = [&](const RawCorner& corner) {
    return static_cast<size_t>(corner.y / cell_px) * static_cast<size_t>(columns) +
           static_cast<size_t>(corner.x / cell_px);
  };
  std::vector<RawCorner> sorted = sort_by_score(corners);
  if (sorted.size() <= quota) return sorted;
  std::vector<float> priorities;
  for (const RawCorner& corner : sorted) {
    const int rank = ++taken[cell_of(corner)];
    priorities.push_back(static_cast<float>(corner.contrast) / static_cast<float>(rank));
  }
  std::vector<float> highest = priorities;
  std::nth_element(highest.begin(), highest.begin() + static_cast<long>(quota), highest.end(),
                   std::greater<>());
  const float limit = highest[quota];  // first one beyond the quota
  std::vector<RawCorner> picked;
  for (size_t i = 0; i < sorted.size(); ++i) {
    if (priorities[i] > limit) picked.push_back(sorted[i]);
  }
  for (size_t i = 0; i < sorted.size() && picked.size() < quota; ++i) {
    if (priorities[i] == limit) picked.push_back(sorted[i]);
  }
  return picked;
}

}  // namespace

std::vector<cv::Mat> build_pyramid(const cv::Mat& gray, const FeatureOptions& options) {
  constexpr int kMinSide = 2 * kBorder + kMinCornerWidth;
  std::vector<cv::Mat> pyramid{gray};
  for (int level = 1; level < options.levels; ++level) {
    const double scale = std::pow(options.scale_factor, -level);
    const cv::Size size(cvRound(gray.cols * scale), cvRound(gray.rows * scale));
    if (std::min(size.width, size.height) < kMinSide) break;
    cv::Mat smaller;
    cv::resize(pyramid.back(), smaller, size, 0, 0, cv::INTER_LINEAR);
    pyramid.push_back(smaller);
  }
  return pyramid;
}

std::vector<Corner> detect_corners(const std::vector<cv::Mat>& pyramid, const FeatureOptions& options) {
  const auto quota = quota_per_level(options);
  std::vector<Corner> all;
  for (size_t level = 0; level < pyramid.size(); ++level) {
    const cv::Mat& image = pyramid[level];
    const auto corners = find_corners(image, options.fast_threshold, kBorder);
    const auto level_quota = static_cast<size_t>(quota[level]);
    for (const RawCorner& corner : distribute_evenly(corners, image.size(), level_quota, options.cell_px)) {
      all.push_back({static_cast<int>(level), corner.x, corner.y, corner.dx, corner.dy,
                     orientation_deg(image, corner.x, corner.y)});
    }
  }
  return all;
}

}  // namespace kinloop
