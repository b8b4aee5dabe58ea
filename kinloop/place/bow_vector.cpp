#include "kinloop/place/bow_vector.hpp"

#include <algorithm>

namespace kinloop {

double similarity(const BowVector& a, const BowVector& b) {
  // |x - y| = x + y - 2 min(x, y), and the weights of each vector sum to 1, so the score is the sum of min(x,
  // y) over the common words. PlaceIndex::query adds the same terms in the same order.
  double score = 0;
  auto in_a = a.begin();
  auto in_b = b.begin();
  while (in_a != a.end() && in_b != b.end()) {
    if (in_a->first < in_b->first) {
      ++in_a;
    } else if (in_b->first < in_a->first) {
      ++in_b;
    } else {
      score += std::min(in_a->second, in_b->second);
      ++in_a;
      ++in_b;
    }
  }
  return std::min(score, 1.0);  // the weights are rounded, so their sum may exceed 1 in the last digits
}

}  // namespace kinloop
