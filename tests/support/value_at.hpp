#pragma once

#include <cstring>

namespace kinloop::test {

/// Returns the number whose bytes begin at `offset`; all of them must be there.
template <class T, class Bytes>
T value_at(const Bytes& bytes, size_t offset) {
  T value{};
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

}  // namespace kinloop::test
