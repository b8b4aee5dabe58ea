#pragma once
// How threads share a processor that is too small for all of them.

namespace kinloop {

/// From now on the calling thread, and those it starts, work only as far as others leave it time.
void give_way();

}  // namespace kinloop
