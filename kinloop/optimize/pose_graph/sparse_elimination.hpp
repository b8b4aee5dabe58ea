#pragma once
// In: which blocks of a symmetric matrix are not zero. Out: in which order to eliminate its block columns,
// and what that fills in. It depends on the pattern alone, so one plan serves all matrices of that pattern,
// whatever the size of their blocks.

#include <cstdint>
#include <utility>
#include <vector>

namespace kinloop {

/// The non-zero blocks of a symmetric block matrix: the whole diagonal, and these (row, column) with row >
/// column.
struct BlockPattern {
  uint32_t size = 0;                                        ///< blocks on the diagonal
  std::vector<std::pair<uint32_t, uint32_t>> off_diagonal;  ///< each once
};

/// Block columns that are eliminated together, since they fill in the same rows. All rows and columns are
/// positions in the order of elimination; "local" ones count from the supernode's own first, through `rows`.
struct Supernode {
  /// An off-diagonal block of the matrix that enters here.
  struct Entry {
    uint32_t index;  ///< in BlockPattern::off_diagonal
    uint32_t local_row, local_column;
    bool transposed;  ///< the order of elimination swaps its row and column
  };

  uint32_t begin = 0, end = 0;      ///< its own columns
  std::vector<uint32_t> rows;       ///< below its own columns, ascending
  std::vector<uint32_t> children;   ///< supernodes, each of a smaller index
  std::vector<uint32_t> to_parent;  ///< local row in the parent of each of `rows`
  std::vector<Entry> entries;

  [[nodiscard]] uint32_t columns() const { return end - begin; }
};

/// How to eliminate a symmetric block matrix.
struct EliminationPlan {
  std::vector<uint32_t> position;  ///< of each block column in the order of elimination
  std::vector<Supernode> supernodes;
  double factor_products = 0;  ///< products of two blocks that a factorisation takes
  double factor_blocks = 0;    ///< blocks of the factor; a solution takes two products with a vector for each
};

/// Plans with few fill-ins: approximate minimum degree (Amestoy et al. 1996), or nested dissection (Karypis
/// and Kumar 1998) where that costs less; supernodes are merged where few zeros are then stored.
EliminationPlan plan_elimination(const BlockPattern& pattern);

/// Plans with this order: order[k] is the k-th block column to be eliminated.
EliminationPlan plan_elimination(const BlockPattern& pattern, const std::vector<uint32_t>& order);

}  // namespace kinloop
