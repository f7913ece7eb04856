// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/optimize/block_system.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <bit>
#include <cassert>

namespace camloc {

BlockPattern::BlockPattern(std::uint32_t num_blocks)
    : num_blocks_(num_blocks), words_per_column_((num_blocks + 63) / 64), words_(words_per_column_ * num_blocks, 0) {
  for (std::uint32_t i = 0; i < num_blocks; ++i) add(i, i);
}

void BlockPattern::add(std::uint32_t a, std::uint32_t b) {
  const std::uint32_t row = std::min(a, b), column = std::max(a, b);
  words_[column * words_per_column_ + row / 64] |= std::uint64_t{1} << (row % 64);
}

BlockSystem::BlockSystem(std::uint32_t num_blocks)
    : num_blocks_(num_blocks),
      is_sparse_(false),
      blocks_(kBlockDoubles * num_blocks * (std::size_t{num_blocks} + 1) / 2),
      gradient_(num_blocks),
      diagonal_(num_blocks),
      pattern_(0) {
  set_zero();
}

BlockSystem::BlockSystem(const BlockPattern& pattern)
    : num_blocks_(pattern.num_blocks()), is_sparse_(true), gradient_(num_blocks_), diagonal_(num_blocks_), pattern_(pattern) {
  std::uint32_t count = 0;
  for (const std::uint64_t word : pattern_.words_) {
    blocks_before_word_.push_back(count);
    count += static_cast<std::uint32_t>(std::popcount(word));
  }
  blocks_.resize(kBlockDoubles * count);
  set_zero();
}

void BlockSystem::set_zero() {
  std::fill(blocks_.begin(), blocks_.end(), 0.0);
  std::fill(gradient_.begin(), gradient_.end(), Vector6d::Zero());
  std::fill(diagonal_.begin(), diagonal_.end(), Vector6d::Zero());
}

std::size_t BlockSystem::index_of(std::uint32_t row, std::uint32_t column) const {
  assert(row <= column && column < num_blocks_);
  if (!is_sparse_) return std::size_t{column} * (std::size_t{column} + 1) / 2 + row;
  assert(pattern_.has(row, column));
  const std::size_t word = column * pattern_.words_per_column_ + row / 64;
  const std::uint64_t before = (std::uint64_t{1} << (row % 64)) - 1;
  return blocks_before_word_[word] + static_cast<std::size_t>(std::popcount(pattern_.words_[word] & before));
}

bool BlockSystem::solve(std::vector<Vector6d>* x) {
  x->resize(num_blocks_);
  if (num_blocks_ == 0) return true;
  Eigen::Map<Eigen::VectorXd> out((*x)[0].data(), kSize * static_cast<Eigen::Index>(num_blocks_));
  Eigen::VectorXd solution = -Eigen::Map<const Eigen::VectorXd>(gradient_[0].data(), out.size());
  const bool is_solved = is_sparse_ ? solve_sparse(&solution) : solve_dense(&solution);
  out = solution;
  return is_solved && solution.allFinite();
}

bool BlockSystem::solve_dense(Eigen::VectorXd* x) {
  dense_.resize(x->size(), x->size());
  const double* block = blocks_.data();
  for (Eigen::Index column = 0; column < num_blocks_; ++column) {
    for (Eigen::Index row = 0; row <= column; ++row, block += kBlockDoubles) {
      dense_.block<kSize, kSize>(kSize * column, kSize * row) =
          Eigen::Map<const Matrix6d>(block).transpose();  // Eigen factorizes the lower triangle faster
    }
  }
  // Only this triangle is read, so what else is in a diagonal block does not matter.
  const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>, Eigen::Lower> factor(dense_);
  if (factor.info() != Eigen::Success) return false;
  factor.solveInPlace(*x);
  return true;
}

bool BlockSystem::solve_sparse(Eigen::VectorXd* x) {
  if (!cholesky_) {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> positions;
    for (std::uint32_t column = 0; column < num_blocks_; ++column) {
      for (std::uint32_t row = 0; row <= column; ++row) {
        if (pattern_.has(row, column)) positions.emplace_back(row, column);
      }
    }
    cholesky_.emplace(num_blocks_, positions);
  }
  if (!cholesky_->factorize(blocks_.data())) return false;
  cholesky_->solve(x);
  return true;
}

}  // namespace camloc
