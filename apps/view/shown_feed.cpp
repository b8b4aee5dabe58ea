#include "apps/view/shown_feed.hpp"

#include <exception>
#include <utility>

#include "kinloop/core/log.hpp"
#include "viewer/server/access.hpp"

namespace kinloop {
namespace {

constexpr const char* kRestJob = "rest of the map";

}  // namespace

ShownFeed::ShownFeed(Shown shown)
    : shown_(std::move(shown)), executor_(make_executor({.mode = ExecutorMode::kLive})) {}

/// Prepares what comes next, unless that is being done or there is no more.
void ShownFeed::prepare_next() {
  if (executor_->busy(kRestJob) || prepared_ == shown_.rest.size()) return;
  // Once it is prepared, what it was made of is no longer needed.
  const auto prepare = std::exchange(shown_.rest[prepared_++], {});
  executor_->submit({}, {.kind = kRestJob, .work = [this, prepare] { return prepared(prepare); }});
}

/// Returns what is to be done on the viewer's thread once a part of the rest is prepared. Without it, all
/// else can be shown.
Completion ShownFeed::prepared(const std::function<std::vector<EncodedPart>()>& prepare) {
  try {
    return [this, parts = prepare()]() mutable { parts_ = std::move(parts); };
  } catch (const std::exception& error) {
    log::warn("part of the map cannot be shown: {}", error.what());
    return [] {};
  }
}

void ShownFeed::take(const Command& command) {
  if (command.kind != CommandKind::kWithdrawLoop || !shown_.withdraw) return;
  if (busy_) return;
  if (prepared_ < shown_.rest.size() || executor_->busy(kRestJob)) {
    notice_ = {"The map is still being prepared; try again in a moment."};
    return;
  }
  notice_ = {"Taking the loop out, and solving the map again...", true};
  busy_ = true;
  const std::lock_guard lock(mutex_);
  wanted_ = [this, make = shown_.withdraw, loop = command.loop] { return withdraw(make, loop); };
}

void ShownFeed::work() {
  std::function<Completion()> wanted;
  {
    const std::lock_guard lock(mutex_);
    wanted = std::exchange(wanted_, {});
  }
  if (!wanted) return;
  Completion done = wanted();
  const std::lock_guard lock(mutex_);
  done_ = std::move(done);
}

/// Returns what is to be done on the viewer's thread once the loop is withdrawn.
Completion ShownFeed::withdraw(const std::function<Shown(const std::string&)>& make,
                               const std::string& loop) {
  try {
    return [this, shown = make(loop)]() mutable {
      shown_ = std::move(shown);
      is_new_ = true;
      parts_.clear();
    };
  } catch (const std::exception& error) {
    return [this, what = std::string(error.what())] { notice_ = {what}; };
  }
}

/// Takes over what was read or carried out.
void ShownFeed::collect() {
  for (const FinishedJob& job : executor_->collect({})) job.complete();
  Completion done;
  {
    const std::lock_guard lock(mutex_);
    done = std::exchange(done_, {});
  }
  if (!done) return;
  busy_ = false;
  done();
}

/// Shows the first of what is new.
void ShownFeed::begin(Scene& scene) {
  if (!std::exchange(is_first_, false)) scene.restart(random_token());
  std::exchange(shown_.show, {})(scene);
  prepared_ = 0;
  if (!shown_.greeting.empty()) notice_ = {shown_.greeting};
}

void ShownFeed::update(Scene& scene) {
  collect();
  if (std::exchange(is_new_, false)) return begin(scene);
  if (const auto notice = std::exchange(notice_, {})) shown_.tell(scene, *notice);
  scene.put(std::exchange(parts_, {}));
  prepare_next();
}

}  // namespace kinloop
