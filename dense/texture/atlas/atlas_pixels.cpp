#include <algorithm>
#include <utility>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "dense/texture/atlas/paint_atlas.hpp"

namespace kinloop {
namespace {

/// Gives pixels without an owner one of a neighbour.
void grow(cv::Mat& owners) {
  const cv::Mat before = owners.clone();
  for (int row = 0; row < owners.rows; ++row) {
    for (int col = 0; col < owners.cols; ++col) {
      auto& owner = owners.at<int32_t>(row, col);
      if (owner != kNobody) continue;
      for (const auto& [down, right] :
           {std::pair(0, -1), std::pair(0, 1), std::pair(-1, 0), std::pair(1, 0)}) {
        const int r = row + down, c = col + right;
        if (r < 0 || c < 0 || r >= owners.rows || c >= owners.cols) continue;
        owner = std::max(owner, before.at<int32_t>(r, c));
      }
    }
  }
}

}  // namespace

cv::Rect pixels_around(const AtlasLayout& layout, uint32_t triangle, int margin_px) {
  Eigen::Array2f low = layout.corners_px[layout.triangles[triangle][0]], high = low;
  for (const uint32_t corner : layout.triangles[triangle]) {
    low = low.min(layout.corners_px[corner].array());
    high = high.max(layout.corners_px[corner].array());
  }
  const Eigen::Array2i first = low.floor().cast<int>() - margin_px,
                       last = high.ceil().cast<int>() + margin_px;
  return cv::Rect(cv::Point(first.x(), first.y()), cv::Point(last.x() + 1, last.y() + 1)) &
         cv::Rect({}, layout.size);
}

cv::Mat pixel_owners(const AtlasLayout& layout) {
  constexpr float kRounding = -1e-4F;
  cv::Mat owners(layout.size, CV_32SC1, cv::Scalar(kNobody));
  for (uint32_t i = 0; i < layout.triangles.size(); ++i) {
    const Barycentric shares(layout, i);
    const cv::Rect box = pixels_around(layout, i, 0);
    for (int row = box.y; row < box.br().y; ++row) {
      for (int col = box.x; col < box.br().x; ++col) {
        auto& owner = owners.at<int32_t>(row, col);
        const bool inside =
            shares.at(static_cast<float>(col), static_cast<float>(row)).minCoeff() >= kRounding;
        if (owner == kNobody && inside) owner = static_cast<int32_t>(i);
      }
    }
  }
  for (int i = 0; i < kAtlasMarginPx; ++i) grow(owners);
  return owners;
}

void fill_gaps(cv::Mat& image, const cv::Mat& painted) {
  const double share = cv::mean(painted)[0];
  if (share == 0 || std::min(image.cols, image.rows) <= 1) return;
  image.setTo(cv::Scalar::all(0), painted == 0);
  const cv::Size half((image.cols + 1) / 2, (image.rows + 1) / 2);
  cv::Mat small, weight;
  cv::resize(image, small, half, 0, 0, cv::INTER_AREA);
  cv::resize(painted, weight, half, 0, 0, cv::INTER_AREA);
  for (int row = 0; row < half.height; ++row) {
    for (int col = 0; col < half.width; ++col) {
      const int w = weight.at<uint8_t>(row, col);
      if (w == 0) continue;
      for (int k = 0; k < 3; ++k) {
        auto& value = small.at<cv::Vec3b>(row, col)[k];
        value = cv::saturate_cast<uint8_t>(value * 255 / w);
      }
    }
  }
  const cv::Mat known = weight > 0;
  fill_gaps(small, known);
  cv::Mat filling;
  cv::resize(small, filling, image.size(), 0, 0, cv::INTER_LINEAR);
  filling.copyTo(image, painted == 0);
}

}  // namespace kinloop
