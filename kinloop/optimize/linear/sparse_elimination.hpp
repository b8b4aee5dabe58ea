#pragma once
// Elimination order and symbolic factorisation of a symmetric block matrix. They depend only on the pattern,
// so one plan serves all matrices of that pattern, for any block size.

#include <cstdint>
#include <utility>
#include <vector>

namespace kinloop {

/// The non-zero blocks of a symmetric block matrix: the whole diagonal, and the given (row, column) pairs
/// with row > column.
struct BlockPattern {
  uint32_t size = 0;                                        ///< number of diagonal blocks
  std::vector<std::pair<uint32_t, uint32_t>> off_diagonal;  ///< each once
};

/// Block columns that are eliminated together because they have the same fill-in. All rows and columns are
/// elimination positions; "local" ones are relative to the supernode's first column, through `rows`.
struct Supernode {
  /// An off-diagonal block of the matrix assigned to this supernode.
  struct Entry {
    uint32_t index;  ///< index into BlockPattern::off_diagonal
    uint32_t local_row, local_column;
    bool transposed;  ///< row and column are swapped in elimination order
  };

  uint32_t begin = 0, end = 0;      ///< its own columns
  std::vector<uint32_t> rows;       ///< below its own columns, ascending
  std::vector<uint32_t> children;   ///< supernodes with smaller indices
  std::vector<uint32_t> to_parent;  ///< local row in the parent of each element of `rows`
  std::vector<Entry> entries;

  [[nodiscard]] uint32_t columns() const { return end - begin; }
};

/// Elimination plan of a symmetric block matrix.
struct EliminationPlan {
  std::vector<uint32_t> position;  ///< elimination position of each block column
  std::vector<Supernode> supernodes;
  double factor_products = 0;  ///< block products of a factorisation
  double factor_blocks = 0;    ///< blocks of the factor; a solve takes two matrix-vector products per block
};

/// Returns a plan with little fill-in: approximate minimum degree (Amestoy et al. 1996), or nested dissection
/// (Karypis and Kumar 1998) if that costs less. Supernodes are merged if this stores few zeros.
EliminationPlan plan_elimination(const BlockPattern& pattern);

/// Returns a plan with this order: order[k] is the k-th block column to eliminate.
EliminationPlan plan_elimination(const BlockPattern& pattern, const std::vector<uint32_t>& order);

}  // namespace kinloop
