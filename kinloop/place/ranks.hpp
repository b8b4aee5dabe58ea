#pragma once
// The processes that train one dictionary together, on one machine or many. Each calls the same functions in
// the same order.

#include <cstdint>
#include <span>
#include <vector>

namespace kinloop {

/// Bytes on their way from one process to another.
using Message = std::vector<uint8_t>;

/// One process alone, unless a derived class says otherwise (mpi_ranks.hpp).
class Ranks {
 public:
  Ranks() = default;
  virtual ~Ranks() = default;
  Ranks(const Ranks&) = delete;
  Ranks& operator=(const Ranks&) = delete;

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
  [[nodiscard]] std::vector<Message> gather(const Message& said) const {
    return exchange(std::vector<Message>(static_cast<size_t>(size()), said));
  }

  /// The sum of one number.
  [[nodiscard]] uint64_t sum_of(uint64_t number) const {
    sum({&number, 1});
    return number;
  }

  /// Each process's number.
  [[nodiscard]] std::vector<uint64_t> all(uint64_t number) const {
    std::vector<uint64_t> numbers(static_cast<size_t>(size()), 0);
    numbers[static_cast<size_t>(rank())] = number;
    sum(numbers);
    return numbers;
  }
};

}  // namespace kinloop
