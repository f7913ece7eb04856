// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Geometry solvers against OpenCV's: minimal solver, robust loop, refinement, depth.
#include <benchmark/benchmark.h>

#include <opencv2/calib3d.hpp>

#include "core/geometry/depth_registration.h"
#include "core/geometry/p3p.h"
#include "core/geometry/pnp_ransac.h"
#include "core/geometry/pose_refinement.h"
#include "tests/geometry/generated.h"
#include "tests/geometry/registered_depth.h"

namespace camloc {
namespace {

using testing::Scene;
using testing::SceneOptions;

constexpr int kScenes = 16;

Scene scene_for(const benchmark::State& state, int seed) {
  std::mt19937 rng(static_cast<unsigned>(seed));
  SceneOptions options;
  options.num_pairs = static_cast<int>(state.range(0));
  options.outlier_ratio = 1.0 - 0.01 * static_cast<double>(state.range(1));
  return testing::make_scene(rng, options);
}

struct Triple {
  std::array<Eigen::Vector3d, 3> bearings, points;
  std::vector<cv::Point3d> cv_points;
  std::vector<cv::Point2d> cv_pixels;
};

std::vector<Triple> make_triples() {
  std::mt19937 rng(1);
  std::vector<Triple> triples(1000);
  SceneOptions options;
  options.num_pairs = 3;
  for (Triple& triple : triples) {
    const Scene scene = testing::make_scene(rng, options);
    for (std::size_t k = 0; k < 3; ++k) {
      const Correspondences& p = scene.pairs;
      triple.bearings[k] = Eigen::Vector3d(p.x[k], p.y[k], 1).normalized();
      triple.points[k] = Eigen::Vector3d(p.X[k], p.Y[k], p.Z[k]);
      triple.cv_points.emplace_back(p.X[k], p.Y[k], p.Z[k]);
      triple.cv_pixels.emplace_back(p.x[k], p.y[k]);
    }
  }
  return triples;
}

void p3p(benchmark::State& state) {
  const std::vector<Triple> triples = make_triples();
  std::size_t i = 0;
  for (auto _ : state) {
    const Triple& triple = triples[i++ % triples.size()];
    benchmark::DoNotOptimize(solve_p3p(triple.bearings, triple.points));
  }
}
BENCHMARK(p3p);

void opencv_p3p(benchmark::State& state) {
  const std::vector<Triple> triples = make_triples();
  const cv::Mat K = cv::Mat::eye(3, 3, CV_64F);
  std::vector<cv::Mat> rotations, translations;
  std::size_t i = 0;
  for (auto _ : state) {
    const Triple& triple = triples[i++ % triples.size()];
    benchmark::DoNotOptimize(cv::solveP3P(triple.cv_points, triple.cv_pixels, K, cv::noArray(), rotations, translations, cv::SOLVEPNP_P3P));
  }
}
BENCHMARK(opencv_p3p);

void pairs_and_inlier_percent(benchmark::internal::Benchmark* bench) {
  for (const int pairs : {200, 1000}) {
    for (const int percent : {50, 20}) bench->Args({pairs, percent});
  }
  bench->Unit(benchmark::kMicrosecond);
}

void run_pnp_ransac(benchmark::State& state, double max_relative_depth_error) {
  std::vector<Scene> scenes;
  for (int i = 0; i < kScenes; ++i) scenes.push_back(scene_for(state, i));
  PnpRansacOptions options;
  options.max_relative_depth_error = max_relative_depth_error;
  PnpRansac ransac(options);
  std::size_t i = 0, num_near = 0;
  for (auto _ : state) {
    const Scene& scene = scenes[i++ % kScenes];
    const PnpRansacResult result = ransac.estimate(scene.pairs, 525, i);
    num_near += pose_error(scene.T_map_camera, result.T_map_camera).head<3>().norm() < 0.05 ? 1 : 0;
  }
  state.counters["within_5cm"] = static_cast<double>(num_near) / static_cast<double>(i);
}

void pnp_ransac(benchmark::State& state) { run_pnp_ransac(state, 0.15); }
BENCHMARK(pnp_ransac)->Apply(pairs_and_inlier_percent);

void pnp_ransac_without_depth(benchmark::State& state) { run_pnp_ransac(state, 0.0); }
BENCHMARK(pnp_ransac_without_depth)->Apply(pairs_and_inlier_percent);

void opencv_pnp_ransac(benchmark::State& state) {
  struct Input {
    std::vector<cv::Point3f> points;
    std::vector<cv::Point2f> pixels;
    Rigid3 T_map_camera;
  };
  std::vector<Input> inputs(kScenes);
  for (int s = 0; s < kScenes; ++s) {
    const Scene scene = scene_for(state, s);
    Input& input = inputs[static_cast<std::size_t>(s)];
    input.T_map_camera = scene.T_map_camera;
    for (std::size_t k = 0; k < scene.pairs.size(); ++k) {
      input.points.emplace_back(scene.pairs.X[k], scene.pairs.Y[k], scene.pairs.Z[k]);
      input.pixels.emplace_back(scene.pairs.x[k] * 525, scene.pairs.y[k] * 525);
    }
  }
  const cv::Matx33d K(525, 0, 0, 0, 525, 0, 0, 0, 1);
  std::size_t i = 0, num_near = 0;
  for (auto _ : state) {
    const Input& input = inputs[i++ % kScenes];
    cv::Vec3d r, t;
    // OpenCV stops early once it is 99 % sure; ours always runs its 600 iterations.
    const bool is_found =
        cv::solvePnPRansac(input.points, input.pixels, K, cv::noArray(), r, t, false, 600, 5.0F, 0.99, cv::noArray(), cv::SOLVEPNP_P3P);
    const Rigid3 T_map_camera = Rigid3{exp_so3({r[0], r[1], r[2]}), {t[0], t[1], t[2]}}.inverse();
    num_near += is_found && pose_error(input.T_map_camera, T_map_camera).head<3>().norm() < 0.05 ? 1 : 0;
  }
  state.counters["within_5cm"] = static_cast<double>(num_near) / static_cast<double>(i);
}
BENCHMARK(opencv_pnp_ransac)->Apply(pairs_and_inlier_percent);

void refinement(benchmark::State& state) {
  std::mt19937 rng(3);
  const Scene scene = scene_for(state, 1);
  const Rigid3 start = testing::disturbed(rng, scene.T_map_camera, 0.01, 0.003);
  PoseRefinementOptions options;
  options.estimate_focal_scale = state.range(2) != 0;
  std::vector<std::uint8_t> mask(scene.pairs.capacity());
  for (auto _ : state) benchmark::DoNotOptimize(refine_pose(scene.pairs, start, 525, options, &mask));
}
BENCHMARK(refinement)->Args({200, 50, 0})->Args({200, 50, 1})->Args({1000, 50, 0})->Unit(benchmark::kMicrosecond);

void opencv_refinement(benchmark::State& state) {
  const Scene scene = scene_for(state, 1);
  std::vector<cv::Point3f> points;
  std::vector<cv::Point2f> pixels;
  for (std::size_t k = 0; k < scene.pairs.size(); ++k) {
    points.emplace_back(scene.pairs.X[k], scene.pairs.Y[k], scene.pairs.Z[k]);
    pixels.emplace_back(scene.pairs.x[k], scene.pairs.y[k]);
  }
  for (auto _ : state) {
    cv::Vec3d r, t;
    benchmark::DoNotOptimize(cv::solvePnP(points, pixels, cv::Mat::eye(3, 3, CV_64F), cv::noArray(), r, t));
  }
}
BENCHMARK(opencv_refinement)->Args({200, 100})->Args({1000, 100})->Unit(benchmark::kMicrosecond);

RgbdCamera unregistered_camera() {
  RgbdCamera camera;
  camera.color = {640, 480, 525, 525, 320, 240, LensModel::kPinhole, {}};
  camera.depth = {640, 480, 585, 585, 320, 240, LensModel::kPinhole, {}};
  camera.T_color_depth.translation << -0.025, 0, 0;
  camera.is_depth_registered = false;
  return camera;
}

Image<std::uint16_t> slanted_depth() {
  Image<std::uint16_t> depth;
  depth.resize(640, 480);
  for (int v = 0; v < 480; ++v) {
    for (int u = 0; u < 640; ++u) depth.at(u, v) = static_cast<std::uint16_t>(1500 + 2 * u + v);
  }
  return depth;
}

void depth_lookup_1000(benchmark::State& state) {
  const Image<std::uint16_t> depth = slanted_depth();
  const DepthLookup lookup(unregistered_camera());
  for (auto _ : state) {
    float sum = 0;
    for (int i = 0; i < 1000; ++i) sum += lookup.depth_at(depth.view(), static_cast<float>(i * 37 % 640), static_cast<float>(i * 91 % 480));
    benchmark::DoNotOptimize(sum);
  }
}
BENCHMARK(depth_lookup_1000)->Unit(benchmark::kMicrosecond);

void register_whole_depth(benchmark::State& state) {
  const Image<std::uint16_t> depth = slanted_depth();
  const RgbdCamera camera = unregistered_camera();
  Image<float> registered;
  for (auto _ : state) testing::register_depth(camera, depth.view(), &registered);
}
BENCHMARK(register_whole_depth)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace camloc
