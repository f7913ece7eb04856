// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A symmetric positive definite linear system of 6x6 blocks, one block row a pose: what remains of a bundle adjustment once
// the landmarks are eliminated, and what a pose graph is. Blocks are accumulated in any order and then solved for, dense or
// sparse; where the blocks are is decided once.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/geometry/rigid3.h"
#include "core/optimize/block_cholesky.h"

namespace camloc {

/// Which blocks (row, column) of the upper triangle are there, as a set of bits; the diagonal always is.
class BlockPattern {
 public:
  explicit BlockPattern(std::uint32_t num_blocks);
  void add(std::uint32_t a, std::uint32_t b);  ///< in either order
  [[nodiscard]] bool has(std::uint32_t row, std::uint32_t column) const {
    return (words_[column * words_per_column_ + row / 64] >> (row % 64) & 1U) != 0;
  }
  [[nodiscard]] std::uint32_t num_blocks() const { return num_blocks_; }

 private:
  friend class BlockSystem;
  std::uint32_t num_blocks_;
  std::size_t words_per_column_;
  std::vector<std::uint64_t> words_;
};

/// H x = -g. Not thread-safe; allocates at construction and in the first solve().
class BlockSystem {
 public:
  static constexpr int kSize = 6;
  static constexpr std::size_t kBlockDoubles = kSize * kSize;

  explicit BlockSystem(std::uint32_t num_blocks);     ///< dense: every block is there
  explicit BlockSystem(const BlockPattern& pattern);  ///< sparse

  [[nodiscard]] std::uint32_t num_blocks() const { return num_blocks_; }
  [[nodiscard]] bool is_sparse() const { return is_sparse_; }
  void set_zero();

  /// Block of the upper triangle, row <= column, column-major; it must be in the pattern. Of a diagonal block the upper
  /// triangle counts.
  [[nodiscard]] double* block(std::uint32_t row, std::uint32_t column) { return blocks_.data() + kBlockDoubles * index_of(row, column); }
  [[nodiscard]] Vector6d& gradient(std::uint32_t row) { return gradient_[row]; }
  /// Of the terms' own blocks, before an elimination: what Marquardt's damping needs. It is no part of H.
  [[nodiscard]] Vector6d& diagonal(std::uint32_t row) { return diagonal_[row]; }

  /// False where H is not positive definite; `x` has then no meaning.
  [[nodiscard]] bool solve(std::vector<Vector6d>* x);

 private:
  [[nodiscard]] std::size_t index_of(std::uint32_t row, std::uint32_t column) const;
  bool solve_dense(Eigen::VectorXd* x);
  bool solve_sparse(Eigen::VectorXd* x);

  std::uint32_t num_blocks_;
  bool is_sparse_;
  std::vector<double> blocks_;  ///< column by column, rows ascending
  std::vector<Vector6d> gradient_, diagonal_;
  // Sparse: the pattern with the number of blocks before each word, so that a look-up is a count of bits.
  BlockPattern pattern_;
  std::vector<std::uint32_t> blocks_before_word_;

  Eigen::MatrixXd dense_;
  std::optional<BlockCholesky> cholesky_;
};

/// In place of a row, for a pose that is held.
inline constexpr std::uint32_t kFixedPose = 0xffffffff;

/// The row of each pose: those that are not fixed, numbered in their order.
[[nodiscard]] inline std::vector<std::uint32_t> rows_of_poses(const std::vector<std::uint8_t>& is_fixed) {
  std::vector<std::uint32_t> rows;
  std::uint32_t num_free = 0;
  for (const std::uint8_t fixed : is_fixed) rows.push_back(fixed != 0 ? kFixedPose : num_free++);
  return rows;
}

[[nodiscard]] inline std::uint32_t num_free_poses(const std::vector<std::uint32_t>& rows) {
  return static_cast<std::uint32_t>(std::count_if(rows.begin(), rows.end(), [](std::uint32_t row) { return row != kFixedPose; }));
}

}  // namespace camloc
