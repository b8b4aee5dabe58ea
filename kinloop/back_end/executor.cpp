#include "kinloop/back_end/executor.hpp"

#include <algorithm>
#include <chrono>
#include <future>
#include <iterator>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/threads/thread_priority.hpp"

namespace kinloop {
namespace {

struct JobInFlight {
  std::string_view kind;
  FrameId due;
  std::future<FinishedJob> result;
};

/// The three modes differ in when jobs run and when their results are due.
class ModalExecutor : public Executor {
 public:
  explicit ModalExecutor(const ExecutorOptions& options) : mode_(options.mode) {}

  void submit(FrameId now, Job job) override {
    require(!busy(job.kind), "submit: a job of this kind is in flight");
    const bool synchronous = mode_ == ExecutorMode::kInline;
    const std::string_view kind = job.kind;
    const FrameId due{now.value + (synchronous ? 1 : static_cast<uint32_t>(job.lag_frames))};
    // A live camera does not wait: background jobs get only the CPU time that tracking leaves.
    const bool low_priority = mode_ == ExecutorMode::kLive;
    auto result = std::async(synchronous ? std::launch::deferred : std::launch::async,
                             [kind, low_priority, work = std::move(job.work)] {
                               if (low_priority) lower_thread_priority(ThreadPriority::kLowest);
                               const Stopwatch watch;
                               Completion complete = work();
                               return FinishedJob{kind, watch.elapsed(), std::move(complete)};
                             });
    if (synchronous) result.wait();
    jobs_.push_back({kind, due, std::move(result)});
  }

  [[nodiscard]] bool busy(std::string_view kind) const override {
    return std::any_of(jobs_.begin(), jobs_.end(), [&](const JobInFlight& job) { return job.kind == kind; });
  }

  std::vector<FinishedJob> collect(FrameId now) override {
    return collect_if([&](const JobInFlight& job) {
      if (mode_ != ExecutorMode::kLive) return job.due <= now;
      return job.result.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
    });
  }

  std::vector<FinishedJob> drain() override {
    return collect_if([](const JobInFlight&) { return true; });
  }

 private:
  std::vector<FinishedJob> collect_if(const std::function<bool(const JobInFlight&)>& is_due) {
    // No job that is due stays in the list if the result of one is an exception.
    const auto first_due = std::stable_partition(jobs_.begin(), jobs_.end(),
                                                 [&](const JobInFlight& job) { return !is_due(job); });
    std::vector<JobInFlight> due(std::make_move_iterator(first_due), std::make_move_iterator(jobs_.end()));
    jobs_.erase(first_due, jobs_.end());
    std::vector<FinishedJob> finished;
    for (JobInFlight& job : due) finished.push_back(job.result.get());
    return finished;
  }

  ExecutorMode mode_;
  std::vector<JobInFlight> jobs_;  // in order of submission
};

}  // namespace

std::unique_ptr<Executor> make_executor(const ExecutorOptions& options) {
  validate(options, "executor.");
  return std::make_unique<ModalExecutor>(options);
}

}  // namespace kinloop
