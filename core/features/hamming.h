// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Hamming distance of 256-bit descriptors. The widest kernel the processor has is chosen once at run time: scalar,
// POPCNT, AVX2, AVX-512 VPOPCNTDQ on x86-64, NEON on aarch64. All kernels give the same bits, ties included.
#pragma once

#include <cstdint>
#include <span>

#include "core/features/descriptor.h"

namespace camloc {

/// Of the kernel in use, for people.
[[nodiscard]] const char* hamming_kernel_name();

/// Number of differing bits, 0..256.
[[nodiscard]] int hamming_distance(const Descriptor& a, const Descriptor& b);

/// Distance from one query to each of `train`; `distances` has at least train.size() entries.
void hamming_distances(const Descriptor& query, std::span<const Descriptor> train, std::uint16_t* distances);

struct NearestDescriptor {
  std::uint32_t index = 0;       ///< of the smallest distance, the first where several are equal
  std::uint16_t distance = 257;  ///< 257: train was empty
  std::uint16_t second = 257;    ///< second smallest distance, at another index
};

/// Nearest train descriptor of every query. `nearest` has at least queries.size() entries. Works in tiles of `train` that
/// stay in the L2 cache with several queries per load.
void nearest_descriptors(std::span<const Descriptor> queries, std::span<const Descriptor> train, NearestDescriptor* nearest);
}  // namespace camloc
