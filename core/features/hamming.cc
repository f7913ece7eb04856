// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Choice of the kernel, the portable kernel, and the loop over blocks of queries.
#include "core/features/hamming.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>

#include "core/features/hamming_kernels.h"

namespace camloc {
namespace hamming {
namespace {

int distance_scalar(const Descriptor& a, const Descriptor& b) {
  int sum = 0;
  for (std::size_t k = 0; k < a.bits.size(); ++k) sum += std::popcount(a.bits[k] ^ b.bits[k]);
  return sum;
}

void distances_scalar(const Descriptor& query, const Descriptor* train, std::size_t num_train, std::uint16_t* distances) {
  for (std::size_t i = 0; i < num_train; ++i) distances[i] = static_cast<std::uint16_t>(distance_scalar(query, train[i]));
}

void distances_at_scalar(const Descriptor& query, const Descriptor* train, const std::uint32_t* index, std::size_t count,
                         std::uint16_t* distances) {
  for (std::size_t i = 0; i < count; ++i) distances[i] = static_cast<std::uint16_t>(distance_scalar(query, train[index[i]]));
}

void nearest_scalar(const Descriptor* queries, std::size_t num_queries, const Descriptor* train, std::size_t num_train, TopTwo* top) {
  nearest_by_pairs(queries, num_queries, train, 0, num_train, top, distance_scalar);
}

bool is_available(HammingKernel kernel) {
  switch (kernel) {
    case HammingKernel::kScalar: return true;
#if defined(__x86_64__)
    case HammingKernel::kPopcnt: return __builtin_cpu_supports("popcnt") != 0;
    case HammingKernel::kAvx2: return __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("popcnt") != 0;
    case HammingKernel::kAvx512:
      return __builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512vpopcntdq") != 0 &&
             __builtin_cpu_supports("popcnt") != 0;
#elif defined(__aarch64__)
    case HammingKernel::kNeon: return true;
#endif
    default: return false;
  }
}

}  // namespace

const Kernels kScalarKernels{distance_scalar, distances_scalar, distances_at_scalar, nearest_scalar};

const Kernels& kernels_of(HammingKernel kernel) {
  assert(is_available(kernel));
  switch (kernel) {
#if defined(__x86_64__)
    case HammingKernel::kPopcnt: return kPopcntKernels;
    case HammingKernel::kAvx2: return kAvx2Kernels;
    case HammingKernel::kAvx512: return kAvx512Kernels;
#elif defined(__aarch64__)
    case HammingKernel::kNeon: return kNeonKernels;
#endif
    default: return kScalarKernels;
  }
}

const Kernels& best_kernels() {
  static const Kernels& best = kernels_of(best_hamming_kernel());
  return best;
}

void nearest_two(const Kernels& kernels, const Descriptor* queries, std::size_t num_queries, const Descriptor* train, std::size_t num_train,
                 TopTwo* top) {
  for (std::size_t begin = 0; begin < num_queries; begin += kMaxQueriesPerCall) {
    const std::size_t count = std::min(kMaxQueriesPerCall, num_queries - begin);
    std::fill_n(top + begin, count, TopTwo{});
    kernels.nearest(queries + begin, count, train, num_train, top + begin);
  }
}

}  // namespace hamming

const char* to_string(HammingKernel kernel) {
  switch (kernel) {
    case HammingKernel::kScalar: return "scalar";
    case HammingKernel::kPopcnt: return "popcnt";
    case HammingKernel::kAvx2: return "avx2";
    case HammingKernel::kAvx512: return "avx512";
    case HammingKernel::kNeon: return "neon";
  }
  return "unknown";
}

std::vector<HammingKernel> available_hamming_kernels() {
  std::vector<HammingKernel> kernels;
  for (const auto kernel :
       {HammingKernel::kScalar, HammingKernel::kPopcnt, HammingKernel::kAvx2, HammingKernel::kAvx512, HammingKernel::kNeon})
    if (hamming::is_available(kernel)) kernels.push_back(kernel);
  return kernels;
}

HammingKernel best_hamming_kernel() {
  for (const auto kernel : {HammingKernel::kNeon, HammingKernel::kAvx512, HammingKernel::kAvx2, HammingKernel::kPopcnt})
    if (hamming::is_available(kernel)) return kernel;
  return HammingKernel::kScalar;
}

int hamming_distance(const Descriptor& a, const Descriptor& b) { return hamming::best_kernels().distance(a, b); }

void hamming_distances(const Descriptor& query, std::span<const Descriptor> train, std::uint16_t* distances) {
  hamming::best_kernels().distances(query, train.data(), train.size(), distances);
}

void nearest_descriptors(std::span<const Descriptor> queries, std::span<const Descriptor> train, NearestDescriptor* nearest) {
  nearest_descriptors(queries, train, nearest, best_hamming_kernel());
}

void nearest_descriptors(std::span<const Descriptor> queries, std::span<const Descriptor> train, NearestDescriptor* nearest,
                         HammingKernel kernel) {
  const hamming::Kernels& kernels = hamming::kernels_of(kernel);
  std::array<hamming::TopTwo, hamming::kMaxQueriesPerCall> top;
  for (std::size_t begin = 0; begin < queries.size(); begin += top.size()) {
    const std::size_t count = std::min(top.size(), queries.size() - begin);
    hamming::nearest_two(kernels, queries.data() + begin, count, train.data(), train.size(), top.data());
    for (std::size_t q = 0; q < count; ++q)
      nearest[begin + q] = {static_cast<std::uint32_t>(top[q].best), static_cast<std::uint16_t>(top[q].best >> 32),
                            static_cast<std::uint16_t>(top[q].second >> 32)};
  }
}

}  // namespace camloc
