#pragma once
// J'J of a tall matrix, the bulk of the work of normal equations. Bitwise identical on every instruction set.

#include <cstddef>

namespace kinloop {

constexpr size_t kWidthStep = 8;      ///< the width of a matrix is a multiple of this
constexpr size_t kMaxGramWidth = 32;  ///< maximum width

/// Adds J'J of a row-major matrix with `count` rows and `width` columns to `gram` (width x width). Only the
/// upper triangle is defined.
void add_gram(const double* J, size_t count, size_t width, double* gram);

}  // namespace kinloop
