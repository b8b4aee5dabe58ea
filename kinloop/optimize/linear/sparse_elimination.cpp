#include <algorithm>
#include <limits>
#include <memory>
#include <new>
#include <numeric>

#include <cholmod.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/optimize/linear/sparse_cholesky.hpp"

namespace kinloop {
namespace {

constexpr uint32_t kNone = std::numeric_limits<uint32_t>::max();

// Block operations above which nested dissection pays off; it takes longer to compute than minimum degree.
constexpr double kDissectFlops = 5e6;

/// Owns CHOLMOD's workspace.
class Cholmod {
 public:
  Cholmod() { cholmod_start(&common_); }
  ~Cholmod() { cholmod_finish(&common_); }
  Cholmod(const Cholmod&) = delete;
  Cholmod& operator=(const Cholmod&) = delete;
  cholmod_common* operator->() { return &common_; }
  cholmod_common* get() { return &common_; }

 private:
  cholmod_common common_{};
};

/// The lower triangle of the pattern in compressed columns, without the diagonal.
struct LowerColumns {
  std::vector<int> begin;
  std::vector<int> rows;
};

LowerColumns lower_columns(const BlockPattern& pattern) {
  LowerColumns columns;
  columns.begin.assign(pattern.size + 1, 0);
  for (const auto& [row, column] : pattern.off_diagonal) ++columns.begin[column + 1];
  std::partial_sum(columns.begin.begin(), columns.begin.end(), columns.begin.begin());
  columns.rows.resize(pattern.off_diagonal.size());
  std::vector<int> next(columns.begin.begin(), columns.begin.end() - 1);
  for (const auto& [row, column] : pattern.off_diagonal) {
    columns.rows[static_cast<size_t>(next[column]++)] = static_cast<int>(row);
  }
  return columns;
}

struct Ordering {
  std::vector<uint32_t> order;  ///< order[k]: the k-th block column to eliminate
  double flops = std::numeric_limits<double>::infinity();
};

/// Computes an ordering by one of CHOLMOD's methods; infinite flops if it cannot.
Ordering order_by(int method, const BlockPattern& pattern, LowerColumns& columns) {
  Cholmod cholmod;
  cholmod->nmethods = 1;
  cholmod->method[0].ordering = method;
  cholmod->postorder = 1;
  cholmod->supernodal = CHOLMOD_SIMPLICIAL;
  cholmod->print = 0;
  cholmod_sparse matrix{};
  matrix.nrow = matrix.ncol = pattern.size;
  matrix.nzmax = columns.rows.size();
  matrix.p = columns.begin.data();
  matrix.i = columns.rows.data();
  matrix.stype = -1;  // lower triangle
  matrix.itype = CHOLMOD_INT;
  matrix.xtype = CHOLMOD_PATTERN;
  matrix.packed = 1;
  cholmod_factor* factor = cholmod_analyze(&matrix, cholmod.get());
  Ordering ordering;
  if (cholmod->status == CHOLMOD_OUT_OF_MEMORY) throw std::bad_alloc();
  if (factor == nullptr) return ordering;
  const auto* permutation = static_cast<const int*>(factor->Perm);
  ordering.order.assign(permutation, permutation + pattern.size);
  ordering.flops = cholmod->fl;
  cholmod_free_factor(&factor, cholmod.get());
  return ordering;
}

Ordering best_ordering(const BlockPattern& pattern) {
  LowerColumns columns = lower_columns(pattern);
  Ordering best = order_by(CHOLMOD_AMD, pattern, columns);
  require(!best.order.empty(), "sparse elimination: no ordering");
  if (best.flops < kDissectFlops) return best;
  Ordering dissected = order_by(CHOLMOD_METIS, pattern, columns);
  return dissected.flops < best.flops ? dissected : best;
}

/// Returns the rows below the diagonal of each column of the pattern, as elimination positions in ascending
/// order.
std::vector<std::vector<uint32_t>> permuted_columns(const BlockPattern& pattern,
                                                    const std::vector<uint32_t>& position) {
  std::vector<std::vector<uint32_t>> columns(pattern.size);
  for (const auto& [row, column] : pattern.off_diagonal) {
    const auto [low, high] = std::minmax(position[row], position[column]);
    columns[low].push_back(high);
  }
  for (auto& rows : columns) std::sort(rows.begin(), rows.end());
  return columns;
}

std::vector<uint32_t> merged(const std::vector<uint32_t>& a, const std::vector<uint32_t>& b) {
  std::vector<uint32_t> both;
  both.reserve(a.size() + b.size());
  std::set_union(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(both));
  return both;
}

/// Returns the rows of each column of the factor: its own, and those of the columns whose first row it is
/// (George and Liu 1981).
std::vector<std::vector<uint32_t>> fill_in(std::vector<std::vector<uint32_t>> columns) {
  for (auto& rows : columns) {
    if (rows.empty()) continue;
    auto& parent = columns[rows.front()];
    parent = merged(parent, {rows.begin() + 1, rows.end()});
  }
  return columns;
}

/// Whether to merge a child supernode of `child` columns and `child_rows` rows below with its parent of
/// `parent` columns and `parent_rows` rows into one dense block, although that stores zeros.
bool worth_merging(uint32_t child, uint32_t parent, size_t child_rows, size_t parent_rows, double& zeros) {
  // Maximum fraction of zeros in a merged supernode by width: CHOLMOD's limits for scalar columns, converted
  // to blocks of six.
  struct Limit {
    uint32_t columns;
    double zeros;
  };
  constexpr Limit kLimits[] = {{2, 1.0}, {4, 0.5}, {8, 0.15}, {kNone, 0.05}};
  const double extra = child * static_cast<double>(parent + parent_rows - child_rows);
  const double width = child + parent;
  const double stored = width * (width + 1) / 2 + width * static_cast<double>(parent_rows);
  const auto* limit = kLimits;
  while (child + parent > limit->columns) ++limit;
  if (zeros + extra > limit->zeros * stored) return false;
  zeros += extra;
  return true;
}

/// Groups successive columns into supernodes with their rows.
std::vector<Supernode> group_columns(const std::vector<std::vector<uint32_t>>& filled) {
  std::vector<Supernode> supernodes;
  std::vector<double> zeros;
  for (uint32_t column = 0; column < filled.size(); ++column) {
    Supernode node;
    node.begin = column;
    node.end = column + 1;
    node.rows = filled[column];
    double node_zeros = 0;
    // Merge the previous supernode if it is a child of this one.
    while (!supernodes.empty()) {
      const Supernode& child = supernodes.back();
      const bool is_child = !child.rows.empty() && child.rows.front() < node.end;
      double sum = node_zeros + zeros.back();
      if (!is_child ||
          !worth_merging(child.columns(), node.columns(), child.rows.size(), node.rows.size(), sum)) {
        break;
      }
      node.begin = child.begin;
      node_zeros = sum;
      supernodes.pop_back();
      zeros.pop_back();
    }
    supernodes.push_back(std::move(node));
    zeros.push_back(node_zeros);
  }
  return supernodes;
}

uint32_t local_row(const Supernode& node, uint32_t row) {
  if (row < node.end) return row - node.begin;
  const auto found = std::lower_bound(node.rows.begin(), node.rows.end(), row);
  return node.columns() + static_cast<uint32_t>(found - node.rows.begin());
}

/// Links the supernodes to a forest and assigns the blocks of the matrix to them.
void link(const BlockPattern& pattern, EliminationPlan& plan) {
  std::vector<uint32_t> owner(pattern.size);
  for (uint32_t index = 0; index < plan.supernodes.size(); ++index) {
    const Supernode& node = plan.supernodes[index];
    std::fill(owner.begin() + node.begin, owner.begin() + node.end, index);
  }
  for (uint32_t index = 0; index < plan.supernodes.size(); ++index) {
    Supernode& node = plan.supernodes[index];
    if (node.rows.empty()) continue;
    Supernode& parent = plan.supernodes[owner[node.rows.front()]];
    parent.children.push_back(index);
    for (const uint32_t row : node.rows) node.to_parent.push_back(local_row(parent, row));
  }
  for (uint32_t index = 0; index < pattern.off_diagonal.size(); ++index) {
    const auto [row, column] = pattern.off_diagonal[index];
    const auto [low, high] = std::minmax(plan.position[row], plan.position[column]);
    Supernode& node = plan.supernodes[owner[low]];
    node.entries.push_back({index, local_row(node, high), low - node.begin, plan.position[row] == low});
  }
}

void count_costs(EliminationPlan& plan) {
  for (const Supernode& node : plan.supernodes) {
    const double width = node.columns(), below = static_cast<double>(node.rows.size());
    plan.factor_products += width * (width * width / 6 + width * below / 2 + below * below / 2);
    plan.factor_blocks += width * (width + below);
  }
}

}  // namespace

EliminationPlan plan_elimination(const BlockPattern& pattern) {
  if (pattern.size == 0) return {};
  EliminationPlan plan = plan_elimination(pattern, best_ordering(pattern).order);
  return plan;
}

EliminationPlan plan_elimination(const BlockPattern& pattern, const std::vector<uint32_t>& order) {
  require(order.size() == pattern.size, "sparse elimination: order must list every block column once");
  EliminationPlan plan;
  plan.position.resize(pattern.size);
  for (uint32_t k = 0; k < pattern.size; ++k) plan.position[order[k]] = k;
  plan.supernodes = group_columns(fill_in(permuted_columns(pattern, plan.position)));
  link(pattern, plan);
  count_costs(plan);
  return plan;
}

}  // namespace kinloop
