#include "viewer/live/live_viewer.hpp"

namespace kinloop {

LiveViewer::LiveViewer(const ListenAddress& listen, RunInfo info)
    : info_(std::move(info)),
      control_(info_.options.paused),
      service_(
          listen, [this](Scene& scene, size_t browsers) { update(scene, browsers); },
          [this](const Command& command) { dispatch(command); }) {}

void LiveViewer::set_stage(const std::string& stage, const std::string& message) {
  const std::lock_guard lock(mutex_);
  state_.stage = stage;
  state_.message = message;
}

void LiveViewer::set_warnings(std::vector<std::string> warnings) {
  const std::lock_guard lock(mutex_);
  state_.warnings = std::move(warnings);
}

void LiveViewer::set_hints(std::vector<std::string> hints) {
  const std::lock_guard lock(mutex_);
  state_.hints = std::move(hints);
}

void LiveViewer::set_sensor(const SensorEstimate& sensor) {
  const std::lock_guard lock(mutex_);
  state_.sensor = sensor;
}

void LiveViewer::update(Scene& scene, size_t browsers) {
  if (!run_scene_) run_scene_.emplace(scene, info_);
  RunState state;
  {
    const std::lock_guard lock(mutex_);
    state = state_;
  }
  state.paused = control_.paused();
  run_scene_->update(feed_.take(), state, browsers > 0);
}

void LiveViewer::dispatch(const Command& command) {
  switch (command.kind) {
    case CommandKind::kPause:
      return control_.pause();
    case CommandKind::kResume:
      return control_.resume();
    case CommandKind::kStep:
      return control_.step();
    case CommandKind::kSave:
      return control_.request_save();
    case CommandKind::kWithdrawLoop:
      return;  // a map that grows is not edited
  }
}

}  // namespace kinloop
