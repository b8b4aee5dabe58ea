#pragma once
// The processes that jointly train one vocabulary, on one machine or several. Each calls the same functions
// in the same order.

#include <cstdint>
#include <cstring>
#include <memory>
#include <span>
#include <type_traits>
#include <vector>

#include "kinloop/core/errors.hpp"

namespace kinloop {

/// Bytes sent from one process to another.
using Message = std::vector<uint8_t>;

/// A single process, unless a derived class says otherwise (see mpi_communicator.cpp).
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

/// Returns whether this build has MPI.
bool mpi_available();

/// Joins the processes that mpirun or srun started; this process alone if none did. Call it once and keep the
/// result until the end. A process that ends by an exception does not notify the others; the launcher ends
/// them, so that none waits for ever. Throws UsageError in a build without MPI that was started as one of
/// several processes.
std::unique_ptr<Communicator> join_mpi();

/// Appends the bytes of `values`.
template <class T>
void put(Message& message, std::span<const T> values) {
  static_assert(std::is_trivially_copyable_v<T>);
  const auto* bytes = reinterpret_cast<const uint8_t*>(values.data());
  message.insert(message.end(), bytes, bytes + values.size_bytes());
}

/// Appends the bytes of one value.
template <class T>
void put(Message& message, const T& value) {
  put(message, std::span<const T>(&value, 1));
}

/// Reads a message from the beginning.
class MessageReader {
 public:
  explicit MessageReader(const Message& message) : left_(message) {}

  template <class T>
  std::vector<T> read(size_t count) {
    require(count * sizeof(T) <= left_.size(), "MessageReader: read past the end of the message");
    std::vector<T> values(count);
    if (count > 0) std::memcpy(values.data(), left_.data(), count * sizeof(T));
    left_ = left_.subspan(count * sizeof(T));
    return values;
  }

  template <class T>
  T read() {
    return read<T>(1).front();
  }

 private:
  std::span<const uint8_t> left_;
};

}  // namespace kinloop
