#include "drivers/live/paced_source.hpp"

#include <chrono>
#include <thread>

#include "kinloop/core/errors.hpp"

namespace kinloop {

PaceClock PaceClock::steady() {
  using Clock = std::chrono::steady_clock;
  using Seconds = std::chrono::duration<double>;
  return {[] { return Seconds(Clock::now().time_since_epoch()).count(); },
          [](double until_s) {
            std::this_thread::sleep_until(
                Clock::time_point(std::chrono::duration_cast<Clock::duration>(Seconds(until_s))));
          }};
}

PacedSource::PacedSource(std::unique_ptr<FrameSource> source, double rate_hz, PaceClock clock)
    : ForwardingSource(std::move(source)), rate_hz_(rate_hz), clock_(std::move(clock)) {
  require(rate_hz > 0, "PacedSource: needs a rate");
  info_ = ForwardingSource::info();
  info_.live = true;
}

std::optional<Frame> PacedSource::next() {
  const double now_s = clock_.now_s();
  if (!start_s_) start_s_ = now_s;
  const auto come = static_cast<size_t>((now_s - *start_s_) * rate_hz_) + 1;
  for (; next_index_ + kBuffered < come; ++next_index_, ++dropped_) {
    if (!source().next()) return std::nullopt;
  }
  if (next_index_ >= come) clock_.sleep_until_s(*start_s_ + static_cast<double>(next_index_) / rate_hz_);
  ++next_index_;
  return source().next();
}

}  // namespace kinloop
