// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/geometry/symmetric_system.h"

#include <gtest/gtest.h>

#include <random>

namespace camloc {
namespace {

template <int N>
Eigen::Matrix<double, N, N> random_information(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  Eigen::Matrix<double, N, N> root;
  for (double& value : root.reshaped()) value = normal(random);
  return root * root.transpose();
}

template <int N>
void expect_solved() {
  for (std::uint64_t seed = 1; seed < 20; ++seed) {
    const Eigen::Matrix<double, N, N> A = random_information<N>(seed);
    const Eigen::Matrix<double, N, 1> x = random_information<N>(seed + 100).col(0);
    EXPECT_LT((A * solve_symmetric<N>(A, A * x) - A * x).norm(), 1e-9 * (A * x).norm()) << N << " unknowns, seed " << seed;
  }
}

TEST(SymmetricSystem, SolvesEverySizeItIsMadeFor) {
  expect_solved<2>();
  expect_solved<3>();
  expect_solved<4>();
  expect_solved<6>();
  expect_solved<7>();
  expect_solved<8>();
}

TEST(SymmetricSystem, WhatSomethingHoldsIsSolvedBesideWhatNothingHolds) {
  const Eigen::Vector3d b(1, 2, 3);
  const Eigen::Vector3d x = solve_symmetric<3>(Eigen::Vector3d(1, 4, 0).asDiagonal(), b);
  EXPECT_EQ(x.head<2>(), Eigen::Vector2d(1, 0.5));
}

TEST(SymmetricSystem, MahalanobisCountsInSigmas) {
  Eigen::Matrix<double, 6, 1> error, sigma;
  error << 1, 2, 3, 4, 5, 6;
  sigma << 1, 2, 1, 2, 1, 2;
  const Eigen::Matrix<double, 6, 6> covariance = sigma.cwiseAbs2().asDiagonal();
  EXPECT_DOUBLE_EQ(squared_mahalanobis(error, covariance), 1 + 1 + 9 + 4 + 25 + 9);
}

}  // namespace
}  // namespace camloc
