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
#include "viewer/saved/saved_run.hpp"
#include "viewer/scene/scene.hpp"
#include "viewer/server/command.hpp"

namespace kinloop {

/// What a page shows.
struct Shown {
  std::function<void(Scene&)> show;  ///< what the first picture needs
  /// What takes longer to read or to encode, in this order, in the background.
  std::vector<std::function<std::vector<EncodedPart>()>> rest;
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
  void begin(Scene& scene);
  void prepare_next();
  Completion prepared(const std::function<std::vector<EncodedPart>()>& prepare);
  void collect();
  Completion withdraw(const std::function<Shown(const std::string&)>& make, const std::string& loop);

  Shown shown_;
  bool is_new_ = true;                  // not in the scene yet
  bool is_first_ = true;                // the scene is empty
  std::optional<Notice> notice_;        // to be told
  size_t prepared_ = 0;                 // of the rest, also in progress
  std::vector<EncodedPart> parts_;      // prepared, not in the scene yet
  bool busy_ = false;                   // with a command
  std::mutex mutex_;                    // for the next two
  std::function<Completion()> wanted_;  // taken, not begun
  Completion done_;                     // carried out, not shown
  std::unique_ptr<Executor> executor_;  // last member: its jobs use the others
};

}  // namespace kinloop
