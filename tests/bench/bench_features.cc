// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Speed of extraction and matching beside cv::ORB and cv::BFMatcher. Images are generated; with CAMLOC_IMAGE set to a
// binary PGM file, that image is used.
#include <benchmark/benchmark.h>

#include <cstdlib>
#include <fstream>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#include <random>

#include "core/features/corner_selection.h"
#include "core/features/gaussian_blur.h"
#include "core/features/hamming_kernels.h"
#include "core/features/image_pyramid.h"
#include "core/features/matcher.h"
#include "core/features/orb_descriptor.h"
#include "core/features/orb_extractor.h"
#include "tests/features/reference_images.h"

namespace camloc {
namespace {

cv::Mat read_pgm(const char* path) {
  std::ifstream file(path, std::ios::binary);
  std::string magic;
  int width = 0, height = 0, max = 0;
  file >> magic >> width >> height >> max;
  file.get();
  if (!file || magic != "P5" || max != 255) return {};
  cv::Mat image(height, width, CV_8UC1);
  file.read(reinterpret_cast<char*>(image.data), static_cast<std::streamsize>(width) * height);
  return image;
}

const cv::Mat& bench_image() {
  static const cv::Mat image = [] {
    const char* path = std::getenv("CAMLOC_IMAGE");
    cv::Mat loaded = path != nullptr ? read_pgm(path) : cv::Mat();
    return loaded.empty() ? textured_image(640, 480, 1) : loaded;
  }();
  return image;
}

std::vector<Descriptor> random_descriptors(std::size_t count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<Descriptor> descriptors(count);
  for (Descriptor& descriptor : descriptors)
    for (auto& bits : descriptor.bits) bits = random();
  return descriptors;
}

void BM_OpenCvOrb(benchmark::State& state) {
  cv::setNumThreads(1);
  const auto orb = cv::ORB::create(static_cast<int>(state.range(0)));
  std::vector<cv::KeyPoint> keypoints;
  cv::Mat descriptors;
  for (auto _ : state) orb->detectAndCompute(bench_image(), cv::noArray(), keypoints, descriptors);
  state.counters["features"] = static_cast<double>(keypoints.size());
}
BENCHMARK(BM_OpenCvOrb)->Arg(1000)->Unit(benchmark::kMicrosecond);

void BM_Extract(benchmark::State& state) {
  OrbOptions options;
  options.num_features = static_cast<int>(state.range(0));
  OrbExtractor extractor(bench_image().cols, bench_image().rows, options);
  std::size_t num_features = 0;
  for (auto _ : state) num_features = extractor.extract(view_of(bench_image())).size();
  state.counters["features"] = static_cast<double>(num_features);
}
BENCHMARK(BM_Extract)->Arg(1000)->Arg(500)->Unit(benchmark::kMicrosecond);

void BM_StagePyramid(benchmark::State& state) {
  ImagePyramid pyramid(bench_image().cols, bench_image().rows, 8, 1.2F);
  for (auto _ : state) pyramid.build(view_of(bench_image()));
}
BENCHMARK(BM_StagePyramid)->Unit(benchmark::kMicrosecond);

void BM_StageCorners(benchmark::State& state) {
  ImagePyramid pyramid(bench_image().cols, bench_image().rows, 8, 1.2F);
  pyramid.build(view_of(bench_image()));
  CornerSelector selector(bench_image().cols, bench_image().rows, 1000);
  for (auto _ : state)
    for (int level = 0; level < pyramid.num_levels(); ++level)
      benchmark::DoNotOptimize(selector.select(pyramid.level(level), 217 * 10 / (10 + 2 * level)));
}
BENCHMARK(BM_StageCorners)->Unit(benchmark::kMicrosecond);

void BM_StageBlur(benchmark::State& state) {
  ImagePyramid pyramid(bench_image().cols, bench_image().rows, 8, 1.2F);
  pyramid.build(view_of(bench_image()));
  GaussianBlur blur(bench_image().cols);
  std::vector<PaddedImage> blurred(static_cast<std::size_t>(pyramid.num_levels()));
  for (int i = 0; i < pyramid.num_levels(); ++i)
    blurred[static_cast<std::size_t>(i)].allocate(pyramid.level(i).width, pyramid.level(i).height);
  for (auto _ : state)
    for (int i = 0; i < pyramid.num_levels(); ++i) blur.apply(pyramid.level(i), &blurred[static_cast<std::size_t>(i)]);
}
BENCHMARK(BM_StageBlur)->Unit(benchmark::kMicrosecond);

void BM_StageOrientation1000(benchmark::State& state) {
  const cv::Mat& image = bench_image();
  for (auto _ : state)
    for (int i = 0; i < 1000; ++i)
      benchmark::DoNotOptimize(orb_orientation_deg(image.ptr(20 + i * 7 % 400) + 20 + i * 13 % 500, image.cols));
}
BENCHMARK(BM_StageOrientation1000)->Unit(benchmark::kMicrosecond);

void BM_StageDescriptor1000(benchmark::State& state) {
  const cv::Mat& image = bench_image();
  for (auto _ : state)
    for (int i = 0; i < 1000; ++i)
      benchmark::DoNotOptimize(orb_descriptor(image.ptr(20 + i * 7 % 400) + 20 + i * 13 % 500, image.cols, static_cast<float>(i % 360)));
}
BENCHMARK(BM_StageDescriptor1000)->Unit(benchmark::kMicrosecond);

void BM_NearestDescriptors(benchmark::State& state) {
  const auto kernels = hamming::available_kernels();
  const auto number = static_cast<std::size_t>(state.range(0));
  if (number >= kernels.size()) {
    state.SkipWithError("not available");
    return;
  }
  const auto queries = random_descriptors(1000, 1), train = random_descriptors(static_cast<std::size_t>(state.range(1)), 2);
  std::vector<NearestDescriptor> nearest(queries.size());
  for (auto _ : state) hamming::nearest_descriptors(*kernels[number], queries, train, nearest.data());
  state.SetLabel(kernels[number]->name);
  state.counters["per_comparison"] = benchmark::Counter(1e3 * static_cast<double>(state.range(1)),
                                                        benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
BENCHMARK(BM_NearestDescriptors)->ArgsProduct({{0, 1, 2, 3}, {1000, 16000}})->Unit(benchmark::kMicrosecond);

void BM_OpenCvBruteForce(benchmark::State& state) {
  auto queries = random_descriptors(1000, 1), train = random_descriptors(static_cast<std::size_t>(state.range(0)), 2);
  const cv::Mat a(1000, 32, CV_8U, queries.data()), b(static_cast<int>(train.size()), 32, CV_8U, train.data());
  cv::BFMatcher matcher(cv::NORM_HAMMING);
  std::vector<std::vector<cv::DMatch>> matches;
  for (auto _ : state) matcher.knnMatch(a, b, matches, 2);
  state.counters["per_comparison"] = benchmark::Counter(1e3 * static_cast<double>(state.range(0)),
                                                        benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
BENCHMARK(BM_OpenCvBruteForce)->Arg(1000)->Arg(16000)->Unit(benchmark::kMicrosecond);

/// Candidates: appearances of the image's own features with a tenth of the bits flipped, among random ones.
void BM_CandidateMatcher(benchmark::State& state) {
  OrbExtractor extractor(bench_image().cols, bench_image().rows, OrbOptions{});
  const Features features = extractor.extract(view_of(bench_image()));
  const auto capacity = static_cast<std::size_t>(state.range(0));
  CandidateSet candidates(capacity);
  std::mt19937_64 random(3);
  for (std::size_t i = 0; i < capacity; ++i) {
    const std::size_t landmark = i / 2;
    Descriptor descriptor;
    for (auto& bits : descriptor.bits) bits = random();
    if (landmark < features.size()) {
      descriptor = features.descriptors[landmark];
      for (int k = 0; k < 25; ++k) descriptor.bits[random() % 4] ^= 1ULL << random() % 64;
    }
    candidates.add(descriptor, static_cast<std::int32_t>(landmark), 0);
  }
  CandidateMatcherOptions options;
  options.max_rotation_deviation_rad = 0;
  CandidateMatcher matcher(options, 1000, capacity);
  std::size_t num_matches = 0;
  for (auto _ : state) num_matches = matcher.match(features, candidates).size();
  state.counters["matches"] = static_cast<double>(num_matches);
}
BENCHMARK(BM_CandidateMatcher)->Arg(2000)->Arg(16000)->Unit(benchmark::kMicrosecond);

void BM_GuidedMatcher(benchmark::State& state) {
  OrbExtractor extractor(bench_image().cols, bench_image().rows, OrbOptions{});
  const Features features = extractor.extract(view_of(bench_image()));
  std::mt19937 random(4);
  std::vector<ProjectedLandmark> landmarks;
  std::vector<Descriptor> descriptors;
  for (std::size_t i = 0; i < 2000; ++i) {
    const std::size_t feature = i % features.size();
    const Keypoint& keypoint = features.keypoints[feature];
    const auto shift = [&] { return static_cast<float>(random() % 11) - 5; };
    landmarks.push_back({static_cast<std::int32_t>(i), keypoint.u + shift(), keypoint.v + shift(), 12,
                         static_cast<std::uint8_t>(std::max(0, keypoint.level - 1)), static_cast<std::uint8_t>(keypoint.level + 1),
                         static_cast<std::uint32_t>(2 * i), 2});
    descriptors.insert(descriptors.end(), 2, features.descriptors[feature]);
  }
  FeatureGrid grid(bench_image().cols, bench_image().rows, 1000);
  GuidedMatcher matcher(GuidedMatcherOptions{}, 1000);
  std::size_t num_matches = 0;
  for (auto _ : state) {
    grid.assign(features.keypoints);
    num_matches = matcher.match(features, grid, landmarks, descriptors).size();
  }
  state.counters["matches"] = static_cast<double>(num_matches);
}
BENCHMARK(BM_GuidedMatcher)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace camloc
