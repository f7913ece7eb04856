// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/optimize/block_cholesky.h"

#include <Eigen/Cholesky>
#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cstring>

namespace camloc {
namespace {

constexpr std::uint32_t kNone = 0xffffffff;
using Doubles = double __attribute__((vector_size(16)));

/// C -= A B', all 6x6 and column-major: where a large factorization spends its time.
inline void subtract_product(const double* A, const double* B, double* C) {
  for (int column = 0; column < 6; ++column) {
    Doubles c[3];
    std::memcpy(c, C + 6 * column, sizeof(c));
    for (int k = 0; k < 6; ++k) {
      Doubles a[3];
      std::memcpy(a, A + 6 * k, sizeof(a));
      const double b = B[6 * k + column];
      for (int i = 0; i < 3; ++i) c[i] -= a[i] * b;
    }
    std::memcpy(C + 6 * column, c, sizeof(c));
  }
}

}  // namespace

BlockCholesky::BlockCholesky(std::uint32_t num_blocks, const std::vector<std::pair<std::uint32_t, std::uint32_t>>& upper)
    : num_blocks_(num_blocks) {
  order(upper);
  find_structure(upper);
  values_.resize(36 * rows_.size());
}

void BlockCholesky::order(const std::vector<std::pair<std::uint32_t, std::uint32_t>>& upper) {
  std::vector<Eigen::Triplet<float>> triplets;
  for (const auto& [row, column] : upper) {
    triplets.emplace_back(static_cast<int>(row), static_cast<int>(column), 1.0F);
    if (row != column) triplets.emplace_back(static_cast<int>(column), static_cast<int>(row), 1.0F);
  }
  const auto size = static_cast<Eigen::Index>(num_blocks_);
  Eigen::SparseMatrix<float> graph(size, size);
  graph.setFromTriplets(triplets.begin(), triplets.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> permutation;
  Eigen::AMDOrdering<int>()(graph, permutation);
  position_.resize(num_blocks_);
  for (std::uint32_t i = 0; i < num_blocks_; ++i) {
    position_[static_cast<std::uint32_t>(permutation.indices()[static_cast<Eigen::Index>(i)])] = i;
  }
}

/// Rows of each column of the factor: those of the matrix and of the columns whose first row below the diagonal this is.
void BlockCholesky::find_structure(const std::vector<std::pair<std::uint32_t, std::uint32_t>>& upper) {
  std::vector<std::vector<std::uint32_t>> below(num_blocks_), children(num_blocks_);
  for (const auto& [row, column] : upper) {
    const auto [low, high] = std::minmax(position_[row], position_[column]);
    if (low != high) below[low].push_back(high);
  }
  std::vector<std::uint32_t> last_column(num_blocks_, kNone);
  for (std::uint32_t column = 0; column < num_blocks_; ++column) {
    column_begin_.push_back(static_cast<std::uint32_t>(rows_.size()));
    rows_.push_back(column);
    last_column[column] = column;
    const auto add = [&](std::uint32_t row) {
      if (last_column[row] == column) return;
      last_column[row] = column;
      rows_.push_back(row);
    };
    std::for_each(below[column].begin(), below[column].end(), add);
    for (const std::uint32_t child : children[column]) {
      // By index: rows_ grows while it is read.
      for (std::uint32_t entry = column_begin_[child] + 1; entry < column_begin_[child + 1]; ++entry) add(rows_[entry]);
    }
    std::sort(rows_.begin() + column_begin_[column], rows_.end());
    if (column_begin_[column] + 1 < rows_.size()) children[rows_[column_begin_[column] + 1]].push_back(column);
  }
  column_begin_.push_back(static_cast<std::uint32_t>(rows_.size()));
  for (const auto& [row, column] : upper) {
    const auto [low, high] = std::minmax(position_[row], position_[column]);
    const auto found = std::lower_bound(rows_.begin() + column_begin_[low], rows_.begin() + column_begin_[low + 1], high);
    targets_.push_back({static_cast<std::uint32_t>(found - rows_.begin()), position_[row] <= position_[column]});
  }
}

bool BlockCholesky::factorize(const double* upper_values) {
  std::fill(values_.begin(), values_.end(), 0.0);
  for (const Target& target : targets_) {
    const Eigen::Map<const Matrix6d> source(upper_values);
    Eigen::Map<Matrix6d> block(values(target.entry));
    if (target.is_transposed)
      block = source.transpose();
    else
      block = source;
    upper_values += 36;
  }
  first_column_.assign(num_blocks_, kNone);
  next_column_.assign(num_blocks_, kNone);
  next_entry_.assign(num_blocks_, 0);
  entry_of_row_.assign(num_blocks_, 0);
  for (std::uint32_t column = 0; column < num_blocks_; ++column) {
    subtract_earlier_columns(column);
    if (!finish_column(column)) return false;
  }
  return true;
}

void BlockCholesky::subtract_earlier_columns(std::uint32_t column) {
  for (std::uint32_t entry = column_begin_[column]; entry < column_begin_[column + 1]; ++entry) entry_of_row_[rows_[entry]] = entry;
  for (std::uint32_t earlier = first_column_[column]; earlier != kNone;) {
    const std::uint32_t begin = next_entry_[earlier], end = column_begin_[earlier + 1];
    for (std::uint32_t entry = begin; entry < end; ++entry) {
      subtract_product(values(entry), values(begin), values(entry_of_row_[rows_[entry]]));
    }
    const std::uint32_t following = next_column_[earlier];
    next_entry_[earlier] = begin + 1;
    if (begin + 1 < end) next_column_[earlier] = std::exchange(first_column_[rows_[begin + 1]], earlier);
    earlier = following;
  }
}

bool BlockCholesky::finish_column(std::uint32_t column) {
  const std::uint32_t begin = column_begin_[column], end = column_begin_[column + 1];
  Eigen::Map<Matrix6d> diagonal(values(begin));
  const Eigen::LLT<Matrix6d> factor(diagonal);
  if (factor.info() != Eigen::Success || !diagonal.allFinite()) return false;
  // Of the inverse of the diagonal block both the column and the solutions need only products.
  Matrix6d inverse = Matrix6d::Identity();
  factor.matrixL().solveInPlace(inverse);
  diagonal = inverse;
  for (std::uint32_t entry = begin + 1; entry < end; ++entry) {
    Eigen::Map<Matrix6d> block(values(entry));
    block = (block * inverse.transpose()).eval();
  }
  next_entry_[column] = begin + 1;
  if (begin + 1 < end) next_column_[column] = std::exchange(first_column_[rows_[begin + 1]], column);
  return true;
}

void BlockCholesky::solve(Eigen::VectorXd* x) const {
  std::vector<Vector6d> y(num_blocks_);
  for (std::uint32_t i = 0; i < num_blocks_; ++i) y[position_[i]] = x->segment<6>(6 * static_cast<Eigen::Index>(i));
  for (std::uint32_t column = 0; column < num_blocks_; ++column) {
    std::uint32_t entry = column_begin_[column];
    y[column] = (Eigen::Map<const Matrix6d>(values(entry)) * y[column]).eval();
    for (++entry; entry < column_begin_[column + 1]; ++entry) {
      y[rows_[entry]].noalias() -= Eigen::Map<const Matrix6d>(values(entry)) * y[column];
    }
  }
  for (std::uint32_t column = num_blocks_; column-- > 0;) {
    for (std::uint32_t entry = column_begin_[column] + 1; entry < column_begin_[column + 1]; ++entry) {
      y[column].noalias() -= Eigen::Map<const Matrix6d>(values(entry)).transpose() * y[rows_[entry]];
    }
    y[column] = (Eigen::Map<const Matrix6d>(values(column_begin_[column])).transpose() * y[column]).eval();
  }
  for (std::uint32_t i = 0; i < num_blocks_; ++i) x->segment<6>(6 * static_cast<Eigen::Index>(i)) = y[position_[i]];
}

}  // namespace camloc
