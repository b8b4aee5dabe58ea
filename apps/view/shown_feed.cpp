#include "apps/view/shown_feed.hpp"

#include <exception>
#include <utility>

#include "viewer/server/access.hpp"

namespace kinloop {
namespace {

constexpr const char* kImages = "keyframe images";

}  // namespace

ShownFeed::ShownFeed(Shown shown)
    : shown_(std::move(shown)), executor_(make_executor({.mode = ExecutorMode::kLive})) {
  read_images();
}

void ShownFeed::read_images() {
  executor_->submit({}, {.kind = kImages, .work = [this, read = shown_.read_images]() -> Completion {
                           return [this, images = read()] { images_ = images; };
                         }});
}

void ShownFeed::take(const Command& command) {
  if (command.kind != CommandKind::kWithdrawLoop || !shown_.withdraw) return;
  if (busy_) return;
  if (executor_->busy(kImages)) {
    notice_ = {"The images of the map are still being read; try again in a moment."};
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
      images_.clear();
      read_images();
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

void ShownFeed::update(Scene& scene) {
  collect();
  if (std::exchange(is_new_, false)) {
    if (!std::exchange(is_first_, false)) scene.restart(random_token());
    shown_.show(scene);
    if (!shown_.greeting.empty()) notice_ = {shown_.greeting};
    return;
  }
  if (const auto notice = std::exchange(notice_, {})) shown_.tell(scene, *notice);
  for (KeyframeImage& image : std::exchange(images_, {}))
    scene.put(PartKind::kKeyframeImage, image.keyframe, std::move(image.jpeg));
}

}  // namespace kinloop
