// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// P3P on random problems with known pose, on degenerate ones, and against cv::solveP3P.
#include "core/geometry/p3p.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <opencv2/calib3d.hpp>

#include "tests/geometry/generated.h"

namespace camloc {
namespace {

struct Problem {
  std::array<Eigen::Vector3d, 3> bearings, points;
  Rigid3 T_camera_map;
};

Problem random_problem(std::mt19937& rng) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  Problem problem;
  problem.T_camera_map = testing::random_pose(rng, 3);
  for (std::size_t i = 0; i < 3; ++i) {
    const double z = 4.5 + 4 * uniform(rng), x = 0.7 * z * uniform(rng), y = 0.5 * z * uniform(rng);
    const Eigen::Vector3d p_camera(x, y, z);
    problem.bearings[i] = p_camera.normalized();
    problem.points[i] = problem.T_camera_map.inverse() * p_camera;
  }
  return problem;
}

double error_to(const Problem& problem, const P3pSolutions& solutions) {
  double nearest = 1e9;
  for (std::size_t k = 0; k < static_cast<std::size_t>(solutions.count); ++k) {
    nearest = std::min(nearest, (solutions.R_camera_map[k] - problem.T_camera_map.rotation.toRotationMatrix()).norm() +
                                    (solutions.t_camera_map[k] - problem.T_camera_map.translation).norm());
  }
  return nearest;
}

TEST(P3p, TruthIsAmongTheSolutions) {
  std::mt19937 rng(1);
  constexpr int kProblems = 100000;
  int num_found = 0;
  std::vector<double> errors;
  for (int i = 0; i < kProblems; ++i) {
    const Problem problem = random_problem(rng);
    const P3pSolutions solutions = solve_p3p(problem.bearings, problem.points);
    ASSERT_GE(solutions.count, 0);
    ASSERT_LE(solutions.count, 4);
    for (std::size_t k = 0; k < static_cast<std::size_t>(solutions.count); ++k) {
      const Eigen::Matrix3d& R = solutions.R_camera_map[k];
      ASSERT_LT((R * R.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-12);
      ASSERT_GT(R.determinant(), 0.0);
      for (std::size_t j = 0; j < 3; ++j) {
        const Eigen::Vector3d p = R * problem.points[j] + solutions.t_camera_map[k];
        ASSERT_GT(p.dot(problem.bearings[j]), 0.0);
        ASSERT_LT((p.normalized() - problem.bearings[j]).norm(), 1e-6);
      }
    }
    const double error = error_to(problem, solutions);
    errors.push_back(error);
    num_found += error < 1e-5 ? 1 : 0;
  }
  std::nth_element(errors.begin(), errors.begin() + kProblems / 2, errors.end());
  EXPECT_GE(num_found, kProblems * 999 / 1000);
  EXPECT_LT(errors[kProblems / 2], 1e-12);
}

TEST(P3p, SurvivesNoiseAsWellAsOpenCv) {
  // Bearings that are a pixel off may leave a problem without a real root; no solver then finds a pose. Ours must find
  // one near the truth at least as often as cv::solveP3P does, and never more than four.
  std::mt19937 rng(2);
  constexpr int kProblems = 3000;
  const cv::Mat K = cv::Mat::eye(3, 3, CV_64F);
  int ours = 0, theirs = 0;
  for (int i = 0; i < kProblems; ++i) {
    Problem problem = random_problem(rng);
    std::vector<cv::Point3d> points;
    std::vector<cv::Point2d> pixels;
    for (std::size_t k = 0; k < 3; ++k) {
      problem.bearings[k] = (problem.bearings[k] + testing::random_vector(rng, 1.0 / 525)).normalized();
      points.emplace_back(problem.points[k].x(), problem.points[k].y(), problem.points[k].z());
      pixels.emplace_back(problem.bearings[k].x() / problem.bearings[k].z(), problem.bearings[k].y() / problem.bearings[k].z());
    }
    const auto is_near = [&](const Rigid3& T_camera_map) {
      return rotation_distance_rad(T_camera_map.rotation, problem.T_camera_map.rotation) < 0.1;
    };
    const P3pSolutions solutions = solve_p3p(problem.bearings, problem.points);
    bool is_found = false;
    for (std::size_t k = 0; k < static_cast<std::size_t>(solutions.count); ++k) {
      is_found |= is_near({Eigen::Quaterniond(solutions.R_camera_map[k]), solutions.t_camera_map[k]});
    }
    ours += is_found ? 1 : 0;
    std::vector<cv::Mat> rotations, translations;
    cv::solveP3P(points, pixels, K, cv::noArray(), rotations, translations, cv::SOLVEPNP_P3P);
    is_found = false;
    for (const cv::Mat& r : rotations) is_found |= is_near({exp_so3({r.at<double>(0), r.at<double>(1), r.at<double>(2)}), {}});
    theirs += is_found ? 1 : 0;
  }
  EXPECT_GE(ours, theirs);
  EXPECT_GE(ours, kProblems * 9 / 10);
}

TEST(P3p, FindsAllSolutionsThatOpenCvFinds) {
  std::mt19937 rng(3);
  const cv::Mat K = cv::Mat::eye(3, 3, CV_64F);
  int num_theirs = 0, num_missed = 0;
  for (int i = 0; i < 3000; ++i) {
    const Problem problem = random_problem(rng);
    std::vector<cv::Point3d> points;
    std::vector<cv::Point2d> pixels;
    for (std::size_t k = 0; k < 3; ++k) {
      points.emplace_back(problem.points[k].x(), problem.points[k].y(), problem.points[k].z());
      pixels.emplace_back(problem.bearings[k].x() / problem.bearings[k].z(), problem.bearings[k].y() / problem.bearings[k].z());
    }
    std::vector<cv::Mat> rotations, translations;
    cv::solveP3P(points, pixels, K, cv::noArray(), rotations, translations, cv::SOLVEPNP_AP3P);
    const P3pSolutions solutions = solve_p3p(problem.bearings, problem.points);
    for (std::size_t k = 0; k < rotations.size(); ++k) {
      const cv::Mat &r = rotations[k], &t = translations[k];
      const Problem theirs{
          problem.bearings,
          problem.points,
          {exp_so3({r.at<double>(0), r.at<double>(1), r.at<double>(2)}), {t.at<double>(0), t.at<double>(1), t.at<double>(2)}}};
      bool is_valid = true;  // theirs includes inexact ones and points behind the camera
      for (std::size_t j = 0; j < 3; ++j) {
        is_valid &= ((theirs.T_camera_map * problem.points[j]).normalized() - problem.bearings[j]).norm() < 1e-7;
      }
      if (!is_valid) continue;
      ++num_theirs;
      num_missed += error_to(theirs, solutions) > 1e-3 ? 1 : 0;
    }
  }
  EXPECT_GT(num_theirs, 3000);
  EXPECT_LE(num_missed, num_theirs / 1000);
}

TEST(P3p, DegenerateTriplesGiveNoSolution) {
  const std::array<Eigen::Vector3d, 3> bearings{Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(0.6, 0, 0.8), Eigen::Vector3d(0, 0.6, 0.8)};
  const Eigen::Vector3d a(1, 2, 3), b(2, 3, 5);
  EXPECT_EQ(solve_p3p(bearings, {a, a, a}).count, 0);
  EXPECT_EQ(solve_p3p(bearings, {a, a, b}).count, 0);
  EXPECT_EQ(solve_p3p(bearings, {a, b, a}).count, 0);
  EXPECT_EQ(solve_p3p(bearings, {a, b, 0.5 * (a + b)}).count, 0);
  EXPECT_EQ(solve_p3p(bearings, {a, b, Eigen::Vector3d::Constant(std::nan(""))}).count, 0);
}

TEST(P3p, SolvesSymmetricAndScaledTriples) {
  // An equilateral triangle seen from above its centre: roots of multiplicity, and 1000 times smaller and larger.
  for (const double scale : {1e-3, 1.0, 1e3}) {
    const double h = std::sqrt(3.0) / 2;
    const std::array<Eigen::Vector3d, 3> points{scale * Eigen::Vector3d(1, 0, 0), scale * Eigen::Vector3d(-0.5, h, 0),
                                                scale * Eigen::Vector3d(-0.5, -h, 0)};
    std::array<Eigen::Vector3d, 3> bearings;
    for (std::size_t i = 0; i < 3; ++i) bearings[i] = (points[i] + scale * Eigen::Vector3d(0, 0, 3)).normalized();
    const P3pSolutions solutions = solve_p3p(bearings, points);
    double nearest = 1e9;
    for (std::size_t k = 0; k < static_cast<std::size_t>(solutions.count); ++k) {
      nearest = std::min(nearest, (solutions.t_camera_map[k] / scale - Eigen::Vector3d(0, 0, 3)).norm());
    }
    EXPECT_LT(nearest, 1e-6) << scale;
  }
}

}  // namespace
}  // namespace camloc
