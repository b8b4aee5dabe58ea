#include "kinloop/features/corner_detector.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

namespace kinloop {
namespace {

constexpr int kPatchRadius = 15;           // of the ORB descriptor and its orientation, px of the level
constexpr int kBorder = kPatchRadius + 4;  // the rotated pattern reaches a little beyond the radius
constexpr int kFastRadius = 3;             // FAST looks at a circle of this radius

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

/// Corners of one cell; with the lower threshold where the usual one finds none.
std::vector<cv::KeyPoint> detect_in_cell(const cv::Mat& image, const cv::Rect& cell,
                                         const FeatureOptions& options) {
  std::vector<cv::KeyPoint> corners;
  const cv::Mat view = image(cell);
  cv::FAST(view, corners, options.fast_threshold, true);
  if (corners.empty()) cv::FAST(view, corners, options.min_fast_threshold, true);
  for (auto& corner : corners) corner.pt += cv::Point2f(cell.tl());
  // By strength; ties in reading order, so that the choice does not depend on the detector's order.
  std::sort(corners.begin(), corners.end(), [](const auto& a, const auto& b) {
    if (a.response != b.response) return a.response > b.response;
    return a.pt.y != b.pt.y ? a.pt.y < b.pt.y : a.pt.x < b.pt.x;
  });
  return corners;
}

/// Takes the strongest corner of every cell, then the second strongest, and so on until `quota` is reached.
std::vector<cv::KeyPoint> pick_evenly(const std::vector<std::vector<cv::KeyPoint>>& cells, int quota) {
  std::vector<cv::KeyPoint> picked;
  for (size_t rank = 0; static_cast<int>(picked.size()) < quota; ++rank) {
    std::vector<cv::KeyPoint> round;
    for (const auto& cell : cells) {
      if (rank < cell.size()) round.push_back(cell[rank]);
    }
    if (round.empty()) break;
    std::stable_sort(round.begin(), round.end(),
                     [](const auto& a, const auto& b) { return a.response > b.response; });
    const size_t room = static_cast<size_t>(quota) - picked.size();
    picked.insert(picked.end(), round.begin(),
                  round.begin() + static_cast<long>(std::min(room, round.size())));
  }
  return picked;
}

std::vector<cv::KeyPoint> detect_on_level(const cv::Mat& image, int quota, const FeatureOptions& options) {
  const cv::Rect inside(kBorder, kBorder, image.cols - 2 * kBorder, image.rows - 2 * kBorder);
  if (inside.width <= 0 || inside.height <= 0) return {};
  const int columns = std::max(1, inside.width / options.cell_px);
  const int rows = std::max(1, inside.height / options.cell_px);
  std::vector<std::vector<cv::KeyPoint>> cells;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const int x0 = inside.x + inside.width * column / columns,
                x1 = inside.x + inside.width * (column + 1) / columns;
      const int y0 = inside.y + inside.height * row / rows, y1 = inside.y + inside.height * (row + 1) / rows;
      // FAST leaves out a rim of its own radius, so neighbouring cells overlap by it and no corner is lost.
      const cv::Rect cell(x0 - kFastRadius, y0 - kFastRadius, x1 - x0 + 2 * kFastRadius,
                          y1 - y0 + 2 * kFastRadius);
      cells.push_back(detect_in_cell(image, cell, options));
    }
  }
  return pick_evenly(cells, quota);
}

/// Half widths of the rows of a disc of kPatchRadius.
std::vector<int> disc_half_widths() {
  std::vector<int> half_width;
  for (int v = 0; v <= kPatchRadius; ++v) {
    half_width.push_back(static_cast<int>(std::lround(std::sqrt(kPatchRadius * kPatchRadius - v * v))));
  }
  return half_width;
}

/// Direction from a corner to the intensity centroid of the disc around it, degrees (Rosin 1999; ORB Eq. 3).
float orientation_deg(const cv::Mat& image, const cv::Point2f& pixel, const std::vector<int>& half_width) {
  const int cx = cvRound(pixel.x), cy = cvRound(pixel.y);
  int m10 = 0, m01 = 0;
  for (int v = -kPatchRadius; v <= kPatchRadius; ++v) {
    const uchar* row = image.ptr<uchar>(cy + v) + cx;
    const int d = half_width[static_cast<size_t>(std::abs(v))];
    int row_sum = 0;
    for (int u = -d; u <= d; ++u) {
      m10 += u * row[u];
      row_sum += row[u];
    }
    m01 += v * row_sum;
  }
  return cv::fastAtan2(static_cast<float>(m01), static_cast<float>(m10));
}

}  // namespace

std::vector<cv::Mat> build_pyramid(const cv::Mat& gray, const FeatureOptions& options) {
  std::vector<cv::Mat> pyramid{gray};
  for (int level = 1; level < options.levels; ++level) {
    const double scale = std::pow(options.scale_factor, -level);
    const cv::Size size(cvRound(gray.cols * scale), cvRound(gray.rows * scale));
    if (std::min(size.width, size.height) < 2 * kBorder + 1) break;
    cv::Mat smaller;
    cv::resize(pyramid.back(), smaller, size, 0, 0, cv::INTER_LINEAR);
    pyramid.push_back(smaller);
  }
  return pyramid;
}

std::vector<cv::KeyPoint> detect_corners(const std::vector<cv::Mat>& pyramid, const FeatureOptions& options) {
  const auto quota = quota_per_level(options);
  const auto half_width = disc_half_widths();
  std::vector<cv::KeyPoint> all;
  for (size_t level = 0; level < pyramid.size(); ++level) {
    const auto scale = static_cast<float>(std::pow(options.scale_factor, static_cast<double>(level)));
    for (auto corner : detect_on_level(pyramid[level], quota[level], options)) {
      corner.angle = orientation_deg(pyramid[level], corner.pt, half_width);
      corner.octave = static_cast<int>(level);
      corner.size = static_cast<float>(2 * kPatchRadius + 1) * scale;
      corner.pt *= scale;
      all.push_back(corner);
    }
  }
  return all;
}

}  // namespace kinloop
