// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Inside of hamming.cc: one table of functions per instruction set. Everything here gives the same numbers for every
// table; the tables differ in speed only.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/features/descriptor.h"
#include "core/features/hamming.h"

namespace camloc::hamming {

/// The two nearest train descriptors of a query, as keys distance << 32 | index: the order of keys is the order by
/// distance, then by index, whichever order the candidates were seen in.
struct TopTwo {
  std::uint64_t best = kNone;
  std::uint64_t second = kNone;

  static constexpr std::uint64_t kNone = std::uint64_t{257} << 32;

  void add(std::uint64_t key) {
    if (key < best) {
      second = best;
      best = key;
    } else if (key < second) {
      second = key;
    }
  }
};

inline std::uint64_t make_key(std::uint32_t distance, std::uint32_t index) { return std::uint64_t{distance} << 32 | index; }

/// Most queries one call of nearest() takes; bounds the state the kernels hold on the stack.
inline constexpr std::size_t kMaxQueriesPerCall = 64;

struct Kernels {
  const char* name;
  int (*distance)(const Descriptor& a, const Descriptor& b);
  void (*distances)(const Descriptor& query, const Descriptor* train, std::size_t num_train, std::uint16_t* distances);
  /// Distance from `query` to train[index[i]], i < count.
  void (*distances_at)(const Descriptor& query, const Descriptor* train, const std::uint32_t* index, std::size_t count,
                       std::uint16_t* distances);
  /// Adds all of `train` to top[0 .. num_queries); num_queries <= kMaxQueriesPerCall.
  void (*nearest)(const Descriptor* queries, std::size_t num_queries, const Descriptor* train, std::size_t num_train, TopTwo* top);
};

/// A table of loops over pairs, for kernels that have nothing better than the distance of one pair.
template <int (*kDistance)(const Descriptor&, const Descriptor&)>
constexpr Kernels kernels_by_pairs(const char* name) {
  return {name, kDistance,
          [](const Descriptor& query, const Descriptor* train, std::size_t num_train, std::uint16_t* distances) {
            for (std::size_t i = 0; i < num_train; ++i) distances[i] = static_cast<std::uint16_t>(kDistance(query, train[i]));
          },
          [](const Descriptor& query, const Descriptor* train, const std::uint32_t* index, std::size_t count, std::uint16_t* distances) {
            for (std::size_t i = 0; i < count; ++i) distances[i] = static_cast<std::uint16_t>(kDistance(query, train[index[i]]));
          },
          [](const Descriptor* queries, std::size_t num_queries, const Descriptor* train, std::size_t num_train, TopTwo* top) {
            for (std::size_t q = 0; q < num_queries; ++q)
              for (std::size_t i = 0; i < num_train; ++i)
                top[q].add(make_key(static_cast<std::uint32_t>(kDistance(queries[q], train[i])), static_cast<std::uint32_t>(i)));
          }};
}

/// Smallest of `count` distances; 257 of none. Signed, because baseline x86-64 has a vector minimum for signed 16-bit numbers
/// only.
inline std::uint16_t smallest(const std::uint16_t* distances, std::size_t count) {
  std::int16_t minimum = 257;
  for (std::size_t i = 0; i < count; ++i) minimum = std::min(minimum, static_cast<std::int16_t>(distances[i]));
  return static_cast<std::uint16_t>(minimum);
}

#if defined(__x86_64__)
extern const Kernels kPopcntKernels;
extern const Kernels kAvx2Kernels;
extern const Kernels kAvx512Kernels;
#endif

/// The tables that this processor can run, slowest first. The first is the portable one.
[[nodiscard]] std::vector<const Kernels*> available_kernels();
/// The table of the fastest kernel.
const Kernels& best_kernels();

/// Nearest and second nearest with both indices, for callers that care whom the second belongs to.
void nearest_two(const Kernels& kernels, const Descriptor* queries, std::size_t num_queries, const Descriptor* train, std::size_t num_train,
                 TopTwo* top);

/// nearest_descriptors() with these kernels.
void nearest_descriptors(const Kernels& kernels, std::span<const Descriptor> queries, std::span<const Descriptor> train,
                         NearestDescriptor* nearest);

}  // namespace camloc::hamming
