// Faults of a live camera's timing: frames that come late, twice, out of order or not at all, clocks that
// jump, a stream that stops. Mapping goes on.

#include <algorithm>
#include <functional>
#include <limits>

#include <gtest/gtest.h>

#include "drivers/live/live_frames.hpp"
#include "kinloop/core/log.hpp"
#include "kinloop/core/random.hpp"
#include "kinloop/slam/slam.hpp"
#include "tests/slam/recording.hpp"
#include "tools/evaluation/evaluate.hpp"

namespace kinloop {
namespace {

constexpr int64_t kMs = 1'000'000, kSecondNs = 1000 * kMs;
constexpr size_t kFaultsBegin = 30, kFaultsEnd = 60, kClipFrames = 90;

/// An image of one of the two streams, as a driver passes it on.
struct Arrival {
  size_t frame = 0;
  bool is_depth = false;
  int64_t stamp_ns = 0;
};

using Arrivals = std::vector<Arrival>;

const test::Recording& clip() {
  static const test::Recording kRecording = test::record_simulation("sim:room", kClipFrames);
  return kRecording;
}

Arrivals arrivals_without_faults() {
  Arrivals all;
  for (size_t i = 0; i < clip().frames.size(); ++i) {
    const Frame& frame = clip().frames[i];
    all.push_back({i, false, frame.stamp_ns});
    all.push_back({i, true, frame.depth_stamp_or_color_ns()});
  }
  return all;
}

bool has_fault(const Arrival& arrival) {
  return arrival.frame >= kFaultsBegin && arrival.frame < kFaultsEnd;
}

struct Outcome {
  size_t frames = 0;   ///< that reached the tracker
  size_t tracked = 0;  ///< of those
  bool tracked_last = false;
  double ate_m = 0;
};

/// Maps as live mode does, frame by frame.
Outcome map_live(const Arrivals& arrivals) {
  LiveFrameBuffer buffer(arrivals.size());
  Slam slam(clip().camera, {});
  Outcome outcome;
  int64_t newest_ns = std::numeric_limits<int64_t>::min();
  const auto take = [&] {
    while (const auto frame = buffer.wait(std::chrono::milliseconds(0))) {
      EXPECT_GT(frame->stamp_ns, newest_ns);
      newest_ns = frame->stamp_ns;
      const TrackedFrame result = slam.process(*frame);
      outcome.tracked_last = !result.is_lost();
      outcome.tracked += outcome.tracked_last ? 1 : 0;
      ++outcome.frames;
    }
  };
  for (const Arrival& arrival : arrivals) {
    const Frame& frame = clip().frames[arrival.frame];
    if (arrival.is_depth) {
      buffer.add_depth(arrival.stamp_ns, frame.depth_m);
    } else {
      buffer.add_color(arrival.stamp_ns, frame.color);
    }
    take();
  }
  buffer.finish();
  take();
  const auto ate = absolute_trajectory_error(slam.finish(), clip().truth);
  outcome.ate_m = ate ? ate->error_m.rmse : 1;
  return outcome;
}

struct Fault {
  const char* name;
  std::function<void(Arrivals&)> apply;
  size_t least_frames;       ///< of kClipFrames that must reach the tracker
  bool keeps_stamps = true;  ///< so that the truth can be compared
};

void drop_if(Arrivals& arrivals, const std::function<bool(const Arrival&)>& dropped) {
  arrivals.erase(std::remove_if(arrivals.begin(), arrivals.end(), dropped), arrivals.end());
}

void reorder(Arrivals& arrivals) {
  Random random(3);
  for (size_t i = 0; i + 4 < arrivals.size(); ++i) {
    if (has_fault(arrivals[i])) std::swap(arrivals[i], arrivals[i + 1 + random.index(3)]);
  }
}

void repeat(Arrivals& arrivals) {
  Arrivals twice;
  for (const Arrival& arrival : arrivals) twice.insert(twice.end(), has_fault(arrival) ? 2 : 1, arrival);
  arrivals = twice;
}

/// All depth images of the faulty part arrive together at its end.
void delay_depth(Arrivals& arrivals) {
  std::stable_partition(arrivals.begin() + 2 * kFaultsBegin, arrivals.begin() + 2 * kFaultsEnd,
                        [](const Arrival& arrival) { return !arrival.is_depth; });
}

void shift_clock(Arrivals& arrivals, int64_t by_ns, bool for_good) {
  for (Arrival& arrival : arrivals) {
    if (has_fault(arrival) || (for_good && arrival.frame >= kFaultsEnd)) arrival.stamp_ns += by_ns;
  }
}

const Fault kFaults[] = {
    {"none", [](Arrivals&) {}, kClipFrames - 1},
    {"doubled", repeat, kClipFrames - 1},
    {"reordered", reorder, kClipFrames - 30},
    {"late depth", delay_depth, kClipFrames - 30},
    {"bursts of 5 lost",
     [](Arrivals& a) { drop_if(a, [](const Arrival& i) { return has_fault(i) && i.frame % 10 < 5; }); },
     kClipFrames - 20},
    {"5 Hz",
     [](Arrivals& a) { drop_if(a, [](const Arrival& i) { return has_fault(i) && i.frame % 6 != 0; }); },
     kClipFrames - 28},
    {"depth stops",
     [](Arrivals& a) { drop_if(a, [](const Arrival& i) { return has_fault(i) && i.is_depth; }); },
     kClipFrames - 32},
    {"colour stops",
     [](Arrivals& a) { drop_if(a, [](const Arrival& i) { return has_fault(i) && !i.is_depth; }); },
     kClipFrames - 32},
    {"clock set back", [](Arrivals& a) { shift_clock(a, -3600 * kSecondNs, true); }, kClipFrames - 4, false},
    {"clock forward and back", [](Arrivals& a) { shift_clock(a, 3600 * kSecondNs, false); }, kClipFrames - 4,
     false},
    {"clock half a second back", [](Arrivals& a) { shift_clock(a, -kSecondNs / 2, true); }, kClipFrames - 20,
     false},
};

TEST(TimingFaults, MappingGoesOn) {
  log::set_level(spdlog::level::err);
  for (const Fault& fault : kFaults) {
    SCOPED_TRACE(fault.name);
    Arrivals arrivals = arrivals_without_faults();
    fault.apply(arrivals);
    const Outcome outcome = map_live(arrivals);
    EXPECT_GE(outcome.frames, fault.least_frames);
    EXPECT_LE(outcome.frames, kClipFrames);
    EXPECT_GE(outcome.tracked + 5, outcome.frames);
    EXPECT_TRUE(outcome.tracked_last);
    EXPECT_LT(fault.keeps_stamps ? outcome.ate_m : 0, 0.03);
  }
  log::set_level(spdlog::level::info);
}

TEST(TimingFaults, AnyRateFrom5To90Hz) {
  for (const int64_t hz : {5, 15, 60, 90}) {
    Arrivals arrivals = arrivals_without_faults();
    for (Arrival& arrival : arrivals) {
      const int64_t after_color_ns = arrival.stamp_ns - clip().frames[arrival.frame].stamp_ns;
      arrival.stamp_ns = static_cast<int64_t>(arrival.frame) * kSecondNs / hz + after_color_ns;
    }
    const Outcome outcome = map_live(arrivals);
    EXPECT_GE(outcome.frames, kClipFrames - 5) << hz;
    EXPECT_GE(outcome.tracked + 1, outcome.frames) << hz;
  }
}

}  // namespace
}  // namespace kinloop
