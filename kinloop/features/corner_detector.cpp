#include "kinloop/features/corner_detector.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

#include <opencv2/imgproc.hpp>

#include "kinloop/features/kernels/corner_scores.hpp"
#include "kinloop/features/kernels/gaussian_blur.hpp"
#include "kinloop/features/kernels/orientation.hpp"
#include "kinloop/features/kernels/steered_brief.hpp"

namespace kinloop {
namespace {

/// What is read around a corner must lie inside the level: the compared pixels, where they are smoothed, and
/// the disc of its direction.
constexpr int kBorder = std::max(kBriefReach + kBlurRadius, kDiscReach);

/// Key points of each level: in proportion to the level's side length, as in ORB.
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

/// By strength; ties in reading order.
bool stronger(const RawCorner& a, const RawCorner& b) {
  if (a.contrast != b.contrast) return a.contrast > b.contrast;
  return a.y != b.y ? a.y < b.y : a.x < b.x;
}

/// Sorts the corners of a level into cells, each in order of strength. Where a cell has corners above the
/// usual threshold, the weaker ones are left out.
std::vector<std::vector<RawCorner>> sort_into_cells(std::span<const RawCorner> corners, const cv::Size& size,
                                                    const FeatureOptions& options) {
  const int width = size.width - 2 * kBorder, height = size.height - 2 * kBorder;
  const int columns = std::max(1, width / options.cell_px), rows = std::max(1, height / options.cell_px);
  std::vector<std::vector<RawCorner>> cells(static_cast<size_t>(columns * rows));
  for (const RawCorner& corner : corners) {
    const int column = (corner.x - kBorder) * columns / width, row = (corner.y - kBorder) * rows / height;
    cells[static_cast<size_t>(row * columns + column)].push_back(corner);
  }
  for (auto& cell : cells) {
    std::sort(cell.begin(), cell.end(), stronger);
    const auto weak = std::find_if(cell.begin(), cell.end(), [&](const RawCorner& corner) {
      return corner.contrast <= options.fast_threshold;
    });
    if (weak != cell.begin()) cell.erase(weak, cell.end());
  }
  return cells;
}

/// Takes the strongest corner of every cell, then the second strongest, and so on until `quota` is reached.
std::vector<RawCorner> pick_evenly(const std::vector<std::vector<RawCorner>>& cells, size_t quota) {
  std::vector<RawCorner> picked;
  for (size_t rank = 0; picked.size() < quota; ++rank) {
    std::vector<RawCorner> round;
    for (const auto& cell : cells) {
      if (rank < cell.size()) round.push_back(cell[rank]);
    }
    if (round.empty()) break;
    std::sort(round.begin(), round.end(), stronger);
    round.resize(std::min(quota - picked.size(), round.size()));
    picked.insert(picked.end(), round.begin(), round.end());
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
    cv::resize(pyramid.back(), smaller, size, 0, 0, cv::INTER_LINEAR_EXACT);
    pyramid.push_back(smaller);
  }
  return pyramid;
}

std::vector<Corner> detect_corners(const std::vector<cv::Mat>& pyramid, const FeatureOptions& options) {
  const auto quota = quota_per_level(options);
  std::vector<Corner> all;
  for (size_t level = 0; level < pyramid.size(); ++level) {
    const cv::Mat& image = pyramid[level];
    const auto corners = find_corners(image, options.min_fast_threshold, kBorder);
    const auto cells = sort_into_cells(corners, image.size(), options);
    for (const RawCorner& corner : pick_evenly(cells, static_cast<size_t>(quota[level]))) {
      all.push_back({static_cast<int>(level), corner.x, corner.y, static_cast<float>(corner.contrast),
                     orientation_deg(image, corner.x, corner.y)});
    }
  }
  return all;
}

}  // namespace kinloop
