// The sparse linear algebra of the built-in solver, compared with dense algebra.

#include <Eigen/Dense>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kinloop/core/random.hpp"
#include "kinloop/optimize/linear/sparse_cholesky.hpp"
#include "kinloop/optimize/pose_graph/solvers/pose_graph_minimizer.hpp"

namespace kinloop {
namespace {

/// A chain with random additional edges.
BlockPattern random_pattern(uint32_t size, uint32_t chords, Random& random) {
  BlockPattern pattern{size, {}};
  for (uint32_t i = 1; i < size; ++i) pattern.off_diagonal.emplace_back(i, i - 1);
  for (uint32_t i = 0; i < chords; ++i) {
    const uint32_t row = 2 + random.index(size - 2);
    pattern.off_diagonal.emplace_back(row, random.index(row - 1));
  }
  std::sort(pattern.off_diagonal.begin(), pattern.off_diagonal.end());
  pattern.off_diagonal.erase(std::unique(pattern.off_diagonal.begin(), pattern.off_diagonal.end()),
                             pattern.off_diagonal.end());
  return pattern;
}

/// J'J with one random row block of 2B columns per pair, plus a small diagonal.
template <int B>
BlockMatrix<B> random_matrix(const BlockPattern& pattern, Random& random) {
  BlockMatrix<B> matrix(pattern);
  const auto random_block = [&] {
    Eigen::Matrix<double, B, B> block;
    for (int i = 0; i < block.size(); ++i) block.data()[i] = random.gaussian();
    return block;
  };
  for (auto& block : matrix.diagonal) block.setIdentity();
  for (size_t k = 0; k < pattern.off_diagonal.size(); ++k) {
    const auto [row, column] = pattern.off_diagonal[k];
    const auto at_row = random_block(), at_column = random_block();
    matrix.diagonal[row] += at_row.transpose() * at_row;
    matrix.diagonal[column] += at_column.transpose() * at_column;
    matrix.off_diagonal[k] = at_row.transpose() * at_column;
  }
  return matrix;
}

template <int B>
Eigen::MatrixXd dense(const BlockPattern& pattern, const BlockMatrix<B>& matrix) {
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(B * pattern.size, B * pattern.size);
  for (uint32_t i = 0; i < pattern.size; ++i) result.block<B, B>(B * i, B * i) = matrix.diagonal[i];
  for (size_t k = 0; k < pattern.off_diagonal.size(); ++k) {
    const auto [row, column] = pattern.off_diagonal[k];
    result.block<B, B>(B * row, B * column) = matrix.off_diagonal[k];
    result.block<B, B>(B * column, B * row) = matrix.off_diagonal[k].transpose();
  }
  return result;
}

Eigen::MatrixXd random_right(Eigen::Index rows, Eigen::Index columns, Random& random) {
  Eigen::MatrixXd right(rows, columns);
  for (int i = 0; i < right.size(); ++i) right.data()[i] = random.gaussian();
  return right;
}

template <class Size>
class SparseBlocks : public testing::Test {};
using Sizes = testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 3>,
                             std::integral_constant<int, 6>, std::integral_constant<int, 12>>;
TYPED_TEST_SUITE(SparseBlocks, Sizes);

TYPED_TEST(SparseBlocks, SolveAndMultiplyAsDenseDoes) {
  constexpr int kB = TypeParam::value;
  Random random(1);
  for (const uint32_t size : {2U, 3U, 10U, 40U, 80U}) {
    const BlockPattern pattern = random_pattern(std::max(size, 3U), size, random);
    const auto matrix = random_matrix<kB>(pattern, random);
    const EliminationPlan plan = plan_elimination(pattern);
    SparseCholesky<kB> cholesky(plan);
    ASSERT_TRUE(cholesky.factorize(matrix));
    const Eigen::MatrixXd full = dense(pattern, matrix);
    const Eigen::MatrixXd right = random_right(full.rows(), 3, random);
    EXPECT_LT((full * cholesky.solve(right) - right).norm(), 1e-9 * right.norm());
    const Eigen::VectorXd x = right.col(0);
    EXPECT_LT((full * x - multiply(pattern, matrix, x)).norm(), 1e-12 * full.norm());
  }
}

TYPED_TEST(SparseBlocks, OnePlanServesManyMatrices) {
  constexpr int kB = TypeParam::value;
  Random random(2);
  const BlockPattern pattern = random_pattern(30, 20, random);
  const EliminationPlan plan = plan_elimination(pattern);
  SparseCholesky<kB> cholesky(plan);
  for (int i = 0; i < 3; ++i) {
    const auto matrix = random_matrix<kB>(pattern, random);
    ASSERT_TRUE(cholesky.factorize(matrix));
    const Eigen::MatrixXd right = random_right(kB * 30, 1, random);
    EXPECT_LT((dense(pattern, matrix) * cholesky.solve(right) - right).norm(), 1e-9 * right.norm());
  }
}

TYPED_TEST(SparseBlocks, InverseDiagonalIsThatOfTheInverse) {
  constexpr int kB = TypeParam::value;
  Random random(8);
  for (const uint32_t chords : {0U, 10U, 40U, 400U}) {
    const BlockPattern pattern = random_pattern(25, chords, random);
    const auto matrix = random_matrix<kB>(pattern, random);
    const EliminationPlan plan = plan_elimination(pattern);
    SparseCholesky<kB> cholesky(plan);
    ASSERT_TRUE(cholesky.factorize(matrix));
    const Eigen::MatrixXd inverse = dense(pattern, matrix).inverse();
    const auto diagonal = cholesky.inverse_diagonal();
    ASSERT_EQ(diagonal.size(), pattern.size);
    for (uint32_t i = 0; i < pattern.size; ++i) {
      const auto expected = inverse.block<kB, kB>(kB * i, kB * i);
      EXPECT_LT((diagonal[i] - expected).norm(), 1e-10 * expected.norm()) << chords << " chords, block " << i;
    }
  }
}

TEST(SparseCholesky, RejectsIndefiniteMatrices) {
  Random random(3);
  const BlockPattern pattern = random_pattern(20, 10, random);
  auto matrix = random_matrix<3>(pattern, random);
  matrix.diagonal[7](1, 1) = -1;
  const EliminationPlan plan = plan_elimination(pattern);
  EXPECT_FALSE(SparseCholesky<3>(plan).factorize(matrix));
}

TEST(SparseElimination, CoversEveryColumnOnceWithChildrenFirst) {
  Random random(4);
  const BlockPattern pattern = random_pattern(200, 150, random);
  const EliminationPlan plan = plan_elimination(pattern);
  std::vector<uint32_t> sorted = plan.position;
  std::sort(sorted.begin(), sorted.end());
  ASSERT_EQ(sorted.size(), pattern.size);
  for (uint32_t i = 0; i < sorted.size(); ++i) ASSERT_EQ(sorted[i], i);
  uint32_t next = 0;
  size_t entries = 0;
  for (uint32_t index = 0; index < plan.supernodes.size(); ++index) {
    const Supernode& node = plan.supernodes[index];
    EXPECT_EQ(node.begin, next);
    next = node.end;
    entries += node.entries.size();
    for (const uint32_t child : node.children) EXPECT_LT(child, index);
    EXPECT_TRUE(std::is_sorted(node.rows.begin(), node.rows.end()));
    for (const uint32_t row : node.rows) EXPECT_GE(row, node.end);
  }
  EXPECT_EQ(next, pattern.size);
  EXPECT_EQ(entries, pattern.off_diagonal.size());
}

TEST(SparseElimination, AnEmptyPatternHasAnEmptyPlan) {
  EXPECT_TRUE(plan_elimination({}).supernodes.empty());
}

TEST(SparseElimination, NestedDissectionIsTriedForLargePatterns) {
  // A square grid of this size has enough fill-in for both orderings to be tried.
  constexpr uint32_t kSide = 90;
  BlockPattern pattern{kSide * kSide, {}};
  for (uint32_t i = 0; i < kSide * kSide; ++i) {
    if (i % kSide + 1 < kSide) pattern.off_diagonal.emplace_back(i + 1, i);
    if (i + kSide < kSide * kSide) pattern.off_diagonal.emplace_back(i + kSide, i);
  }
  Random random(5);
  const auto matrix = random_matrix<2>(pattern, random);
  const EliminationPlan plan = plan_elimination(pattern);
  SparseCholesky<2> cholesky(plan);
  ASSERT_TRUE(cholesky.factorize(matrix));
  const Eigen::VectorXd right = random_right(2 * pattern.size, 1, random);
  const Eigen::VectorXd x = cholesky.solve(right);
  EXPECT_LT((multiply(pattern, matrix, x) - right).norm(), 1e-9 * right.norm());
}

TEST(NewtonSolver, SolvesSequencesOfSimilarAndDissimilarSystems) {
  Random random(6);
  const BlockPattern pattern = random_pattern(40, 30, random);
  const EliminationPlan plan = plan_elimination(pattern);
  NewtonSolver<6> newton(pattern, plan);
  auto matrix = random_matrix<6>(pattern, random);
  for (const double change : {0.0, 0.001, 0.01, 0.3, 10.0}) {
    for (auto& block : matrix.diagonal) block *= 1 + change * random.uniform();
    const Eigen::VectorXd b = random_right(6 * 40, 1, random);
    const auto d = newton.solve(matrix, b, 0);
    ASSERT_TRUE(d.has_value());
    const Eigen::VectorXd exact = dense(pattern, matrix).llt().solve(b);
    const Eigen::VectorXd error = *d - exact;
    // In the energy norm, the stopping criterion of conjugate gradients.
    EXPECT_LT(error.dot(multiply(pattern, matrix, error)), 1e-3 * exact.dot(b))
        << "after a change of " << change;
  }
}

TEST(NewtonSolver, SolvesASingularSystemWithSlightDamping) {
  BlockPattern pattern{2, {{1, 0}}};
  BlockMatrix<3> matrix(pattern);
  matrix.diagonal[0] = matrix.diagonal[1] = Eigen::Vector3d(1, 1, 0).asDiagonal();
  matrix.off_diagonal[0] = Eigen::Vector3d(0.5, 0, 0).asDiagonal();
  Eigen::VectorXd b(6);
  b << 1, 2, 0, 3, 4, 0;
  const EliminationPlan plan = plan_elimination(pattern);
  const auto d = NewtonSolver<3>(pattern, plan).solve(matrix, b, 0);
  ASSERT_TRUE(d.has_value());
  EXPECT_LT((multiply(pattern, matrix, *d) - b).norm(), 1e-6);
  EXPECT_NEAR((*d)[2], 0, 1e-12);
}

TEST(NewtonSolver, GivesUpOnAnIndefiniteSystem) {
  BlockPattern pattern{1, {}};
  BlockMatrix<3> matrix(pattern);
  matrix.diagonal[0] = Eigen::Vector3d(1, 1, -1e9).asDiagonal();
  const EliminationPlan plan = plan_elimination(pattern);
  EXPECT_FALSE(NewtonSolver<3>(pattern, plan).solve(matrix, Eigen::VectorXd::Ones(3), 0).has_value());
}

}  // namespace
}  // namespace kinloop
