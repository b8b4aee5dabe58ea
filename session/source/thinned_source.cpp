#include "session/source/thinned_source.hpp"

#include <utility>

#include "kinloop/core/errors.hpp"
#include "kinloop/sensor/source/passable_source.hpp"

namespace kinloop {

ThinnedSource::ThinnedSource(std::unique_ptr<FrameSource> source, int step)
    : ForwardingSource(std::move(source)),
      step_(step),
      camera_(ForwardingSource::camera()),
      info_(ForwardingSource::info()) {
  require(step >= 1 && step <= kMaxStep, "ThinnedSource: the step is out of range");
  camera_.fps /= step;
  const auto n = static_cast<size_t>(step);
  info_.frames = (info_.frames + n - 1) / n;
}

std::optional<Frame> ThinnedSource::next() {
  for (int passed_over = next_id_ == 0 ? 0 : step_ - 1; passed_over > 0; --passed_over) {
    if (!pass_over()) return std::nullopt;
  }
  auto frame = source().next();
  if (frame) frame->id = FrameId{next_id_++};
  return frame;
}

bool ThinnedSource::pass_over() {
  auto* passable = dynamic_cast<PassableSource*>(&source());
  return passable != nullptr ? passable->pass_over() : source().next().has_value();
}

}  // namespace kinloop
