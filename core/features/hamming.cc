// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/features/hamming.h"

#if defined(__aarch64__)
#include <arm_neon.h>
#endif

#include <algorithm>
#include <array>
#include <bit>

#include "core/base/avx2.h"
#include "core/features/hamming_kernels.h"

namespace camloc {
namespace hamming {
namespace {

int distance_scalar(const Descriptor& a, const Descriptor& b) {
  int sum = 0;
  for (std::size_t k = 0; k < a.bits.size(); ++k) sum += std::popcount(a.bits[k] ^ b.bits[k]);
  return sum;
}

#if defined(__aarch64__)
/// NEON with its byte population count is always there.
int distance_neon(const Descriptor& a, const Descriptor& b) {
  const uint8x16_t low = vreinterpretq_u8_u64(veorq_u64(vld1q_u64(&a.bits[0]), vld1q_u64(&b.bits[0])));
  const uint8x16_t high = vreinterpretq_u8_u64(veorq_u64(vld1q_u64(&a.bits[2]), vld1q_u64(&b.bits[2])));
  return vaddlvq_u8(vaddq_u8(vcntq_u8(low), vcntq_u8(high)));
}
constexpr Kernels kNeonKernels = kernels_by_pairs<distance_neon>("neon");
#endif
constexpr Kernels kScalarKernels = kernels_by_pairs<distance_scalar>("scalar");

}  // namespace

std::vector<const Kernels*> available_kernels() {
  std::vector<const Kernels*> kernels{&kScalarKernels};
#if defined(__x86_64__)
  if (__builtin_cpu_supports("popcnt") == 0) return kernels;
  kernels.push_back(&kPopcntKernels);
  if (has_avx2()) kernels.push_back(&kAvx2Kernels);
  if (__builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512vpopcntdq") != 0) kernels.push_back(&kAvx512Kernels);
#elif defined(__aarch64__)
  kernels.push_back(&kNeonKernels);
#endif
  return kernels;
}

namespace {
/// Chosen before main(): the first frame must not allocate.
const Kernels& kBestKernels = *available_kernels().back();
}  // namespace

const Kernels& best_kernels() { return kBestKernels; }

void nearest_two(const Kernels& kernels, const Descriptor* queries, std::size_t num_queries, const Descriptor* train, std::size_t num_train,
                 TopTwo* top) {
  for (std::size_t begin = 0; begin < num_queries; begin += kMaxQueriesPerCall) {
    const std::size_t count = std::min(kMaxQueriesPerCall, num_queries - begin);
    std::fill_n(top + begin, count, TopTwo{});
    kernels.nearest(queries + begin, count, train, num_train, top + begin);
  }
}

void nearest_descriptors(const Kernels& kernels, std::span<const Descriptor> queries, std::span<const Descriptor> train,
                         NearestDescriptor* nearest) {
  std::array<TopTwo, kMaxQueriesPerCall> top;
  for (std::size_t begin = 0; begin < queries.size(); begin += top.size()) {
    const std::size_t count = std::min(top.size(), queries.size() - begin);
    nearest_two(kernels, queries.data() + begin, count, train.data(), train.size(), top.data());
    for (std::size_t q = 0; q < count; ++q)
      nearest[begin + q] = {static_cast<std::uint32_t>(top[q].best), static_cast<std::uint16_t>(top[q].best >> 32),
                            static_cast<std::uint16_t>(top[q].second >> 32)};
  }
}

}  // namespace hamming

const char* hamming_kernel_name() { return hamming::best_kernels().name; }

int hamming_distance(const Descriptor& a, const Descriptor& b) { return hamming::best_kernels().distance(a, b); }

void hamming_distances(const Descriptor& query, std::span<const Descriptor> train, std::uint16_t* distances) {
  hamming::best_kernels().distances(query, train.data(), train.size(), distances);
}

void nearest_descriptors(std::span<const Descriptor> queries, std::span<const Descriptor> train, NearestDescriptor* nearest) {
  hamming::nearest_descriptors(hamming::best_kernels(), queries, train, nearest);
}

}  // namespace camloc
