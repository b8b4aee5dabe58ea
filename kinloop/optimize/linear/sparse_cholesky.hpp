#pragma once
// Sparse Cholesky factorisation of symmetric positive definite matrices of B x B blocks: solves linear
// systems and computes the diagonal blocks of the inverse.
//
// Used by pose graphs (B = 3 and 6; 2 and 3 for chordal initialization) and the camera systems of bundle
// adjustment (B = 6 and 12). A multifrontal factorisation (Duff and Reid 1983) on dense Eigen blocks. It is
// single-threaded, sums in a fixed order and calls no BLAS, so its result is bitwise reproducible on any
// machine.

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include <Eigen/Core>

namespace kinloop {

// Elimination order and symbolic factorisation of a symmetric block matrix. They depend only on the pattern,
// so one plan serves all matrices of that pattern, for any block size.

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

/// The blocks of a symmetric matrix in the order of its BlockPattern.
template <int B>
struct BlockMatrix {
  using Block = Eigen::Matrix<double, B, B>;

  std::vector<Block> diagonal;
  std::vector<Block> off_diagonal;

  explicit BlockMatrix(const BlockPattern& pattern)
      : diagonal(pattern.size, Block::Zero()), off_diagonal(pattern.off_diagonal.size(), Block::Zero()) {}

  void set_zero() {
    std::fill(diagonal.begin(), diagonal.end(), Block::Zero());
    std::fill(off_diagonal.begin(), off_diagonal.end(), Block::Zero());
  }
};

/// Returns matrix * x.
template <int B>
Eigen::VectorXd multiply(const BlockPattern& pattern, const BlockMatrix<B>& matrix, const Eigen::VectorXd& x);

/// Cholesky factor of block matrices of one pattern.
template <int B>
class SparseCholesky {
 public:
  /// The plan must outlive this object.
  explicit SparseCholesky(const EliminationPlan& plan);

  /// Factorises `matrix`. Returns false if it is not positive definite; `solve` must not be called then.
  [[nodiscard]] bool factorize(const BlockMatrix<B>& matrix);

  /// Returns x with matrix * x = right for each column of `right`, a VectorXd or a MatrixXd.
  template <class Right>
  [[nodiscard]] Right solve(const Right& right) const;

  /// Returns the diagonal blocks of the inverse without computing the rest (Takahashi et al. 1973).
  [[nodiscard]] std::vector<typename BlockMatrix<B>::Block> inverse_diagonal() const;

 private:
  using Panel = Eigen::Map<Eigen::MatrixXd>;

  Panel panel(size_t supernode);
  [[nodiscard]] Eigen::Map<const Eigen::MatrixXd> panel(size_t supernode) const;
  void assemble(size_t supernode, const BlockMatrix<B>& matrix);

  const EliminationPlan* plan_;
  std::vector<uint32_t> column_of_;       // block column of the matrix at each elimination position
  std::vector<size_t> panel_begin_;       // index into values_
  std::unique_ptr<double[]> values_;      // the factor: a dense panel per supernode
  std::vector<Eigen::MatrixXd> updates_;  // update that each supernode subtracts from its ancestors
};

}  // namespace kinloop
