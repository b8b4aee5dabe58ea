// Furniture away from the walls.

#include <algorithm>
#include <cmath>
#include <numbers>

#include <opencv2/imgproc.hpp>

#include "simulator/room/room_layout.hpp"

namespace kinloop::sim {
namespace {

constexpr float kCell_m = 0.1F;
constexpr float kQuarter = std::numbers::pi_v<float> / 2;

int cells(float length_m) {
  return static_cast<int>(std::ceil(length_m / kCell_m));
}

}  // namespace

/// How often the optical axis passes over every cell of the floor, within the range of good depth and low
/// enough to hit furniture, as an integral image, so that rectangles are summed at once.
cv::Mat RoomLayout::view_count_integral() const {
  constexpr float kNear_m = 0.8F, kFar_m = 2.6F, kHighest_m = 1.2F;
  cv::Mat counts = cv::Mat::zeros(cells(size_m_.y()), cells(size_m_.x()), CV_32FC1);
  for (size_t i = 0; i < path_.size(); ++i) {
    for (float range = kNear_m; range < kFar_m; range += kCell_m) {
      const Eigen::Vector3f p = path_[i] + range * view_[i];
      const cv::Point cell(cells(p.x() + size_m_.x() / 2) - 1, cells(p.y() + size_m_.y() / 2) - 1);
      if (p.z() < kHighest_m && cell.inside({0, 0, counts.cols, counts.rows})) counts.at<float>(cell) += 1;
    }
  }
  cv::Mat sums;
  cv::integral(counts, sums, CV_32F);
  return sums;
}

/// The free place for `piece`, in any of four orientations, that is viewed most often; empty if none is
/// viewed enough.
Parts RoomLayout::place_where_most_viewed(const Parts& piece, const cv::Mat& sums) const {
  constexpr float kStride_m = 2 * kCell_m, kMinViews = 60;
  constexpr double kMinViewingDistance_m = 0.5;  // nearer than the sensor's range
  float best_views = kMinViews;
  Parts best;
  const Eigen::Vector2f half = size_m_.head<2>() / 2;
  const auto sum_at = [&](float x, float y) {
    return sums.at<float>(std::clamp(cells(y + half.y()), 0, sums.rows - 1),
                          std::clamp(cells(x + half.x()), 0, sums.cols - 1));
  };
  for (int turn = 0; turn < 4; ++turn) {
    const Parts turned = moved(piece, kQuarter * static_cast<float>(turn), {0, 0, 0});
    const Eigen::AlignedBox3f box = bounds(turned);
    for (float y = -half.y() - box.min().y(); y + box.max().y() < half.y(); y += kStride_m) {
      for (float x = -half.x() - box.min().x(); x + box.max().x() < half.x(); x += kStride_m) {
        const float x0 = x + box.min().x(), x1 = x + box.max().x(), y0 = y + box.min().y(),
                    y1 = y + box.max().y();
        const float views = sum_at(x1, y1) - sum_at(x0, y1) - sum_at(x1, y0) + sum_at(x0, y0);
        if (views <= best_views) continue;
        Parts candidate = moved(turned, 0, {x, y, 0});
        if (!is_free(candidate, kMinViewingDistance_m)) continue;
        best_views = views;
        best = std::move(candidate);
      }
    }
  }
  return best;
}

/// Puts desks and tables where the camera looks most, until there is no free place or nothing left to view.
void RoomLayout::furnish_viewed_areas() {
  if (furnishing_ != Furnishing::kDense) return;
  const cv::Mat sums = view_count_integral();
  constexpr int kMaxPieces = 14;
  for (int i = 0; i < kMaxPieces; ++i) {
    const Parts placed = place_where_most_viewed(i % 3 != 2 ? builder_.desk() : builder_.low_table(), sums);
    if (!placed.empty()) add_floor_piece(placed);
  }
}

void RoomLayout::scatter_on_floor() {
  const auto anywhere = [&] {
    const float y = builder_.uniform(-0.48F, 0.48F) * size_m_.y();
    return Eigen::Vector3f(builder_.uniform(-0.48F, 0.48F) * size_m_.x(), y, 0);
  };
  const auto tries = static_cast<int>(4 * size_m_.x() * size_m_.y());
  const float per_m2 = furnishing_ == Furnishing::kDense ? 0.7F : 0.12F;
  const auto wanted = static_cast<int>(per_m2 * size_m_.x() * size_m_.y());
  for (int i = 0, placed = 0; i < tries && placed < wanted; ++i) {
    Parts piece;
    switch (random_.index(5)) {
      case 0:
        piece = builder_.ball();
        break;
      case 1:
        piece = builder_.bin();
        break;
      case 2:
        piece = builder_.carton_stack();
        break;
      case 3:
        piece = builder_.chair();
        break;
      default:
        piece = builder_.clutter({Eigen::Vector2f(-0.2F, -0.2F), Eigen::Vector2f(0.2F, 0.2F)}, 0, 0.18F);
    }
    const float yaw = builder_.uniform(0, 4 * kQuarter);
    const Parts standing = moved(piece, yaw, anywhere());
    if (piece.empty() || !is_free(standing)) continue;
    add_floor_piece(standing);
    ++placed;
  }
  // A rug lies under everything: only its rim shows where something stands on it.
  constexpr float kThick_m = 0.008F;
  const FaceTexture rug = builder_.palette().fitted(Kind::kRug, random_);
  const float depth = builder_.uniform(0.4F, 0.55F) * size_m_.y();
  const Eigen::Vector3f size(builder_.uniform(0.45F, 0.6F) * size_m_.x(), depth, kThick_m);
  parts_.push_back(with_picture(make_box({0, 0, kThick_m / 2}, size, rug), kTop, rug));
}

}  // namespace kinloop::sim
