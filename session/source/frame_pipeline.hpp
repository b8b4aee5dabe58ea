#pragma once
// Decodes the frames of a source and prepares them for tracking, ahead of time on a separate thread.

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>

#include "kinloop/sensor/source/frame_source.hpp"
#include "kinloop/tracking/front_end.hpp"

namespace kinloop {

/// A bounded queue between one producing and one consuming thread. Blocks the producer when full and the
/// consumer when empty; `close()` releases both permanently.
template <class T>
class Channel {
 public:
  explicit Channel(size_t capacity) : capacity_(capacity) {}

  /// Returns false if the channel was closed before the value could be queued.
  bool push(T value) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return closed_ || queue_.size() < capacity_; });
    if (closed_) return false;
    queue_.push_back(std::move(value));
    changed_.notify_all();
    return true;
  }

  /// Returns the next value, or nullopt once the channel is closed and drained.
  std::optional<T> pop() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return closed_ || !queue_.empty(); });
    if (queue_.empty()) return std::nullopt;
    T value = std::move(queue_.front());
    queue_.pop_front();
    changed_.notify_all();
    return value;
  }

  void close() {
    const std::lock_guard lock(mutex_);
    closed_ = true;
    changed_.notify_all();
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<T> queue_;
  size_t capacity_;
  bool closed_ = false;
};

/// Runs `source.next()` and `FrontEnd::prepare()` ahead of `Slam::process()`, so that they overlap. Keeps the
/// frames and order of the source. Rethrows its exceptions in `next`.
class FramePipeline {
 public:
  static constexpr size_t kFramesAhead = 4;

  /// `source` must outlive this object and must not be used elsewhere meanwhile.
  FramePipeline(FrameSource& source, const FrontEnd& front_end);
  ~FramePipeline();
  FramePipeline(const FramePipeline&) = delete;
  FramePipeline& operator=(const FramePipeline&) = delete;

  /// Returns the next frame, or nothing at the end of the source.
  std::optional<Frame> next();

  /// Sets whether features are extracted ahead: if tracking needs them anyway, they should not wait for it.
  /// Affects time only; tracking extracts what is missing.
  void extract_features_ahead(bool wanted) { features_wanted_ = wanted; }

 private:
  void run_ahead();

  FrameSource& source_;
  const FrontEnd front_end_;
  std::atomic<bool> features_wanted_ = true;
  Channel<Frame> frames_;
  std::exception_ptr error_;  // written before the channel is closed, read after it is drained
  std::jthread thread_;
};

}  // namespace kinloop
