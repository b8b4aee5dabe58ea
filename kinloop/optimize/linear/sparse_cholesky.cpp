#include "kinloop/optimize/linear/sparse_cholesky.hpp"

#include <utility>

#include <Eigen/Cholesky>

namespace kinloop {
namespace {

/// View of a block range.
template <int B>
Eigen::MatrixXd gather(const Eigen::MatrixXd& matrix, const std::vector<uint32_t>& rows) {
  const auto count = static_cast<Eigen::Index>(rows.size());
  Eigen::MatrixXd result(B * count, B * count);
  for (Eigen::Index j = 0; j < count; ++j) {
    for (Eigen::Index i = 0; i < count; ++i) {
      result.block<B, B>(B * i, B * j) =
          matrix.block<B, B>(B * rows[static_cast<size_t>(i)], B * rows[static_cast<size_t>(j)]);
    }
  }
  return result;
}

}  // namespace

template <int B>
Eigen::VectorXd multiply(const BlockPattern& pattern, const BlockMatrix<B>& matrix,
                         const Eigen::VectorXd& x) {
  Eigen::VectorXd product(x.size());
  for (uint32_t i = 0; i < pattern.size; ++i) {
    product.segment<B>(B * i) = matrix.diagonal[i] * x.segment<B>(B * i);
  }
  for (size_t k = 0; k < pattern.off_diagonal.size(); ++k) {
    const auto& [row, column] = pattern.off_diagonal[k];
    product.segment<B>(B * row) += matrix.off_diagonal[k] * x.segment<B>(B * column);
    product.segment<B>(B * column) += matrix.off_diagonal[k].transpose() * x.segment<B>(B * row);
  }
  return product;
}

template <int B>
SparseCholesky<B>::SparseCholesky(const EliminationPlan& plan)
    : plan_(&plan), column_of_(plan.position.size()), updates_(plan.supernodes.size()) {
  for (uint32_t column = 0; column < plan.position.size(); ++column) {
    column_of_[plan.position[column]] = column;
  }
  size_t size = 0;
  for (const Supernode& node : plan.supernodes) {
    panel_begin_.push_back(size);
    size += B * B * node.columns() * (node.columns() + node.rows.size());
  }
  values_ = std::make_unique_for_overwrite<double[]>(size);  // zeroed while it is filled
}

template <int B>
Eigen::Map<Eigen::MatrixXd> SparseCholesky<B>::panel(size_t supernode) {
  const auto read_only = std::as_const(*this).panel(supernode);
  return {values_.get() + panel_begin_[supernode], read_only.rows(), read_only.cols()};
}

template <int B>
Eigen::Map<const Eigen::MatrixXd> SparseCholesky<B>::panel(size_t supernode) const {
  const Supernode& node = plan_->supernodes[supernode];
  const auto columns = static_cast<Eigen::Index>(node.columns());
  return {values_.get() + panel_begin_[supernode],
          B * (columns + static_cast<Eigen::Index>(node.rows.size())), B * columns};
}

template <int B>
void SparseCholesky<B>::assemble(size_t supernode, const BlockMatrix<B>& matrix) {
  const Supernode& node = plan_->supernodes[supernode];
  Panel front = panel(supernode);
  Eigen::MatrixXd& update = updates_[supernode];
  const auto rows = B * static_cast<Eigen::Index>(node.rows.size());
  front.setZero();
  update.setZero(rows, rows);
  for (uint32_t k = 0; k < node.columns(); ++k) {
    front.template block<B, B>(B * k, B * k) = matrix.diagonal[column_of_[node.begin + k]];
  }
  for (const Supernode::Entry& entry : node.entries) {
    auto block = front.template block<B, B>(B * entry.local_row, B * entry.local_column);
    const auto& value = matrix.off_diagonal[entry.index];
    if (entry.transposed) {
      block = value.transpose();
    } else {
      block = value;
    }
  }
  for (const uint32_t child : node.children) {
    const auto& to_here = plan_->supernodes[child].to_parent;
    const Eigen::MatrixXd& from = updates_[child];
    for (size_t j = 0; j < to_here.size(); ++j) {
      const uint32_t column = to_here[j];
      const bool is_own = column < node.columns();
      for (size_t i = j; i < to_here.size(); ++i) {
        const auto block =
            from.block<B, B>(B * static_cast<Eigen::Index>(i), B * static_cast<Eigen::Index>(j));
        if (is_own) {
          front.template block<B, B>(B * to_here[i], B * column) += block;
        } else {
          update.block<B, B>(B * (to_here[i] - node.columns()), B * (column - node.columns())) += block;
        }
      }
    }
    updates_[child].resize(0, 0);
  }
}

template <int B>
bool SparseCholesky<B>::factorize(const BlockMatrix<B>& matrix) {
  for (size_t supernode = 0; supernode < plan_->supernodes.size(); ++supernode) {
    assemble(supernode, matrix);
    Panel front = panel(supernode);
    auto pivots = front.topRows(front.cols());
    if (Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>>(pivots).info() != Eigen::Success) return false;
    auto below = front.bottomRows(front.rows() - front.cols());
    if (below.rows() == 0) continue;
    pivots.template triangularView<Eigen::Lower>().transpose().template solveInPlace<Eigen::OnTheRight>(
        below);
    updates_[supernode].template selfadjointView<Eigen::Lower>().rankUpdate(below, -1.0);
  }
  return true;
}

template <int B>
template <class Right>
Right SparseCholesky<B>::solve(const Right& right) const {
  if (right.size() == 0) return right;
  Right x(right.rows(), right.cols());  // in elimination order
  for (size_t k = 0; k < column_of_.size(); ++k) {
    x.template middleRows<B>(B * static_cast<Eigen::Index>(k)) =
        right.template middleRows<B>(B * column_of_[k]);
  }
  Right gathered;
  const size_t count = plan_->supernodes.size();
  for (size_t supernode = 0; supernode < count; ++supernode) {  // L y = right
    const Supernode& node = plan_->supernodes[supernode];
    const auto front = panel(supernode);
    auto own = x.middleRows(B * node.begin, front.cols());
    front.topRows(front.cols()).template triangularView<Eigen::Lower>().solveInPlace(own);
    gathered.noalias() = front.bottomRows(front.rows() - front.cols()) * own;
    for (size_t i = 0; i < node.rows.size(); ++i) {
      x.template middleRows<B>(B * node.rows[i]) -=
          gathered.template middleRows<B>(B * static_cast<Eigen::Index>(i));
    }
  }
  for (size_t supernode = count; supernode-- > 0;) {  // L' x = y
    const Supernode& node = plan_->supernodes[supernode];
    const auto front = panel(supernode);
    auto own = x.middleRows(B * node.begin, front.cols());
    gathered.resize(front.rows() - front.cols(), right.cols());
    for (size_t i = 0; i < node.rows.size(); ++i) {
      gathered.template middleRows<B>(B * static_cast<Eigen::Index>(i)) =
          x.template middleRows<B>(B * node.rows[i]);
    }
    own.noalias() -= front.bottomRows(front.rows() - front.cols()).transpose() * gathered;
    front.topRows(front.cols()).template triangularView<Eigen::Lower>().transpose().solveInPlace(own);
  }
  Right solution(right.rows(), right.cols());
  for (size_t k = 0; k < column_of_.size(); ++k) {
    solution.template middleRows<B>(B * column_of_[k]) =
        x.template middleRows<B>(B * static_cast<Eigen::Index>(k));
  }
  return solution;
}

/// The inverse Z satisfies Z_21 = -Z_22 G and Z_11 = (L_11 L_11')^-1 - G' Z_21 with G = L_21 L_11^-1, where 1
/// denotes a supernode's own columns and 2 its rows below, all of which are available from its parent.
template <int B>
std::vector<typename BlockMatrix<B>::Block> SparseCholesky<B>::inverse_diagonal() const {
  std::vector<typename BlockMatrix<B>::Block> diagonal(column_of_.size());
  std::vector<Eigen::MatrixXd> Z_22(plan_->supernodes.size());
  for (size_t supernode = plan_->supernodes.size(); supernode-- > 0;) {
    const Supernode& node = plan_->supernodes[supernode];
    const auto front = panel(supernode);
    const Eigen::Index own = front.cols(), below = front.rows() - own;
    Eigen::MatrixXd inverse_factor = Eigen::MatrixXd::Identity(own, own);
    front.topRows(own).template triangularView<Eigen::Lower>().solveInPlace(inverse_factor);
    const Eigen::MatrixXd G = front.bottomRows(below) * inverse_factor;
    Eigen::MatrixXd Z(front.rows(), front.rows());
    Z.bottomRightCorner(below, below) = Z_22[supernode];
    Z.bottomLeftCorner(below, own).noalias() = -Z_22[supernode] * G;
    Z.topRightCorner(own, below) = Z.bottomLeftCorner(below, own).transpose();
    Z.topLeftCorner(own, own).noalias() = inverse_factor.transpose() * inverse_factor;
    Z.topLeftCorner(own, own).noalias() -= G.transpose() * Z.bottomLeftCorner(below, own);
    for (uint32_t k = 0; k < node.columns(); ++k) {
      diagonal[column_of_[node.begin + k]] = Z.block<B, B>(B * k, B * k);
    }
    Z_22[supernode].resize(0, 0);
    for (const uint32_t child : node.children) Z_22[child] = gather<B>(Z, plan_->supernodes[child].to_parent);
  }
  return diagonal;
}

#define KINLOOP_INSTANTIATE(B)                                                                           \
  template Eigen::VectorXd multiply(const BlockPattern&, const BlockMatrix<B>&, const Eigen::VectorXd&); \
  template class SparseCholesky<B>;                                                                      \
  template Eigen::VectorXd SparseCholesky<B>::solve(const Eigen::VectorXd&) const;                       \
  template Eigen::MatrixXd SparseCholesky<B>::solve(const Eigen::MatrixXd&) const;

KINLOOP_INSTANTIATE(2)
KINLOOP_INSTANTIATE(3)
KINLOOP_INSTANTIATE(6)
KINLOOP_INSTANTIATE(12)
#undef KINLOOP_INSTANTIATE

}  // namespace kinloop
