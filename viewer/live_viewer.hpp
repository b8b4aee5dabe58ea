#pragma once
// Shows a run while it goes on: listens to Slam, serves browsers, takes their commands. What browsers get is
// made on one thread, which gives way to those that track.

#include <mutex>
#include <optional>
#include <string>

#include "viewer/run_control.hpp"
#include "viewer/scene/run_scene.hpp"
#include "viewer/server/service.hpp"

namespace kinloop {

class LiveViewer {
 public:
  /// Begins to serve at once. Throws InputError where the address cannot be had.
  LiveViewer(const ListenAddress& listen, RunInfo info);

  /// Where to look.
  [[nodiscard]] const std::string& url() const { return service_.url(); }

  /// To be told of every frame and change of the map.
  Listener& listener() { return feed_; }

  /// What browsers asked of the run.
  RunControl& control() { return control_; }

  /// What the run is doing, and a message for those who watch.
  void set_stage(const std::string& stage, const std::string& message = "");

  /// The path as it is known at the end.
  void finish(std::span<const LoggedFrame> log, const Map& map) { feed_.on_finish(log, map); }

  /// Browsers that watch now.
  [[nodiscard]] size_t browsers() const { return service_.browsers(); }

 private:
  void update(Scene& scene, size_t browsers);
  void dispatch(Command command);

  RunInfo info_;
  RunControl control_;
  RunFeed feed_;
  std::mutex mutex_;
  RunState state_;  // guarded by the mutex
  std::optional<RunScene> run_scene_;
  ViewerService service_;  // the last: its thread uses all the others
};

}  // namespace kinloop
