#pragma once
// What those who watch may ask of a run: to pause, to go on, to go one frame on, to save the map. The run
// asks what to do before every frame.

#include <condition_variable>
#include <functional>
#include <mutex>

namespace kinloop {

class RunControl {
 public:
  explicit RunControl(bool paused = false) : paused_(paused) {}

  void pause();
  void resume();
  void step();  ///< one frame, then pause
  void request_save();

  [[nodiscard]] bool paused() const;

  enum class Action { kProcessFrame, kSaveMap };

  /// What the run shall do next: take a frame, or save the map and ask again. Waits while it is paused, until
  /// `stop` (asked now and then) says that it shall end.
  Action next_action(const std::function<bool()>& stop);

 private:
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  bool paused_;
  int steps_ = 0;
  bool save_ = false;
};

}  // namespace kinloop
