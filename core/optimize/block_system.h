// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A symmetric positive definite linear system of 6x6 blocks, one block row a pose: what remains of a bundle adjustment once
// the landmarks are eliminated, and what a pose graph is. Blocks are accumulated in any order and then solved for, dense or
// sparse; where the blocks are is decided once.
#pragma once

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
  [[nodiscard]] std::size_t words_per_column() const { return words_per_column_; }
  [[nodiscard]] const std::vector<std::uint64_t>& words() const { return words_; }

 private:
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
  [[nodiscard]] const Vector6d& gradient(std::uint32_t row) const { return gradient_[row]; }

  /// False where H is not positive definite; `x` has then no meaning.
  [[nodiscard]] bool solve(std::vector<Vector6d>* x);

 private:
  [[nodiscard]] std::size_t index_of(std::uint32_t row, std::uint32_t column) const;
  bool solve_dense(Eigen::VectorXd* x);
  bool solve_sparse(Eigen::VectorXd* x);
  [[nodiscard]] std::vector<std::pair<std::uint32_t, std::uint32_t>> block_positions() const;

  std::uint32_t num_blocks_;
  bool is_sparse_;
  std::vector<double> blocks_;  ///< column by column, rows ascending
  std::vector<Vector6d> gradient_;
  // Sparse: bits of the pattern with the number of blocks before each word, so that a look-up is a count of bits.
  std::size_t words_per_column_ = 0;
  std::vector<std::uint64_t> words_;
  std::vector<std::uint32_t> blocks_before_word_;

  Eigen::MatrixXd dense_;
  std::optional<BlockCholesky> cholesky_;
};

}  // namespace camloc
