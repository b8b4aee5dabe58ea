#include "apps/shared/files/recorder.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "drivers/datasets/tum_writer.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/output_file.hpp"
#include "kinloop/sensor/camera/registration.hpp"
#include "tools/export/mcap/recording.hpp"

namespace kinloop {
namespace {

class TumFrameWriter : public FrameWriter {
 public:
  TumFrameWriter(const std::filesystem::path& folder, const RgbdCamera& camera) : writer_(folder, camera) {}

  std::function<void()> prepare(const Frame& frame) override {
    writer_.write_images(frame);
    return [this, frame] { writer_.add_to_lists(frame); };
  }
  void finish(const Trajectory& ground_truth) override { writer_.finish(ground_truth); }

 private:
  TumWriter writer_;
};

class McapFrameWriter : public FrameWriter {
 public:
  McapFrameWriter(const std::filesystem::path& path, const RgbdCamera& camera)
      : recording_(path, camera), depth_scale_(camera.depth_scale) {}

  std::function<void()> prepare(const Frame& frame) override {
    const auto compressed = std::make_shared<const CompressedFrame>(compress_frame(frame, depth_scale_));
    return [this, compressed] { recording_.write(*compressed); };
  }
  void finish(const Trajectory&) override { recording_.commit(); }

 private:
  FrameRecording recording_;
  double depth_scale_;
};

}  // namespace

std::unique_ptr<FrameWriter> make_frame_writer(const std::filesystem::path& path, const RgbdCamera& camera) {
  if (path.extension() != ".mcap") return std::make_unique<TumFrameWriter>(path, camera);
  clear_abandoned_files(path.parent_path());
  std::error_code ignored;
  if (std::filesystem::exists(path, ignored))
    throw InputError(
        fmt::format("{}: already exists; choose another name, or remove it first", path.string()));
  return std::make_unique<McapFrameWriter>(path, camera);
}

Recorder::Recorder(const std::filesystem::path& path, const RgbdCamera& camera, int threads)
    : writer_(make_frame_writer(path, registered(camera))) {
  for (int i = 0; i < threads; ++i)
    threads_.emplace_back([this](const std::stop_token& stop) { work(stop); });
}

Recorder::~Recorder() {
  for (auto& thread : threads_) thread.request_stop();
}

void Recorder::add(Frame frame) {
  Lock lock(mutex_);
  rethrow();
  changed_.wait(lock, [&] { return unwritten() < kMaxQueued || error_; });
  queue_.push_back(std::move(frame));
  ++added_;
  max_queued_ = std::max(max_queued_, unwritten());
  changed_.notify_all();
}

void Recorder::finish(const Trajectory& ground_truth) {
  {
    Lock lock(mutex_);
    changed_.wait(lock, [&] { return unwritten() == 0 || error_; });
    rethrow();
  }
  writer_->finish(ground_truth);
}

void Recorder::work(const std::stop_token& stop) {
  Lock lock(mutex_);
  while (changed_.wait(lock, stop, [&] { return !queue_.empty(); })) {
    const Frame frame = std::move(queue_.front());
    queue_.pop_front();
    const size_t number = taken_++;
    lock.unlock();
    std::function<void()> rest;
    std::exception_ptr error;
    try {
      rest = writer_->prepare(frame);
    } catch (...) {
      error = std::current_exception();
    }
    lock.lock();
    if (error && !error_) error_ = error;
    if (!error) prepared_.emplace(number, std::move(rest));
    write_in_order(lock);
    changed_.notify_all();
  }
}

/// One thread writes at a time, whatever the others have prepared meanwhile.
void Recorder::write_in_order(Lock& lock) {
  if (writing_) return;
  writing_ = true;
  while (!error_ && !prepared_.empty() && prepared_.begin()->first == written_) {
    const auto write = std::move(prepared_.begin()->second);
    prepared_.erase(prepared_.begin());
    lock.unlock();
    std::exception_ptr error;
    try {
      write();
    } catch (...) {
      error = std::current_exception();
    }
    lock.lock();
    if (error) error_ = error;
    ++written_;
    changed_.notify_all();
  }
  writing_ = false;
}

void Recorder::rethrow() {
  if (error_) std::rethrow_exception(error_);
}

}  // namespace kinloop
