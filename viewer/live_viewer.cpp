#include "viewer/live_viewer.hpp"

namespace kinloop {

LiveViewer::LiveViewer(const ListenAddress& listen, RunBasics basics)
    : basics_(std::move(basics)),
      control_(basics_.options.paused),
      feed_(basics_.options),
      service_(
          listen, [this](Scene& scene, size_t browsers) { update(scene, browsers); },
          [this](Command command) { obey(command); }) {}

void LiveViewer::tell(const std::string& stage, const std::string& message) {
  const std::lock_guard lock(mutex_);
  state_.stage = stage;
  state_.message = message;
}

void LiveViewer::update(Scene& scene, size_t browsers) {
  if (!shown_) shown_.emplace(scene, basics_);
  RunState state;
  {
    const std::lock_guard lock(mutex_);
    state = state_;
  }
  state.paused = control_.paused();
  shown_->take_in(feed_.take(), state, browsers > 0);
}

void LiveViewer::obey(Command command) {
  switch (command) {
    case Command::kPause:
      return control_.pause();
    case Command::kResume:
      return control_.resume();
    case Command::kStep:
      return control_.step();
    case Command::kSave:
      return control_.ask_to_save();
  }
}

}  // namespace kinloop
