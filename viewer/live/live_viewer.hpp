#pragma once
// Shows a run in progress: listens to Slam, serves browsers, receives their commands. A low-priority thread
// prepares the data for browsers, so that tracking is not slowed down.

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "viewer/live/run_scene.hpp"
#include "viewer/server/service.hpp"

namespace kinloop {

/// Commands from viewers to a run: pause, resume, single step, save the map. The run asks for the next action
/// before every frame.
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

class LiveViewer {
 public:
  /// Starts serving immediately. Throws InputError if the address is not available.
  LiveViewer(const ListenAddress& listen, RunInfo info);

  /// URL of the page.
  [[nodiscard]] const std::string& url() const { return service_.url(); }

  /// The listener for frames and map changes.
  Listener& listener() { return feed_; }

  /// The commands from browsers.
  RunControl& control() { return control_; }

  /// Sets the stage of the run, with an optional message for viewers.
  void set_stage(const std::string& stage, const std::string& message = "");

  /// Sets what is shown as contradictions in the input: all so far.
  void set_warnings(std::vector<std::string> warnings);

  /// Sets what is shown as spoiling the recording at the moment.
  void set_hints(std::vector<std::string> hints);

  /// Shows the final path.
  void finish(std::span<const LoggedFrame> log, const Map& map) { feed_.on_finish(log, map); }

  /// Sets what is known of the sensor, as it was estimated along with the poses.
  void set_sensor(const SensorEstimate& sensor);

  /// Number of connected browsers.
  [[nodiscard]] size_t browsers() const { return service_.browsers(); }

  /// Waits until every browser has been sent what is known now; returns whether that is so within `timeout`.
  [[nodiscard]] bool wait_until_sent(std::chrono::milliseconds timeout) const {
    return service_.wait_until_sent(timeout);
  }

 private:
  void update(Scene& scene, size_t browsers);
  void dispatch(const Command& command);

  RunInfo info_;
  RunControl control_;
  RunFeed feed_;
  std::mutex mutex_;
  RunState state_;  // guarded by the mutex
  std::optional<RunScene> run_scene_;
  ViewerService service_;  // declared last: its thread uses all the others
};

}  // namespace kinloop
