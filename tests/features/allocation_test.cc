// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Extraction and matching must not touch the heap after construction. malloc and its relatives are replaced in this test
// program by functions that count and pass on.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <random>

#include "core/features/matcher.h"
#include "core/features/orb_extractor.h"
#include "tests/features/reference_images.h"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define CAMLOC_COUNTS_MALLOC 0  // the sanitizers replace malloc themselves
#else
#define CAMLOC_COUNTS_MALLOC 1
#endif

namespace {
std::atomic<long> num_allocations{0};
}  // namespace

#if CAMLOC_COUNTS_MALLOC
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* old, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);

void* malloc(std::size_t size) {
  ++num_allocations;
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  ++num_allocations;
  return __libc_calloc(count, size);
}
void* realloc(void* old, std::size_t size) {
  ++num_allocations;
  return __libc_realloc(old, size);
}
void* memalign(std::size_t alignment, std::size_t size) {
  ++num_allocations;
  return __libc_memalign(alignment, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) { return memalign(alignment, size); }
int posix_memalign(void** out, std::size_t alignment, std::size_t size) {
  *out = memalign(alignment, size);
  return *out == nullptr ? 12 : 0;
}
}
#endif

namespace camloc {
namespace {

class AllocationTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!CAMLOC_COUNTS_MALLOC) GTEST_SKIP() << "a sanitizer owns malloc";
  }
};

TEST_F(AllocationTest, CounterCounts) {
  const long before = num_allocations;
  std::vector<int> numbers(100);
  EXPECT_EQ(numbers.size(), 100U);
  EXPECT_GT(num_allocations, before);
}

TEST_F(AllocationTest, ExtractAndMatchDoNotAllocate) {
  const std::vector<cv::Mat> images{textured_image(640, 480, 1), noise_image(640, 480, 2), cv::Mat(480, 640, CV_8UC1, cv::Scalar(90)),
                                    textured_image(640, 480, 3)};
  OrbExtractor extractor(640, 480, OrbOptions{});
  FeatureGrid grid(640, 480, 1000);
  GuidedMatcher guided(GuidedMatcherOptions{}, 1000);
  CandidateSet candidates(4000);
  CandidateMatcher matcher(CandidateMatcherOptions{}, 1000, 4000);
  const Features mapped = extractor.extract(view_of(images[0]));
  std::vector<ProjectedLandmark> landmarks;
  for (std::size_t i = 0; i < mapped.size(); ++i)
    landmarks.push_back(
        {static_cast<std::int32_t>(i), mapped.keypoints[i].u, mapped.keypoints[i].v, 15, 0, 7, static_cast<std::uint32_t>(i), 1});

  std::size_t num_matches = 0;
  const long before = num_allocations;
  for (const cv::Mat& image : images) {
    const Features& features = extractor.extract(view_of(image));
    grid.assign(features.keypoints);
    num_matches += guided.match(features, grid, landmarks, mapped.descriptors).size();
    candidates.clear();
    for (int repeat = 0; repeat < 5; ++repeat)
      for (std::size_t i = 0; i < mapped.size(); ++i)
        candidates.add(mapped.descriptors[i], static_cast<std::int32_t>(i), mapped.keypoints[i].angle_rad);
    num_matches += matcher.match(features, candidates).size();
  }
  EXPECT_EQ(num_allocations - before, 0);
  EXPECT_GT(num_matches, 1000U);
}

}  // namespace
}  // namespace camloc
