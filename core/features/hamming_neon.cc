// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Hamming kernel for aarch64, where NEON with its byte population count is always there.
#if defined(__aarch64__)
#include <arm_neon.h>

#include "core/features/hamming_kernels.h"

namespace camloc::hamming {
namespace {

inline int distance_neon(const Descriptor& a, const Descriptor& b) {
  const uint8x16_t low = vreinterpretq_u8_u64(veorq_u64(vld1q_u64(&a.bits[0]), vld1q_u64(&b.bits[0])));
  const uint8x16_t high = vreinterpretq_u8_u64(veorq_u64(vld1q_u64(&a.bits[2]), vld1q_u64(&b.bits[2])));
  return vaddlvq_u8(vaddq_u8(vcntq_u8(low), vcntq_u8(high)));
}

void distances_neon(const Descriptor& query, const Descriptor* train, std::size_t num_train, std::uint16_t* distances) {
  for (std::size_t i = 0; i < num_train; ++i) distances[i] = static_cast<std::uint16_t>(distance_neon(query, train[i]));
}

void distances_at_neon(const Descriptor& query, const Descriptor* train, const std::uint32_t* index, std::size_t count,
                       std::uint16_t* distances) {
  for (std::size_t i = 0; i < count; ++i) distances[i] = static_cast<std::uint16_t>(distance_neon(query, train[index[i]]));
}

void nearest_neon(const Descriptor* queries, std::size_t num_queries, const Descriptor* train, std::size_t num_train, TopTwo* top) {
  nearest_by_pairs(queries, num_queries, train, 0, num_train, top, distance_neon);
}

}  // namespace

const Kernels kNeonKernels{distance_neon, distances_neon, distances_at_neon, nearest_neon};

}  // namespace camloc::hamming
#endif
