#pragma once
// Which keyframes could support a loop that waits for others.

#include <vector>

#include "kinloop/loop/verification/verify_loop.hpp"

namespace kinloop {

/// Returns the hypotheses that follow from a verified loop for the keyframes around it: those that share
/// landmarks with `loop.b` may see the place of `loop.a`, and the other way round. Pieces of a recording
/// overlap in a few keyframes only, not all of which place recognition finds. Their `support` is 2, with
/// which `verify_loops` asks for fewer inliers.
std::vector<LoopVerificationProblem> seek_support(const Map& map, const LoopClosure& loop,
                                                  const LocalMapOptions& options);

}  // namespace kinloop
