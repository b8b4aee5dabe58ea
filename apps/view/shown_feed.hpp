#pragma once
// In: what a page shows, and the commands of browsers. Out: a scene, which becomes another one where a loop
// was withdrawn.

#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "kinloop/back_end/executor.hpp"
#include "viewer/keyframe_images.hpp"
#include "viewer/saved_run.hpp"
#include "viewer/server/command.hpp"

namespace kinloop {

/// What a page shows: first the map, then the images, which take longer to read.
struct Shown {
  std::function<void(Scene&)> show;
  std::function<std::vector<KeyframeImage>()> read_images;
  /// Writes the map without a loop, named by its stamps, and returns it; empty if there is no map to change.
  std::function<Shown(const std::string& loop)> withdraw = {};
  std::function<void(Scene&, const Notice&)> tell = {};  ///< set if `withdraw` is
  std::string greeting = {};                             ///< to be told at once; may be empty
};

/// Fills the scene on the viewer's thread. That has a low priority, so commands are carried out on another.
class ShownFeed {
 public:
  explicit ShownFeed(Shown shown);

  /// Takes a command for `work`: a loop is withdrawn, one at a time. On the viewer's thread.
  void take(const Command& command);

  /// Updates the scene. On the viewer's thread.
  void update(Scene& scene);

  /// Carries out the command that was taken, if there is one. On any thread.
  void work();

 private:
  void read_images();
  void collect();
  Completion withdraw(const std::function<Shown(const std::string&)>& make, const std::string& loop);

  Shown shown_;
  bool is_new_ = true;                  // not in the scene yet
  bool is_first_ = true;                // the scene is empty
  std::optional<Notice> notice_;        // to be told
  std::vector<KeyframeImage> images_;   // read, not shown yet
  bool busy_ = false;                   // with a command
  std::mutex mutex_;                    // for the next two
  std::function<Completion()> wanted_;  // taken, not begun
  Completion done_;                     // carried out, not shown
  std::unique_ptr<Executor> executor_;  // last member: its jobs use the others
};

}  // namespace kinloop
