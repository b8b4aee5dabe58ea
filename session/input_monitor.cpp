#include "session/input_monitor.hpp"

#include <utility>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/log.hpp"

namespace kinloop {
namespace {

constexpr const char* kModule = "input checks";

}  // namespace

void InputMonitor::observe(const Frame& frame) {
  const ScopedTimer timer(timings_, kModule);
  auto found = checker_.observe(frame);
  for (const InputWarning& warning : found) {
    if (warning.hopeless) throw InputError(text_of(warning));
  }
  keep(std::move(found));
}

void InputMonitor::finish() {
  const ScopedTimer timer(timings_, kModule);
  if (!std::exchange(finished_, true)) keep(checker_.finish());
}

void InputMonitor::keep(std::vector<InputWarning> found) {
  for (InputWarning& warning : found) {
    log::warn("{}", text_of(warning));
    warnings_.push_back(std::move(warning));
  }
}

}  // namespace kinloop
