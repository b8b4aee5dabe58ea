#pragma once
// The frames that a source skipped: of a bad file or a long live run there may be millions.

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace kinloop {

/// A frame that was skipped, and why.
struct SkippedFrame {
  std::string name;
  std::string reason;
};

/// Keeps the first ones and counts them all. Iterates over those kept.
class SkippedFrames {
 public:
  static constexpr size_t kKept = 100;

  /// Adds a frame `count` times.
  void add(const SkippedFrame& frame, size_t count = 1) {
    total_ += count;
    for (size_t i = 0; i < count && first_.size() < kKept; ++i) first_.push_back(frame);
  }

  void add(const SkippedFrames& others) {
    for (const SkippedFrame& frame : others.first_) add(frame);
    total_ += others.size() - others.first_.size();
  }

  void clear() { *this = {}; }

  /// Number of all, not only of those kept.
  [[nodiscard]] size_t size() const { return total_; }
  [[nodiscard]] bool empty() const { return total_ == 0; }
  [[nodiscard]] const SkippedFrame& front() const { return first_.front(); }
  [[nodiscard]] auto begin() const { return first_.begin(); }
  [[nodiscard]] auto end() const { return first_.end(); }

 private:
  std::vector<SkippedFrame> first_;
  size_t total_ = 0;
};

}  // namespace kinloop
