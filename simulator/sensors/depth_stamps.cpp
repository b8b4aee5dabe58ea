#include "simulator/sensors/depth_stamps.hpp"

#include <algorithm>
#include <cmath>

#include "kinloop/core/association.hpp"
#include "kinloop/core/quantile.hpp"
#include "kinloop/core/random.hpp"
#include "kinloop/core/time.hpp"

namespace kinloop::sim {
namespace {

constexpr double kCameraRate_hz = 30;
constexpr double kJitter = 0.06;                          // of the period, 1 sigma: 2 ms
constexpr double kMinDrift = 0.5e-3, kMaxDrift = 2.5e-3;  // of the period, either sign
constexpr double kLostShare = 0.005;

/// The images of the depth camera, by their number since the first colour image.
class DepthClock {
 public:
  DepthClock(std::span<const int64_t> color_ns, uint64_t seed) : first_ns_(color_ns.front()), seed_(seed) {
    std::vector<double> intervals_s;
    for (size_t i = 1; i < color_ns.size(); ++i)
      intervals_s.push_back(to_seconds(color_ns[i] - color_ns[i - 1]));
    const double interval_s = intervals_s.empty() ? 1 / kCameraRate_hz : median(intervals_s);
    // A slower path shows some frames of a camera that runs at its own rate.
    constexpr double kSlack = 0.25;
    nominal_s_ = interval_s / std::max(1.0, std::ceil(interval_s * kCameraRate_hz - kSlack));
    Random random(hash(seed, 0x57a3));
    const double drift = random.uniform(kMinDrift, kMaxDrift) * (random.uniform() < 0.5 ? -1 : 1);
    period_s_ = nominal_s_ * (1 + drift);
    phase_s_ = random.uniform(-0.5, 0.5) * nominal_s_;
  }

  [[nodiscard]] int64_t nearest(int64_t stamp_ns) const {
    return std::llround((to_seconds(stamp_ns - first_ns_) - phase_s_) / period_s_);
  }
  [[nodiscard]] bool is_lost(int64_t number) const { return random_of(number, 1).uniform() < kLostShare; }
  [[nodiscard]] int64_t stamp_ns(int64_t number) const {
    constexpr double kMaxSigmas = 3;
    const double jitter = std::clamp(random_of(number, 2).gaussian(), -kMaxSigmas, kMaxSigmas) * kJitter;
    constexpr double kMicrosecondsPerSecond = 1e6;  // time resolution of sequence files
    const double since_s = phase_s_ + static_cast<double>(number) * period_s_ + jitter * nominal_s_;
    return first_ns_ + std::llround(since_s * kMicrosecondsPerSecond) * 1000;
  }

 private:
  [[nodiscard]] Random random_of(int64_t number, uint64_t purpose) const {
    return Random(hash(hash(seed_, static_cast<uint64_t>(number)), purpose));
  }

  int64_t first_ns_;
  uint64_t seed_;
  double nominal_s_ = 0, period_s_ = 0, phase_s_ = 0;
};

}  // namespace

std::vector<FrameStamps> with_depth_stamps(std::span<const int64_t> color_ns, uint64_t seed) {
  if (color_ns.empty()) return {};
  const DepthClock clock(color_ns, seed);
  std::vector<int64_t> depth_ns;
  int64_t next = clock.nearest(color_ns.front()) - 1;
  for (const int64_t stamp_ns : color_ns) {
    const int64_t nearest = clock.nearest(stamp_ns);
    for (next = std::max(next, nearest - 1); next <= nearest + 1; ++next) {
      if (!clock.is_lost(next)) depth_ns.push_back(clock.stamp_ns(next));
    }
  }
  std::vector<FrameStamps> frames;
  for (const auto& [color, depth] : associate_stamps(color_ns, depth_ns))
    frames.push_back({color_ns[color], depth_ns[depth]});
  if (frames.empty()) frames.push_back({color_ns.front(), color_ns.front()});
  return frames;
}

}  // namespace kinloop::sim
