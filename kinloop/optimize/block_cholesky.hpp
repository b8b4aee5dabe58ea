#pragma once
// Sparse symmetric positive definite matrices of C x C blocks and their Cholesky factor. Blocks of fixed size
// keep the arithmetic in registers, need no BLAS (whose rounding changes from machine to machine), and make
// the reduced camera system of bundle adjustment as cheap dense as sparse.

#include <algorithm>
#include <cstdint>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>

namespace kinloop {

/// Lower triangle by columns: column c holds the rows rows[begin[c]] ... rows[begin[c + 1] - 1], ascending,
/// the diagonal first.
template <int C>
struct BlockSymmetric {
  using Block = Eigen::Matrix<double, C, C>;

  std::vector<size_t> begin = {0};
  std::vector<uint32_t> rows;
  std::vector<Block> blocks;

  [[nodiscard]] size_t columns() const { return begin.size() - 1; }

  /// Appends a column whose rows are ascending and begin with its own index; blocks become zero.
  void add_column(const std::vector<uint32_t>& column_rows) {
    rows.insert(rows.end(), column_rows.begin(), column_rows.end());
    blocks.resize(rows.size(), Block::Zero());
    begin.push_back(rows.size());
  }

  /// Block at (row, column), row >= column, which must be in the pattern.
  [[nodiscard]] size_t find(uint32_t row, uint32_t column) const {
    const auto first = rows.begin() + static_cast<std::ptrdiff_t>(begin[column]);
    const auto last = rows.begin() + static_cast<std::ptrdiff_t>(begin[column + 1]);
    return static_cast<size_t>(std::lower_bound(first, last, row) - rows.begin());
  }
};

/// P A P' = L L' with a fill-reducing permutation P (approximate minimum degree). The pattern is analysed
/// once.
template <int C>
class BlockCholesky {
 public:
  using Block = typename BlockSymmetric<C>::Block;

  explicit BlockCholesky(const BlockSymmetric<C>& pattern) {
    order(pattern);
    add_fill(pattern);
  }

  /// False where the matrix is not positive definite.
  bool factorize(const BlockSymmetric<C>& A) {
    load(A);
    for (size_t k = 0; k < L_.columns(); ++k) {
      if (!eliminate(k)) return false;
    }
    return true;
  }

  /// A^-1 * rhs, any number of columns.
  [[nodiscard]] Eigen::MatrixXd solve(const Eigen::MatrixXd& rhs) const {
    Eigen::MatrixXd x(rhs.rows(), rhs.cols());
    for (size_t k = 0; k < L_.columns(); ++k) segment(x, k) = segment(rhs, order_[k]);
    for (size_t k = 0; k < L_.columns(); ++k) {
      L_.blocks[L_.begin[k]].template triangularView<Eigen::Lower>().solveInPlace(segment(x, k));
      for (size_t i = L_.begin[k] + 1; i < L_.begin[k + 1]; ++i) {
        segment(x, L_.rows[i]).noalias() -= L_.blocks[i] * segment(x, k);
      }
    }
    for (size_t k = L_.columns(); k-- > 0;) {
      for (size_t i = L_.begin[k] + 1; i < L_.begin[k + 1]; ++i) {
        segment(x, k).noalias() -= L_.blocks[i].transpose() * segment(x, L_.rows[i]);
      }
      L_.blocks[L_.begin[k]].transpose().template triangularView<Eigen::Upper>().solveInPlace(segment(x, k));
    }
    Eigen::MatrixXd result(rhs.rows(), rhs.cols());
    for (size_t k = 0; k < L_.columns(); ++k) segment(result, order_[k]) = segment(x, k);
    return result;
  }

  /// The diagonal blocks of A^-1, without the rest of it (Takahashi et al. 1973): the inverse Z obeys
  /// Z_Ik = -Z_II G and Z_kk = (L_kk L_kk')^-1 - G' Z_Ik with G = L_Ik L_kk^-1, I the rows below the
  /// diagonal.
  [[nodiscard]] std::vector<Block> inverse_diagonal() const {
    BlockSymmetric<C> Z = L_;
    std::vector<Block> diagonal(L_.columns());
    std::vector<Block> G;
    for (size_t k = L_.columns(); k-- > 0;) {
      const size_t first = L_.begin[k], count = L_.begin[k + 1] - first;
      const Block inverse_factor =
          L_.blocks[first].template triangularView<Eigen::Lower>().solve(Block::Identity());
      G.assign(count, Block::Zero());
      for (size_t i = 1; i < count; ++i) G[i] = L_.blocks[first + i] * inverse_factor;
      Block corner = inverse_factor.transpose() * inverse_factor;
      for (size_t i = 1; i < count; ++i) {
        Block sum = Block::Zero();
        for (size_t j = 1; j < count; ++j) {
          const uint32_t row = L_.rows[first + i], column = L_.rows[first + j];
          if (row >= column) {
            sum.noalias() -= Z.blocks[Z.find(row, column)] * G[j];
          } else {
            sum.noalias() -= Z.blocks[Z.find(column, row)].transpose() * G[j];
          }
        }
        Z.blocks[first + i] = sum;
        corner.noalias() -= G[i].transpose() * sum;
      }
      Z.blocks[first] = corner;
      diagonal[order_[k]] = corner;
    }
    return diagonal;
  }

 private:
  template <class Matrix>
  static auto segment(Matrix& x, size_t block) {
    return x.template middleRows<C>(static_cast<Eigen::Index>(block) * C);
  }

  void order(const BlockSymmetric<C>& pattern) {
    const auto n = static_cast<int>(pattern.columns());
    std::vector<Eigen::Triplet<double>> entries;
    for (int c = 0; c < n; ++c) {
      for (size_t i = pattern.begin[static_cast<size_t>(c)]; i < pattern.begin[static_cast<size_t>(c) + 1];
           ++i) {
        const int r = static_cast<int>(pattern.rows[i]);
        entries.emplace_back(r, c, 1.0);
        if (r != c) entries.emplace_back(c, r, 1.0);
      }
    }
    Eigen::SparseMatrix<double> graph(n, n);
    graph.setFromTriplets(entries.begin(), entries.end());
    Eigen::AMDOrdering<int>::PermutationType permutation;
    Eigen::AMDOrdering<int>()(graph, permutation);
    order_.resize(static_cast<size_t>(n));
    position_.resize(static_cast<size_t>(n));
    for (int k = 0; k < n; ++k) {
      const auto old = static_cast<size_t>(permutation.indices()(k));
      order_[static_cast<size_t>(k)] = old;
      position_[old] = static_cast<uint32_t>(k);
    }
  }

  /// The pattern of L: a column passes its rows on to the first of them (the elimination tree).
  void add_fill(const BlockSymmetric<C>& pattern) {
    std::vector<std::vector<uint32_t>> rows(pattern.columns());
    for (uint32_t c = 0; c < pattern.columns(); ++c) {
      for (size_t i = pattern.begin[c]; i < pattern.begin[c + 1]; ++i) {
        const uint32_t a = position_[c], b = position_[pattern.rows[i]];
        rows[std::min(a, b)].push_back(std::max(a, b));
      }
    }
    for (auto& column : rows) {
      std::sort(column.begin(), column.end());
      column.erase(std::unique(column.begin(), column.end()), column.end());
      L_.add_column(column);
      if (column.size() < 2) continue;
      auto& parent = rows[column[1]];
      parent.insert(parent.end(), column.begin() + 1, column.end());
    }
  }

  void load(const BlockSymmetric<C>& A) {
    std::fill(L_.blocks.begin(), L_.blocks.end(), Block::Zero());
    for (uint32_t c = 0; c < A.columns(); ++c) {
      for (size_t i = A.begin[c]; i < A.begin[c + 1]; ++i) {
        const uint32_t a = position_[c], b = position_[A.rows[i]];
        if (b >= a) {
          L_.blocks[L_.find(b, a)] = A.blocks[i];
        } else {
          L_.blocks[L_.find(a, b)] = A.blocks[i].transpose();
        }
      }
    }
  }

  /// Finishes column k and takes its part out of the columns that follow.
  bool eliminate(size_t k) {
    const size_t first = L_.begin[k], last = L_.begin[k + 1];
    const Eigen::LLT<Block> llt(L_.blocks[first]);
    if (llt.info() != Eigen::Success) return false;
    L_.blocks[first] = llt.matrixL();
    for (size_t i = first + 1; i < last; ++i) {
      L_.blocks[i] = L_.blocks[first]
                         .template triangularView<Eigen::Lower>()
                         .solve(L_.blocks[i].transpose())
                         .transpose();
    }
    for (size_t j = first + 1; j < last; ++j) {
      const Block right = L_.blocks[j].transpose();
      size_t target = L_.begin[L_.rows[j]];
      for (size_t i = j; i < last; ++i) {
        while (L_.rows[target] != L_.rows[i]) ++target;  // the column holds all of these rows
        L_.blocks[target].noalias() -= L_.blocks[i].lazyProduct(right);
      }
    }
    return true;
  }

  std::vector<size_t> order_;       // column of A eliminated as k-th
  std::vector<uint32_t> position_;  // and its inverse
  BlockSymmetric<C> L_;
};

}  // namespace kinloop
