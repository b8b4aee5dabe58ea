#include "kinloop/sensor/prefetch_source.hpp"

#include <algorithm>

#include "kinloop/base/errors.hpp"

namespace kinloop {

PrefetchSource::PrefetchSource(std::unique_ptr<FrameSource> source, size_t frames_ahead)
    : source_(std::move(source)), steps_(std::max<size_t>(frames_ahead, 1)) {
  require(source_ != nullptr, "PrefetchSource: no source");
  skipped_ = source_->skipped();
  thread_ = std::jthread([this] { read_ahead(); });
}

PrefetchSource::~PrefetchSource() {
  steps_.close();
}

std::optional<RgbdFrame> PrefetchSource::next() {
  std::optional<Step> step = steps_.pop();
  if (!step) return std::nullopt;
  if (step->error) std::rethrow_exception(step->error);
  const std::lock_guard lock(skipped_mutex_);
  skipped_ = std::move(step->skipped);
  return std::move(step->frame);
}

std::vector<SkippedFrame> PrefetchSource::skipped() const {
  const std::lock_guard lock(skipped_mutex_);
  return skipped_;
}

void PrefetchSource::read_ahead() {
  for (bool more = true; more;) {
    Step step;
    try {
      step.frame = source_->next();
      step.skipped = source_->skipped();
    } catch (...) {
      step.error = std::current_exception();
    }
    more = step.frame.has_value();
    if (!steps_.push(std::move(step))) return;
  }
  steps_.close();
}

}  // namespace kinloop
