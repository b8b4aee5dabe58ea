#include <chrono>
#include <utility>

#include "viewer/live/live_viewer.hpp"

namespace kinloop {

void RunControl::pause() {
  const std::lock_guard lock(mutex_);
  paused_ = true;
  steps_ = 0;
}

void RunControl::resume() {
  const std::lock_guard lock(mutex_);
  paused_ = false;
  changed_.notify_all();
}

void RunControl::step() {
  const std::lock_guard lock(mutex_);
  paused_ = true;
  ++steps_;
  changed_.notify_all();
}

void RunControl::request_save() {
  const std::lock_guard lock(mutex_);
  save_ = true;
  changed_.notify_all();
}

bool RunControl::paused() const {
  const std::lock_guard lock(mutex_);
  return paused_;
}

RunControl::Action RunControl::next_action(const std::function<bool()>& stop) {
  constexpr std::chrono::milliseconds kBetweenQuestions{100};
  std::unique_lock lock(mutex_);
  if (std::exchange(saving_, false)) saved_ = Clock::now();
  while (paused_ && steps_ == 0 && !save_ && !stop()) changed_.wait_for(lock, kBetweenQuestions);
  if (save_is_due()) {
    save_ = false;
    saving_ = true;
    return Action::kSaveMap;
  }
  if (steps_ > 0) --steps_;
  return Action::kProcessFrame;
}

bool RunControl::save_is_due() const {
  const bool waits = paused_ && steps_ == 0;
  return save_ && (waits || saved_ == Clock::time_point() || Clock::now() - saved_ >= between_saves_);
}

}  // namespace kinloop
