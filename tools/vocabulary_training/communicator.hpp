#pragma once
// The processes that jointly train one vocabulary, on one machine or several. Each calls the same functions
// in the same order.

#include <cstdint>
#include <span>
#include <vector>

namespace kinloop {

/// Bytes sent from one process to another.
using Message = std::vector<uint8_t>;

/// A single process, unless a derived class says otherwise (mpi_communicator.hpp).
class Communicator {
 public:
  Communicator() = default;
  virtual ~Communicator() = default;
  Communicator(const Communicator&) = delete;
  Communicator& operator=(const Communicator&) = delete;

  /// Number of this process, below `size()`.
  [[nodiscard]] virtual int rank() const { return 0; }
  [[nodiscard]] virtual int size() const { return 1; }

  /// Replaces each number by its sum over all processes.
  virtual void sum(std::span<uint64_t> /*numbers*/) const {}

  /// Sends `outgoing[r]` to process r; returns what each process sent here.
  [[nodiscard]] virtual std::vector<Message> exchange(std::vector<Message> outgoing) const {
    return outgoing;
  }

  /// Sends a message from each process to all.
  [[nodiscard]] std::vector<Message> gather(const Message& message) const {
    return exchange(std::vector<Message>(static_cast<size_t>(size()), message));
  }

  /// Returns the sum of a number over all processes.
  [[nodiscard]] uint64_t all_reduce_sum(uint64_t number) const {
    sum({&number, 1});
    return number;
  }

  /// Returns each process's number.
  [[nodiscard]] std::vector<uint64_t> all_gather(uint64_t number) const {
    std::vector<uint64_t> numbers(static_cast<size_t>(size()), 0);
    numbers[static_cast<size_t>(rank())] = number;
    sum(numbers);
    return numbers;
  }
};

}  // namespace kinloop
