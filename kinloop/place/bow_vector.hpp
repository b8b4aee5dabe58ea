#pragma once
// Weighted bags of words and their similarity.

#include <utility>
#include <vector>

#include "kinloop/core/ids.hpp"

namespace kinloop {

/// Word weights sorted by word, each word once, all weights positive, their sum 1 (or no words).
using BowVector = std::vector<std::pair<WordId, float>>;

/// Returns the L1 score of Nister and Stewenius 2006 scaled to [0, 1] as in DBoW2: 1 - |a - b|_1 / 2; 1 for
/// equal vectors, 0 for vectors without a common word.
double similarity(const BowVector& a, const BowVector& b);

}  // namespace kinloop
