#pragma once
// Threads in place of processes, with MPI's guarantees but without MPI.

#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include "tools/vocabulary_training/communicator.hpp"

namespace kinloop::test {

/// The rendezvous of the threads.
class MeetingPlace {
 public:
  explicit MeetingPlace(int size) : boxes_(static_cast<size_t>(size)) {}

  /// Stores `outgoing`, waits for all, takes the messages for `rank`, waits for all.
  std::vector<Message> exchange(int rank, std::vector<Message> outgoing) {
    boxes_[static_cast<size_t>(rank)] = std::move(outgoing);
    wait_for_all();
    std::vector<Message> incoming;
    for (const auto& box : boxes_) incoming.push_back(box[static_cast<size_t>(rank)]);
    wait_for_all();
    return incoming;
  }

  [[nodiscard]] int size() const { return static_cast<int>(boxes_.size()); }

 private:
  void wait_for_all() {
    std::unique_lock lock(mutex_);
    const size_t round = round_;
    if (++waiting_ == boxes_.size()) {
      waiting_ = 0;
      ++round_;
      all_here_.notify_all();
      return;
    }
    all_here_.wait(lock, [&] { return round_ != round; });
  }

  std::mutex mutex_;
  std::condition_variable all_here_;
  size_t waiting_ = 0, round_ = 0;
  std::vector<std::vector<Message>> boxes_;
};

class ThreadCommunicator : public Communicator {
 public:
  ThreadCommunicator(MeetingPlace& place, int rank) : place_(place), rank_(rank) {}

  [[nodiscard]] int rank() const override { return rank_; }
  [[nodiscard]] int size() const override { return place_.size(); }
  void sum(std::span<uint64_t> numbers) const override {
    const auto* bytes = reinterpret_cast<const uint8_t*>(numbers.data());
    const auto all = gather(Message(bytes, bytes + numbers.size_bytes()));
    std::fill(numbers.begin(), numbers.end(), 0);
    for (const Message& message : all) {
      for (size_t i = 0; i < numbers.size(); ++i) {
        uint64_t number = 0;
        std::copy_n(message.data() + 8 * i, 8, reinterpret_cast<uint8_t*>(&number));
        numbers[i] += number;
      }
    }
  }
  [[nodiscard]] std::vector<Message> exchange(std::vector<Message> outgoing) const override {
    return place_.exchange(rank_, std::move(outgoing));
  }

 private:
  MeetingPlace& place_;
  int rank_;
};

/// Calls `work` as each of `size` processes and waits for all.
inline void as_ranks(int size, const std::function<void(const Communicator&)>& work) {
  MeetingPlace place(size);
  std::vector<std::thread> threads;
  for (int rank = 0; rank < size; ++rank) {
    threads.emplace_back([&place, &work, rank] { work(ThreadCommunicator(place, rank)); });
  }
  for (auto& thread : threads) thread.join();
}

}  // namespace kinloop::test
