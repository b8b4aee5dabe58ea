#pragma once
// The products of the columns of a tall matrix, the bulk of the work of normal equations. The same bits on
// every instruction set.

#include <cstddef>

namespace kinloop {

constexpr size_t kWidthStep = 8;      ///< the width of a matrix is a multiple of it,
constexpr size_t kMaxGramWidth = 32;  ///< up to this

/// Adds J'J of a matrix of `count` rows and `width` columns, row by row, to `gram` (width x width): what is
/// on the diagonal and to its right; what is to its left is undefined.
void add_gram(const double* J, size_t count, size_t width, double* gram);

}  // namespace kinloop
