#pragma once
// Commands from viewers to a run: pause, resume, single step, save the map. The run asks for the next action
// before every frame.

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

  /// Returns the next action of the run: process a frame, or save the map and ask again. Blocks while paused,
  /// until `stop` (polled) returns true.
  Action next_action(const std::function<bool()>& stop);

 private:
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  bool paused_;
  int steps_ = 0;
  bool save_ = false;
};

}  // namespace kinloop
