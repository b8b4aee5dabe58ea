#include "kinloop/optimize/block_cholesky.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <gtest/gtest.h>

#include "kinloop/base/random.hpp"

namespace kinloop {
namespace {

constexpr int kBlock = 3;

struct Matrices {
  BlockSymmetric<kBlock> sparse;
  Eigen::MatrixXd dense;
};

/// A random positive definite matrix in which about `share` of the blocks are filled.
Matrices random_matrices(uint32_t blocks, double share, Random& random) {
  Matrices m;
  m.dense = Eigen::MatrixXd::Zero(kBlock * blocks, kBlock * blocks);
  for (uint32_t c = 0; c < blocks; ++c) {
    std::vector<uint32_t> rows{c};
    for (uint32_t r = c + 1; r < blocks; ++r) {
      if (random.uniform() < share) rows.push_back(r);
    }
    m.sparse.add_column(rows);
    for (const uint32_t r : rows) {
      Eigen::Matrix3d block = Eigen::Matrix3d::NullaryExpr([&] { return random.gaussian(); });
      if (r == c) block = (block * block.transpose() + 4.0 * blocks * Eigen::Matrix3d::Identity()).eval();
      m.sparse.blocks[m.sparse.find(r, c)] = block;
      m.dense.block<kBlock, kBlock>(kBlock * r, kBlock * c) = block;
      m.dense.block<kBlock, kBlock>(kBlock * c, kBlock * r) = block.transpose();
    }
  }
  return m;
}

TEST(BlockCholesky, SolvesLikeTheDenseFactor) {
  Random random(1);
  for (const double share : {0.0, 0.1, 0.4, 1.0}) {
    const Matrices m = random_matrices(20, share, random);
    BlockCholesky<kBlock> cholesky(m.sparse);
    ASSERT_TRUE(cholesky.factorize(m.sparse));
    const Eigen::MatrixXd rhs = Eigen::MatrixXd::NullaryExpr(60, 4, [&] { return random.gaussian(); });
    EXPECT_LT((cholesky.solve(rhs) - m.dense.ldlt().solve(rhs)).norm(), 1e-12) << share;
  }
}

TEST(BlockCholesky, InverseDiagonalIsThatOfTheInverse) {
  Random random(2);
  for (const double share : {0.0, 0.1, 0.4, 1.0}) {
    const Matrices m = random_matrices(15, share, random);
    BlockCholesky<kBlock> cholesky(m.sparse);
    ASSERT_TRUE(cholesky.factorize(m.sparse));
    const Eigen::MatrixXd inverse = m.dense.inverse();
    const auto diagonal = cholesky.inverse_diagonal();
    for (size_t i = 0; i < diagonal.size(); ++i) {
      const auto at = static_cast<Eigen::Index>(kBlock * i);
      EXPECT_LT((diagonal[i] - inverse.block<kBlock, kBlock>(at, at)).norm(), 1e-13) << share;
    }
  }
}

TEST(BlockCholesky, SaysWhereAMatrixIsNotPositiveDefinite) {
  Random random(3);
  Matrices m = random_matrices(5, 0.5, random);
  m.sparse.blocks[m.sparse.find(3, 3)] *= -1;
  BlockCholesky<kBlock> cholesky(m.sparse);
  EXPECT_FALSE(cholesky.factorize(m.sparse));
}

}  // namespace
}  // namespace kinloop
