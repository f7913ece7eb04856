// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Bundle adjustment against Ceres on the same problems from the same start: CPU time, memory and the cost reached.
//
// Every run is a child process of its own, so that its memory is the growth of the peak of resident memory from just before
// to the end of the run, and its time the CPU time of the process. For Ceres the time is that of Solve() alone, without
// building its problem, and the memory includes its problem, as ours includes all but the BundleProblem.
#include <benchmark/benchmark.h>
#include <malloc.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <string>

#include "core/optimize/bundle_adjustment.h"
#include "tests/optimize/generated_bundle.h"
#ifdef CAMLOC_HAS_CERES
#include "tests/optimize/ceres_bundle.h"
#endif

namespace camloc {
namespace {

enum Problem : std::int64_t { kLocal, k100, k300, kCorridor };
constexpr int kRepetitions = 3;

struct Run {
  double cpu_s = 0, memory_MB = 0, cost = 0, camera_error_m = 0;
  int num_iterations = 0;
};

testing::BundleWorld make_world(std::int64_t problem) {
  testing::BundleWorldOptions o;
  if (problem == kLocal) o = {.num_cameras = 23, .num_landmarks = 1500, .num_fixed = 15};
  if (problem == k100) o = {.num_cameras = 100, .num_landmarks = 10000, .seen_ratio = 0.26};
  if (problem == k300) o = {.num_cameras = 300, .num_landmarks = 30000, .seen_ratio = 0.26};
  if (problem == kCorridor) o = {.num_cameras = 1500, .num_landmarks = 150000, .seen_ratio = 0.25, .corridor_m = 194};
  std::mt19937 rng(1);
  testing::BundleWorld world = testing::make_bundle_world(rng, o);
  world.options.min_relative_decrease = 1e-6;
  return world;
}

const testing::BundleWorld& world_of(std::int64_t problem) {
  static std::int64_t cached_problem = -1;
  static testing::BundleWorld world;
  if (cached_problem != problem) world = make_world(problem);
  cached_problem = problem;
  return world;
}

double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// A line of /proc/self/status in MB: VmRSS now, VmHWM at its peak.
double status_MB(const std::string& key) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.rfind(key, 0) == 0) return std::atof(line.c_str() + key.size() + 1) / 1024.0;
  }
  return 0;
}

Run run_ours(const testing::BundleWorld& world) {
  BundleProblem problem = world.start;
  const double memory_before = status_MB("VmRSS"), start = cpu_seconds();
  const BundleReport report = adjust_bundle(world.options, &problem);
  const double cpu_s = cpu_seconds() - start;
  return {cpu_s, status_MB("VmHWM") - memory_before, report.final_cost, testing::camera_error_m(problem, world.truth),
          report.num_iterations};
}

#ifdef CAMLOC_HAS_CERES
template <ceres::LinearSolverType kSolver>
Run run_ceres(const testing::BundleWorld& world) {
  const double memory_before = status_MB("VmRSS");
  testing::CeresBundle bundle(world.options, world.start);
  const double start = cpu_seconds();
  const ceres::Solver::Summary summary = bundle.solve(world.options, kSolver);
  const double cpu_s = cpu_seconds() - start;
  BundleProblem problem = world.truth;
  problem.T_map_camera = bundle.poses();
  return {cpu_s, status_MB("VmHWM") - memory_before, 2 * summary.final_cost, testing::camera_error_m(problem, world.truth),
          summary.num_successful_steps + summary.num_unsuccessful_steps - 1};
}
#endif

/// Runs in a child process and brings the figures home through a pipe.
template <class Function>
bool in_child(const Function& function, const testing::BundleWorld& world, Run* run) {
  int ends[2];
  if (pipe(ends) != 0) return false;
  malloc_trim(0);
  const pid_t child = fork();
  if (child == 0) {
    const Run result = function(world);
    _exit(write(ends[1], &result, sizeof(result)) == sizeof(result) ? 0 : 1);
  }
  close(ends[1]);
  const bool is_read = child > 0 && read(ends[0], run, sizeof(*run)) == sizeof(*run);
  close(ends[0]);
  int status = 0;
  return child > 0 && waitpid(child, &status, 0) == child && is_read && status == 0;
}

template <class Function>
void measure(benchmark::State& state, const Function& function) {
  const testing::BundleWorld& world = world_of(state.range(0));
  Run run;
  for (auto _ : state) {
    if (!in_child(function, world, &run)) return state.SkipWithError("the run failed");
    state.SetIterationTime(run.cpu_s);
  }
  state.counters["cameras"] = static_cast<double>(world.start.T_map_camera.size());
  state.counters["observations"] = static_cast<double>(world.start.observations.size());
  state.counters["memory_MB"] = run.memory_MB;
  state.counters["cost"] = run.cost;
  state.counters["steps"] = run.num_iterations;
  state.counters["error_mm"] = 1000 * run.camera_error_m;
}

void ours(benchmark::State& state) { measure(state, run_ours); }
BENCHMARK(ours)->DenseRange(kLocal, kCorridor)->Iterations(kRepetitions)->UseManualTime()->Unit(benchmark::kMillisecond);

#ifdef CAMLOC_HAS_CERES
void ceres_dense_schur(benchmark::State& state) { measure(state, run_ceres<ceres::DENSE_SCHUR>); }
BENCHMARK(ceres_dense_schur)->DenseRange(kLocal, k300)->Iterations(1)->UseManualTime()->Unit(benchmark::kMillisecond);

void ceres_sparse_schur(benchmark::State& state) { measure(state, run_ceres<ceres::SPARSE_SCHUR>); }
BENCHMARK(ceres_sparse_schur)->Arg(kCorridor)->Iterations(1)->UseManualTime()->Unit(benchmark::kMillisecond);
#endif

}  // namespace
}  // namespace camloc
