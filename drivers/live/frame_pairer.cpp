#include "drivers/live/frame_pairer.hpp"

#include <cstdlib>

namespace kinloop {

void FramePairer::add_color(int64_t stamp_ns, ColorImage image, cv::Mat mask) {
  add(colors_, newest_color_ns_, {stamp_ns, stamp_ns, std::move(image), {}, {}, std::move(mask)});
}

void FramePairer::add_depth(int64_t stamp_ns, cv::Mat depth_m, cv::Mat infrared) {
  add(depths_, newest_depth_ns_, {stamp_ns, stamp_ns, {}, std::move(depth_m), std::move(infrared)});
}

void FramePairer::add_pair(int64_t stamp_ns, ColorImage image, int64_t depth_stamp_ns, cv::Mat depth_m,
                           cv::Mat mask) {
  add(depths_, newest_depth_ns_, {stamp_ns, depth_stamp_ns, {}, std::move(depth_m)});
  add(colors_, newest_color_ns_, {stamp_ns, stamp_ns, std::move(image), {}, {}, std::move(mask)});
}

void FramePairer::add(Queue& queue, std::optional<int64_t>& newest_ns, Stamped image) {
  if (newest_ns && image.stamp_ns <= *newest_ns) {
    ++out_of_order_;
    return;
  }
  newest_ns = image.stamp_ns;
  queue.push_back(std::move(image));
  if (queue.size() > max_queued_) drop_front(queue);
}

void FramePairer::drop_front(Queue& queue) {
  queue.pop_front();
  ++unpaired_;
}

std::optional<Frame> FramePairer::next() {
  while (!colors_.empty()) {
    const int64_t stamp_ns = colors_.front().stamp_ns;
    const auto distance = [&](size_t i) { return std::abs(depths_[i].stamp_ns - stamp_ns); };
    while (depths_.size() > 1 && distance(1) <= distance(0)) drop_front(depths_);
    // The nearest so far is at the front; a later one could be nearer until one later than it, or than the
    // colour image, has arrived.
    const bool settled =
        finished_ || depths_.size() > 1 || (newest_depth_ns_ && *newest_depth_ns_ >= stamp_ns);
    if (!settled) return std::nullopt;
    if (depths_.empty() || distance(0) > max_difference_ns_) {
      drop_front(colors_);
      continue;
    }
    // The next colour image may be nearer to this depth image.
    const bool rival = colors_.size() > 1;
    if (!rival && !finished_ && depths_.front().stamp_ns > stamp_ns) return std::nullopt;
    if (rival && std::abs(depths_.front().stamp_ns - colors_[1].stamp_ns) < distance(0)) {
      drop_front(colors_);
      continue;
    }
    Frame frame{FrameId{next_id_++},
                stamp_ns,
                std::move(colors_.front().color),
                std::move(depths_.front().depth_m),
                std::move(depths_.front().infrared),
                depths_.front().measured_ns,
                std::move(colors_.front().mask)};
    colors_.pop_front();
    depths_.pop_front();
    return frame;
  }
  return std::nullopt;
}

}  // namespace kinloop
