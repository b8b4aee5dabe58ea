#include "session/input/checks/input_checker.hpp"

#include <algorithm>
#include <utility>

#include "session/input/checks/checks.hpp"

namespace kinloop {
namespace {

void append(std::vector<InputWarning>& all, std::optional<InputWarning> warning) {
  if (warning) all.push_back(*std::move(warning));
}

}  // namespace

InputChecker::InputChecker(const RgbdCamera& camera, FrameOrder order)
    : camera_(camera), order_(order), registration_(camera.color), depth_(camera), clock_(camera.fps) {}

std::vector<InputWarning> InputChecker::observe(const Frame& frame) {
  std::vector<InputWarning> found;
  if (!std::exchange(started_, true)) append(found, check_intrinsics(camera_.color));
  append(found, registration_.observe(frame));
  depth_.observe(frame);
  if (order_ == FrameOrder::kSuccessive) {
    frozen_.observe(frame);
    clock_.observe(frame);
  }
  return tell(std::move(found));
}

std::vector<InputWarning> InputChecker::finish() {
  std::vector<InputWarning> found;
  append(found, registration_.verdict());
  append(found, depth_.values());
  append(found, depth_.unit());
  append(found, frozen_.depth());
  append(found, frozen_.color());
  append(found, clock_.stamps());
  append(found, clock_.depth_clock());
  return tell(std::move(found));
}

std::vector<InputWarning> InputChecker::tell(std::vector<InputWarning> found) {
  std::erase_if(found, [&](const InputWarning& warning) {
    return std::find(told_.begin(), told_.end(), warning.fault) != told_.end();
  });
  for (const InputWarning& warning : found) told_.push_back(warning.fault);
  return found;
}

}  // namespace kinloop
