#include "apps/view/shown_feed.hpp"

#include <exception>
#include <utility>

#include "viewer/server/access.hpp"

namespace kinloop {
namespace {

constexpr const char* kRest = "rest of the map";

}  // namespace

ShownFeed::ShownFeed(Shown shown)
    : shown_(std::move(shown)), executor_(make_executor({.mode = ExecutorMode::kLive})) {}

/// Prepares what comes next, unless that is being done or there is no more.
void ShownFeed::prepare_next() {
  if (executor_->busy(kRest) || prepared_ == shown_.rest.size()) return;
  executor_->submit({}, {.kind = kRest, .work = [this, prepare = shown_.rest[prepared_]]() -> Completion {
                           return [this, parts = prepare()]() mutable { parts_ = std::move(parts); };
                         }});
  ++prepared_;
}

void ShownFeed::take(const Command& command) {
  if (command.kind != CommandKind::kWithdrawLoop || !shown_.withdraw) return;
  if (busy_) return;
  if (prepared_ < shown_.rest.size() || executor_->busy(kRest)) {
    notice_ = {"The map is still being sent; try again in a moment."};
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
    return [this, shown = make(loop)] {
      shown_ = shown;
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
  shown_.show(scene);
  prepared_ = 0;
  if (!shown_.greeting.empty()) notice_ = {shown_.greeting};
}

void ShownFeed::update(Scene& scene) {
  collect();
  if (std::exchange(is_new_, false)) return begin(scene);
  if (const auto notice = std::exchange(notice_, {})) shown_.tell(scene, *notice);
  for (EncodedPart& part : std::exchange(parts_, {})) scene.put(part.kind, part.index, std::move(part.body));
  prepare_next();
}

}  // namespace kinloop
