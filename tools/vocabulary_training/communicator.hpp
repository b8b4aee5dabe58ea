#pragma once
// The processes that train one vocabulary together, on one machine or many. Each calls the same functions in
// the same order.

#include <cstdint>
#include <span>
#include <vector>

namespace kinloop {

/// Bytes on their way from one process to another.
using Message = std::vector<uint8_t>;

/// One process alone, unless a derived class says otherwise (mpi_ranks.hpp).
class Communicator {
 public:
  Communicator() = default;
  virtual ~Communicator() = default;
  Communicator(const Communicator&) = delete;
  Communicator& operator=(const Communicator&) = delete;

  /// This process's number, below `size()`.
  [[nodiscard]] virtual int rank() const { return 0; }
  [[nodiscard]] virtual int size() const { return 1; }

  /// Replaces each number by its sum over all processes.
  virtual void sum(std::span<uint64_t> /*numbers*/) const {}

  /// Sends `outgoing[r]` to process r; gives what each process sent here.
  [[nodiscard]] virtual std::vector<Message> exchange(std::vector<Message> outgoing) const {
    return outgoing;
  }

  /// What each process says, to all.
  [[nodiscard]] std::vector<Message> gather(const Message& message) const {
    return exchange(std::vector<Message>(static_cast<size_t>(size()), message));
  }

  /// The sum of one number.
  [[nodiscard]] uint64_t all_reduce_sum(uint64_t number) const {
    sum({&number, 1});
    return number;
  }

  /// Each process's number.
  [[nodiscard]] std::vector<uint64_t> all_gather(uint64_t number) const {
    std::vector<uint64_t> numbers(static_cast<size_t>(size()), 0);
    numbers[static_cast<size_t>(rank())] = number;
    sum(numbers);
    return numbers;
  }
};

}  // namespace kinloop
