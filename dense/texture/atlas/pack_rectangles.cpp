#include <algorithm>
#include <numeric>

#include "dense/texture/atlas/atlas_layout.hpp"

namespace kinloop {
namespace {

/// The lower border of what is placed, as steps from left to right.
class Skyline {
 public:
  explicit Skyline(int width) : width_(width), steps_{{0, 0, width}} {}

  /// Returns the corner of a rectangle placed where it ends uppermost.
  cv::Point place(const cv::Size& size) {
    size_t best = 0;
    int best_y = -1;
    for (size_t i = 0; i < steps_.size() && steps_[i].x + size.width <= width_; ++i) {
      const int y = lowest_under(i, size.width);
      if (best_y < 0 || y < best_y) best = i, best_y = y;
    }
    const cv::Point corner(steps_[best].x, best_y);
    raise(best, {corner.x, best_y + size.height, size.width});
    return corner;
  }

  [[nodiscard]] int height() const {
    int height = 0;
    for (const Step& step : steps_) height = std::max(height, step.y);
    return height;
  }

 private:
  struct Step {
    int x, y, width;
  };

  /// The lowest point of the skyline over this width from the left of step `i`.
  [[nodiscard]] int lowest_under(size_t i, int width) const {
    int y = 0;
    for (const int end = steps_[i].x + width; i < steps_.size() && steps_[i].x < end; ++i)
      y = std::max(y, steps_[i].y);
    return y;
  }

  /// Inserts a step before `index` and cuts off what it covers.
  void raise(size_t index, const Step& raised) {
    const int end = raised.x + raised.width;
    size_t covered = index;
    while (covered < steps_.size() && steps_[covered].x + steps_[covered].width <= end) ++covered;
    if (covered < steps_.size() && steps_[covered].x < end) {
      steps_[covered].width -= end - steps_[covered].x;
      steps_[covered].x = end;
    }
    const auto at = [&](size_t i) { return steps_.begin() + static_cast<std::ptrdiff_t>(i); };
    steps_.erase(at(index), at(covered));
    steps_.insert(at(index), raised);
    merge_with_next(index);
    if (index > 0) merge_with_next(index - 1);
  }

  void merge_with_next(size_t i) {
    if (i + 1 >= steps_.size() || steps_[i].y != steps_[i + 1].y) return;
    steps_[i].width += steps_[i + 1].width;
    steps_.erase(steps_.begin() + static_cast<std::ptrdiff_t>(i) + 1);
  }

  int width_;
  std::vector<Step> steps_;
};

}  // namespace

std::optional<PackedRectangles> pack_rectangles(std::span<const cv::Size> sizes, int width) {
  std::vector<size_t> order(sizes.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](size_t a, size_t b) { return sizes[a].height > sizes[b].height; });
  PackedRectangles packed;
  packed.corners.resize(sizes.size());
  Skyline skyline(width);
  for (const size_t i : order) {
    if (sizes[i].width > width) return std::nullopt;
    packed.corners[i] = skyline.place(sizes[i]);
  }
  packed.height = skyline.height();
  return packed;
}

}  // namespace kinloop
