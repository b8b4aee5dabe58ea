#include "kinloop/slam/executor.hpp"

#include <algorithm>
#include <chrono>
#include <future>

#include "kinloop/base/errors.hpp"
#include "kinloop/base/thread_priority.hpp"

namespace kinloop {
namespace {

struct Job {
  JobKind kind;
  FrameId due;
  std::future<FinishedJob> result;
};

uint32_t lag_of(JobKind kind, const ExecutorOptions& options) {
  switch (kind) {
    case JobKind::kLocalBundleAdjustment:
      return static_cast<uint32_t>(options.local_ba_lag_frames);
    case JobKind::kLoopVerification:
      return static_cast<uint32_t>(options.loop_verification_lag_frames);
    case JobKind::kLoopCorrection:
      return static_cast<uint32_t>(options.loop_correction_lag_frames);
    case JobKind::kGlobalBundleAdjustment:
    case JobKind::kSelfCalibration:
      return static_cast<uint32_t>(options.global_ba_lag_frames);
    case JobKind::kDenseKeyframes:
      return static_cast<uint32_t>(options.dense_lag_frames);
  }
  return 0;
}

/// The three modes differ in when work starts and when its result is due.
class ModalExecutor : public Executor {
 public:
  explicit ModalExecutor(const ExecutorOptions& options) : options_(options) {}

  void submit(JobKind kind, FrameId now, std::function<JobResult()> work) override {
    require(!busy(kind), "submit: a job of this kind is in flight");
    const bool synchronous = options_.mode == "inline";
    const FrameId due{now.value + (synchronous ? 1 : lag_of(kind, options_))};
    // A camera does not wait: whatever tracking leaves of the processor is enough for the rest.
    const bool low_priority = options_.mode == "live";
    auto result = std::async(synchronous ? std::launch::deferred : std::launch::async,
                             [kind, low_priority, work = std::move(work)] {
                               if (low_priority) lower_thread_priority(ThreadPriority::kLowest);
                               const Stopwatch watch;
                               JobResult done = work();
                               return FinishedJob{kind, std::move(done), watch.elapsed()};
                             });
    if (synchronous) result.wait();
    jobs_.push_back({kind, due, std::move(result)});
  }

  [[nodiscard]] bool busy(JobKind kind) const override {
    return std::any_of(jobs_.begin(), jobs_.end(), [&](const Job& job) { return job.kind == kind; });
  }

  std::vector<FinishedJob> collect(FrameId now) override {
    return collect_if([&](const Job& job) {
      if (options_.mode != "live") return job.due <= now;
      return job.result.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
    });
  }

  std::vector<FinishedJob> drain() override {
    return collect_if([](const Job&) { return true; });
  }

 private:
  std::vector<FinishedJob> collect_if(const std::function<bool(const Job&)>& is_due) {
    std::vector<FinishedJob> finished;
    std::vector<Job> remaining;
    for (Job& job : jobs_) {
      if (is_due(job)) {
        finished.push_back(job.result.get());
      } else {
        remaining.push_back(std::move(job));
      }
    }
    jobs_ = std::move(remaining);
    return finished;
  }

  ExecutorOptions options_;
  std::vector<Job> jobs_;  // in the order they were handed in
};

}  // namespace

const char* to_string(JobKind kind) {
  switch (kind) {
    case JobKind::kLocalBundleAdjustment:
      return "local bundle adjustment";
    case JobKind::kLoopVerification:
      return "loop verification";
    case JobKind::kLoopCorrection:
      return "loop correction";
    case JobKind::kGlobalBundleAdjustment:
      return "global bundle adjustment";
    case JobKind::kSelfCalibration:
      return "self-calibration";
    case JobKind::kDenseKeyframes:
      return "dense keyframes";
  }
  return "";
}

std::unique_ptr<Executor> make_executor(const ExecutorOptions& options) {
  return std::make_unique<ModalExecutor>(options);
}

}  // namespace kinloop
