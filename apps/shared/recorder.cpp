#include "apps/shared/recorder.hpp"

#include <algorithm>

#include "kinloop/sensor/registration.hpp"

namespace kinloop {

Recorder::Recorder(const std::filesystem::path& folder, const RgbdCamera& camera, int threads)
    : writer_(folder, registered(camera)) {
  for (int i = 0; i < threads; ++i)
    threads_.emplace_back([this](const std::stop_token& stop) { work(stop); });
}

Recorder::~Recorder() {
  for (auto& thread : threads_) thread.request_stop();
}

void Recorder::add(RgbdFrame frame) {
  std::unique_lock lock(mutex_);
  rethrow();
  changed_.wait(lock, [&] { return queue_.size() < kMaxQueued || error_; });
  writer_.add_to_lists(frame);
  queue_.push_back(std::move(frame));
  max_queued_ = std::max(max_queued_, queue_.size());
  changed_.notify_all();
}

void Recorder::finish(const Trajectory& ground_truth) {
  {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return (queue_.empty() && in_progress_ == 0) || error_; });
    rethrow();
  }
  writer_.finish(ground_truth);
}

void Recorder::work(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (changed_.wait(lock, stop, [&] { return !queue_.empty(); })) {
    const RgbdFrame frame = std::move(queue_.front());
    queue_.pop_front();
    ++in_progress_;
    lock.unlock();
    std::exception_ptr error;
    try {
      writer_.write_images(frame);
    } catch (...) {
      error = std::current_exception();
    }
    lock.lock();
    --in_progress_;
    if (error && !error_) error_ = error;
    changed_.notify_all();
  }
}

void Recorder::rethrow() {
  if (error_) std::rethrow_exception(error_);
}

}  // namespace kinloop
