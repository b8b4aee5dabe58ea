#pragma once
// How threads share a processor that is too small for all of them.

namespace kinloop {

/// How much of the processor a thread leaves to others that want it.
enum class GiveWay {
  kMost,       ///< nine tenths: it still answers soon
  kNearlyAll,  ///< all but a thirtieth
};

/// From now on the calling thread, and those it starts, work only as far as others leave it time.
void give_way(GiveWay share);

}  // namespace kinloop
