#pragma once
// Data parallelism. Besides the executor and the decoder, nothing else starts threads.

#include <cstddef>
#include <functional>

namespace kinloop {

/// Calls `body(begin, end)` for contiguous pieces of [0, count) on up to `threads` threads and waits for all
/// of them. Each call must write only to its own elements, so that the result does not depend on `threads`.
/// Rethrows the first exception.
void parallel_for(size_t count, int threads, const std::function<void(size_t begin, size_t end)>& body);

/// Number of hardware threads, at least 1.
int hardware_threads();

}  // namespace kinloop
