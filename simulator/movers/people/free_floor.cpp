#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "simulator/movers/people/walk_plan.hpp"

namespace kinloop::sim {
namespace {

constexpr float kStepOver_m = 0.03F;  // a rug, a threshold
constexpr float kPersonTop_m = 1.95F;

}  // namespace

FreeFloor::FreeFloor(const Parts& room, const Eigen::Vector3f& size_m, float radius_m)
    : half_(size_m.head<2>().cast<double>() / 2), radius_m_(static_cast<double>(radius_m)) {
  const auto count = [](double length_m) { return std::max(1, static_cast<int>(length_m / kCell_m)); };
  free_ = cv::Mat(count(2 * half_.y()), count(2 * half_.x()), CV_8UC1, cv::Scalar(255));
  for (const Primitive& part : room) {
    const Eigen::AlignedBox3f box = bounds(part);
    if (box.max().z() < kStepOver_m || box.min().z() > kPersonTop_m) continue;
    block({box.min().head<2>(), box.max().head<2>()});
  }
}

cv::Point FreeFloor::cell_of(const Eigen::Vector2d& p) const {
  return {static_cast<int>(std::floor((p.x() + half_.x()) / kCell_m)),
          static_cast<int>(std::floor((p.y() + half_.y()) / kCell_m))};
}

void FreeFloor::block(const Eigen::AlignedBox2f& area) {
  const cv::Point low = cell_of(area.min().cast<double>().array() - radius_m_);
  const cv::Point high = cell_of(area.max().cast<double>().array() + radius_m_);
  const cv::Rect cells = cv::Rect(low, high + cv::Point(1, 1)) & cv::Rect({0, 0}, free_.size());
  if (!cells.empty()) free_(cells).setTo(0);
}

bool FreeFloor::is_free(const Eigen::Vector2d& p) const {
  const cv::Point cell = cell_of(p);
  return cv::Rect({0, 0}, free_.size()).contains(cell) && free_.at<uint8_t>(cell) != 0;
}

bool FreeFloor::is_free(const Eigen::Vector2d& from, const Eigen::Vector2d& to) const {
  const int steps = 1 + static_cast<int>((to - from).norm() / (kCell_m / 4));
  for (int i = 0; i <= steps; ++i) {
    if (!is_free(Eigen::Vector2d(from + static_cast<double>(i) / steps * (to - from)))) return false;
  }
  return true;
}

std::vector<Eigen::Vector2d> FreeFloor::largest_region() const {
  cv::Mat labels, stats, centroids;
  constexpr int kEdgesOnly = 4;
  const int count = cv::connectedComponentsWithStats(free_, labels, stats, centroids, kEdgesOnly);
  int largest = 0;  // 0 is what is not free
  for (int i = 1; i < count; ++i) {
    const auto area = [&](int label) { return stats.at<int>(label, cv::CC_STAT_AREA); };
    if (largest == 0 || area(i) > area(largest)) largest = i;
  }
  std::vector<Eigen::Vector2d> middles;
  for (int y = 0; largest > 0 && y < labels.rows; ++y) {
    for (int x = 0; x < labels.cols; ++x) {
      if (labels.at<int>(y, x) != largest) continue;
      middles.emplace_back((x + 0.5) * kCell_m - half_.x(), (y + 0.5) * kCell_m - half_.y());
    }
  }
  return middles;
}

}  // namespace kinloop::sim
