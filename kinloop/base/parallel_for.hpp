#pragma once
// The only threads outside the executor and the decoder.

#include <cstddef>
#include <functional>

namespace kinloop {

/// Calls `body(begin, end)` for contiguous pieces of [0, count) on up to `threads` threads and waits for all.
/// Bodies must write to places of their own; then the result does not depend on `threads`. The first
/// exception is thrown on to the caller.
void parallel_for(size_t count, int threads, const std::function<void(size_t begin, size_t end)>& body);

/// Number of hardware threads, at least 1.
int hardware_threads();

}  // namespace kinloop
