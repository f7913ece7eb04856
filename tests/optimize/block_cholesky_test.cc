// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The sparse factor against Eigen's dense one.
#include "core/optimize/block_cholesky.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <random>

namespace camloc {
namespace {

using Positions = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

/// A matrix of blocks at these places, the whole of it and the values as BlockCholesky takes them.
struct Matrix {
  Eigen::MatrixXd whole;
  std::vector<double> upper;

  Matrix(std::mt19937& rng, std::uint32_t num_blocks, const Positions& positions, double diagonal) {
    std::normal_distribution<double> normal;
    whole.setZero(6 * num_blocks, 6 * num_blocks);
    for (const auto& [row, column] : positions) {
      Matrix6d block = Matrix6d::NullaryExpr([&] { return normal(rng); });
      if (row == column) block = (block + block.transpose() + diagonal * Matrix6d::Identity()).eval();
      whole.block<6, 6>(6 * row, 6 * column) = block;
      whole.block<6, 6>(6 * column, 6 * row) = block.transpose();
      upper.insert(upper.end(), block.data(), block.data() + 36);
    }
  }
};

/// A chain with a few loops.
Positions chain(std::uint32_t num_blocks) {
  Positions positions;
  for (std::uint32_t i = 0; i < num_blocks; ++i) {
    positions.emplace_back(i, i);
    if (i > 0) positions.emplace_back(i - 1, i);
    if (i % 5 == 4) positions.emplace_back(i / 3, i);
  }
  return positions;
}

TEST(BlockCholesky, SolvesWhatTheDenseFactorSolves) {
  std::mt19937 rng(1);
  for (const std::uint32_t num_blocks : {1U, 2U, 7U, 40U}) {
    const Positions positions = chain(num_blocks);
    BlockCholesky cholesky(num_blocks, positions);
    for (int again = 0; again < 2; ++again) {  // with new values in the same places
      const Matrix matrix(rng, num_blocks, positions, 60);
      ASSERT_TRUE(cholesky.factorize(matrix.upper.data()));
      const Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(6 * num_blocks, -1, 2);
      Eigen::VectorXd x = b;
      cholesky.solve(&x);
      EXPECT_LT((x - matrix.whole.llt().solve(b)).norm(), 1e-12 * b.norm());
    }
  }
}

TEST(BlockCholesky, RefusesWhatIsNotPositiveDefinite) {
  std::mt19937 rng(2);
  const Positions positions = chain(12);
  BlockCholesky cholesky(12, positions);
  EXPECT_FALSE(cholesky.factorize(Matrix(rng, 12, positions, -60).upper.data()));
  EXPECT_TRUE(cholesky.factorize(Matrix(rng, 12, positions, 60).upper.data()));  // and goes on
}

}  // namespace
}  // namespace camloc
