#pragma once
// In: colour and depth images that come one by one, each in order of time. Out: frames of those that belong
// together.

#include <cstdint>
#include <deque>
#include <optional>

#include <opencv2/core/mat.hpp>

#include "kinloop/base/association.hpp"
#include "kinloop/sensor/rgbd_frame.hpp"

namespace kinloop {

/// Gives each colour image the depth image nearest in time, each used once. A frame is ready when no depth
/// that could still come is nearer. Images that come late (a stamp not after the one before of their kind) or
/// find no partner are counted and forgotten.
class FramePairer {
 public:
  explicit FramePairer(int64_t max_difference_ns = kMaxAssociationNs)
      : max_difference_ns_(max_difference_ns) {}

  void add_color(int64_t stamp_ns, cv::Mat image);
  void add_depth(int64_t stamp_ns, cv::Mat depth_m, cv::Mat infrared = {});

  /// No more images will come: what is left is paired as well as it can be.
  void finish() { finished_ = true; }

  /// The next frame in order of time, numbered from 0; nothing while none is ready.
  std::optional<RgbdFrame> next();

  /// Images without a partner so far.
  [[nodiscard]] size_t unpaired() const { return unpaired_; }
  /// Images that came with a stamp not after the one before.
  [[nodiscard]] size_t out_of_order() const { return out_of_order_; }

 private:
  struct Stamped {
    int64_t stamp_ns = 0;
    cv::Mat image;
    cv::Mat infrared = {};  ///< of depth, where there is one
  };
  using Queue = std::deque<Stamped>;

  void add(Queue& queue, std::optional<int64_t>& newest_ns, Stamped image);
  void drop_front(Queue& queue);

  int64_t max_difference_ns_;
  Queue colors_, depths_;
  std::optional<int64_t> newest_color_ns_, newest_depth_ns_;
  bool finished_ = false;
  uint32_t next_id_ = 0;
  size_t unpaired_ = 0, out_of_order_ = 0;
};

}  // namespace kinloop
