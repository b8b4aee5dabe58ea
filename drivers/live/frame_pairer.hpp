#pragma once
// In: colour and depth images that arrive one by one, each in order of time. Out: associated frames.

#include <cstdint>
#include <deque>
#include <optional>

#include <opencv2/core/mat.hpp>

#include "kinloop/core/association.hpp"
#include "kinloop/sensor/frame.hpp"

namespace kinloop {

/// Pairs each colour image with the depth image nearest in time, each used once. A frame is ready when no
/// depth image still to come can be nearer. Images that arrive out of order (a stamp not after the previous
/// one of their kind) or find no partner are counted and dropped.
class FramePairer {
 public:
  static constexpr size_t kMaxQueued = 30;  ///< one second: then the other stream has ended or never began

  /// At most `max_queued` images of one kind wait for the other.
  explicit FramePairer(int64_t max_difference_ns = kMaxAssociationNs, size_t max_queued = kMaxQueued)
      : max_difference_ns_(max_difference_ns), max_queued_(max_queued) {}

  /// `mask` is Frame::mask.
  void add_color(int64_t stamp_ns, ColorImage image, cv::Mat mask = {});
  void add_depth(int64_t stamp_ns, cv::Mat depth_m, cv::Mat infrared = {});

  /// Adds images that are known to belong together, whatever the stamp of depth. `mask` is Frame::mask.
  void add_pair(int64_t stamp_ns, ColorImage image, int64_t depth_stamp_ns, cv::Mat depth_m,
                cv::Mat mask = {});

  /// No more images will arrive: pairs the remaining ones as far as possible.
  void finish() { finished_ = true; }

  /// Returns the next frame in order of time, numbered from 0; nullopt if none is ready.
  std::optional<Frame> next();

  /// Number of images without a partner so far.
  [[nodiscard]] size_t unpaired() const { return unpaired_; }
  /// Number of images with a stamp not after the previous one.
  [[nodiscard]] size_t out_of_order() const { return out_of_order_; }

 private:
  /// A colour image with its mask, or a depth image with its infrared image, if available.
  struct Stamped {
    int64_t stamp_ns = 0;     ///< by which it is paired
    int64_t measured_ns = 0;  ///< its own
    ColorImage color;
    cv::Mat depth_m = {}, infrared = {}, mask = {};
  };
  using Queue = std::deque<Stamped>;

  void add(Queue& queue, std::optional<int64_t>& newest_ns, Stamped image);
  void drop_front(Queue& queue);

  int64_t max_difference_ns_;
  size_t max_queued_;
  Queue colors_, depths_;
  std::optional<int64_t> newest_color_ns_, newest_depth_ns_;
  bool finished_ = false;
  uint32_t next_id_ = 0;
  size_t unpaired_ = 0, out_of_order_ = 0;
};

}  // namespace kinloop
