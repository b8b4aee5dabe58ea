#pragma once
// Commands from viewers to a run: pause, resume, single step, save the map. The run asks for the next action
// before every frame.

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>

namespace kinloop {

class RunControl {
 public:
  /// While the run is not paused, the map is saved at most once in `between_saves`: however often it is
  /// requested, the run proceeds.
  explicit RunControl(bool paused = false, std::chrono::milliseconds between_saves = std::chrono::seconds(5))
      : paused_(paused), between_saves_(between_saves) {}

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
  using Clock = std::chrono::steady_clock;
  [[nodiscard]] bool save_is_due() const;

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  bool paused_;
  int steps_ = 0;
  bool save_ = false;
  bool saving_ = false;           ///< since the last action
  Clock::time_point saved_ = {};  ///< end of the last save
  Clock::duration between_saves_;
};

}  // namespace kinloop
