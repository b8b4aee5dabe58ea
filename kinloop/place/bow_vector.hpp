#pragma once
// What an image looks like, as a weighted bag of words, and how alike two images are.

#include <utility>
#include <vector>

#include "kinloop/base/ids.hpp"

namespace kinloop {

/// Word weights in ascending order of word, each word once, all weights positive, their sum 1 (or no words).
using BowVector = std::vector<std::pair<WordId, float>>;

/// L1 score of Nister and Stewenius 2006 scaled to [0, 1] as in DBoW2: 1 - |a - b|_1 / 2; 1 for equal
/// vectors, 0 for vectors without a common word.
double similarity(const BowVector& a, const BowVector& b);

}  // namespace kinloop
