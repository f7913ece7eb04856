// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Dense and sparse solutions of block systems against Eigen's of the whole matrix.
#include "core/optimize/block_system.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <random>

namespace camloc {
namespace {

/// A random positive definite matrix with these blocks.
struct Sample {
  BlockPattern pattern;
  Eigen::MatrixXd matrix;
  Eigen::VectorXd gradient;

  Sample(std::mt19937& rng, std::uint32_t num_blocks, std::uint32_t num_pairs) : pattern(num_blocks) {
    const auto size = static_cast<Eigen::Index>(6 * num_blocks);
    matrix = 0.1 * Eigen::MatrixXd::Identity(size, size);
    std::normal_distribution<double> normal;
    gradient = Eigen::VectorXd::NullaryExpr(size, [&] { return normal(rng); });
    std::uniform_int_distribution<std::uint32_t> any(0, num_blocks - 1);
    for (std::uint32_t k = 0; k < num_pairs; ++k) {
      const std::uint32_t i = any(rng), j = any(rng);
      pattern.add(i, j);
      Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(6, size);
      rows.middleCols<6>(6 * i) = Matrix6d::NullaryExpr([&] { return normal(rng); });
      if (i != j) rows.middleCols<6>(6 * j) = Matrix6d::NullaryExpr([&] { return normal(rng); });
      matrix += rows.transpose() * rows;
    }
  }

  void fill(BlockSystem* system) const {
    for (std::uint32_t column = 0; column < system->num_blocks(); ++column) {
      system->gradient(column) = gradient.segment<6>(6 * column);
      for (std::uint32_t row = 0; row <= column; ++row) {
        if (system->is_sparse() && !pattern.has(row, column)) continue;
        Matrix6d block = matrix.block<6, 6>(6 * row, 6 * column);
        if (row == column) block.triangularView<Eigen::StrictlyLower>().setConstant(1e9);  // does not count
        Eigen::Map<Matrix6d>(system->block(row, column)) = block;
      }
    }
  }

  [[nodiscard]] double error(const std::vector<Vector6d>& x) const {
    const Eigen::Map<const Eigen::VectorXd> flat(x[0].data(), gradient.size());
    return (matrix * flat + gradient).norm() / gradient.norm();
  }
};

TEST(BlockSystem, SolvesDenseAndSparse) {
  std::mt19937 rng(1);
  for (const auto& [num_blocks, num_pairs] : {std::pair{1U, 1U}, {5U, 3U}, {40U, 60U}, {70U, 100U}, {30U, 400U}}) {
    const Sample sample(rng, num_blocks, num_pairs);
    BlockSystem dense(num_blocks), sparse(sample.pattern);
    std::vector<Vector6d> x, y;
    for (int repetition = 0; repetition < 2; ++repetition) {  // the analysis is kept
      sample.fill(&dense);
      sample.fill(&sparse);
      ASSERT_TRUE(dense.solve(&x));
      ASSERT_TRUE(sparse.solve(&y));
      EXPECT_LT(sample.error(x), 1e-9);
      EXPECT_LT(sample.error(y), 1e-9);
    }
  }
}

TEST(BlockSystem, SaysWhenNotPositiveDefinite) {
  std::mt19937 rng(2);
  Sample sample(rng, 20, 30);
  sample.matrix.block<6, 6>(60, 60) -= 100 * Matrix6d::Identity();
  BlockSystem dense(20), sparse(sample.pattern);
  sample.fill(&dense);
  sample.fill(&sparse);
  std::vector<Vector6d> x;
  EXPECT_FALSE(dense.solve(&x));
  EXPECT_FALSE(sparse.solve(&x));
  sparse.block(3, 3)[0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(sparse.solve(&x));
}

TEST(BlockSystem, Empty) {
  BlockSystem dense(0), sparse{BlockPattern(0)};
  std::vector<Vector6d> x;
  EXPECT_TRUE(dense.solve(&x));
  EXPECT_TRUE(sparse.solve(&x));
  EXPECT_TRUE(x.empty());
}

}  // namespace
}  // namespace camloc
