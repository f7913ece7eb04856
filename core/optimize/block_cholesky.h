// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Sparse Cholesky factorization of a symmetric positive definite matrix of 6x6 blocks (Davis, "Direct methods for sparse
// linear systems", 2006: elimination tree, left-looking by columns), with the minimum degree ordering of the blocks. Whole
// blocks need a thirty-sixth of the indices and keep the arithmetic in registers.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/geometry/rigid3.h"

namespace camloc {

/// Analyzed once for a pattern, then factorized as often as the values change. Not thread-safe.
class BlockCholesky {
 public:
  /// (row, column) of the blocks of the upper triangle, in the order their values will come in; the whole diagonal included.
  BlockCholesky(std::uint32_t num_blocks, const std::vector<std::pair<std::uint32_t, std::uint32_t>>& upper);

  /// 36 values a block, column-major; of diagonal blocks the upper triangle. False where not positive definite.
  [[nodiscard]] bool factorize(const double* upper_values);

  /// In place, 6 values a block row; only after a factorization that succeeded.
  void solve(Eigen::VectorXd* x) const;

 private:
  void order(const std::vector<std::pair<std::uint32_t, std::uint32_t>>& upper);
  void find_structure(const std::vector<std::pair<std::uint32_t, std::uint32_t>>& upper);
  void subtract_earlier_columns(std::uint32_t column);
  [[nodiscard]] bool finish_column(std::uint32_t column);
  [[nodiscard]] double* values(std::size_t entry) { return values_.data() + 36 * entry; }
  [[nodiscard]] const double* values(std::size_t entry) const { return values_.data() + 36 * entry; }

  /// Where a block of the input goes.
  struct Target {
    std::uint32_t entry;
    bool is_transposed;
  };

  std::uint32_t num_blocks_;
  std::vector<std::uint32_t> position_;  ///< of a block row in the order of elimination
  std::vector<Target> targets_;
  // Columns of the factor, diagonal first, then rows ascending.
  std::vector<std::uint32_t> column_begin_, rows_;
  std::vector<double> values_;
  // Scratch of the factorization: columns by the row they have next, the entry of that row, and where this column's rows are.
  std::vector<std::uint32_t> first_column_, next_column_, next_entry_, entry_of_row_;
};

}  // namespace camloc
