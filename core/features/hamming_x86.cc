// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Hamming kernels for x86-64. The two vector kernels work on chunks of train descriptors that are transposed once (word
// k of neighbouring descriptors side by side) and then meet up to 64 queries, four at a time in registers. Best and
// second best are kept per vector lane as 32-bit keys, distance << 16 | position, and reduced at the end.
#if defined(__x86_64__)
// GCC 12 warns about its own AVX-512 intrinsics (GCC bug 105593), at the place where they are inlined.
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wuninitialized"
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif
#include <immintrin.h>

#include <algorithm>
#include <cstring>

#include "core/base/avx2.h"
#include "core/features/hamming_kernels.h"

namespace camloc::hamming {
namespace {

#define CAMLOC_POPCNT __attribute__((target("popcnt")))

/// Positions within a segment fit the low 16 bits of a lane key. The last value is left out, so that no real key is all ones.
constexpr std::size_t kSegment = 65536 - 512;
/// Train descriptors transposed at a time: 16 kB, half of a first-level cache.
constexpr std::size_t kChunk = 512;
constexpr std::size_t kQueriesPerLoad = 4;

struct alignas(64) Transposed {
  std::uint64_t words[kChunk / 8][4][8];  ///< [group of 8 descriptors][word][descriptor]
};

/// Lane keys of one query; 16 lanes of 32 bits.
struct alignas(64) LaneKeys {
  std::uint32_t best[16];
  std::uint32_t second[16];
};

CAMLOC_POPCNT inline int distance_popcnt(const Descriptor& a, const Descriptor& b) {
  return static_cast<int>(_mm_popcnt_u64(a.bits[0] ^ b.bits[0]) + _mm_popcnt_u64(a.bits[1] ^ b.bits[1]) +
                          _mm_popcnt_u64(a.bits[2] ^ b.bits[2]) + _mm_popcnt_u64(a.bits[3] ^ b.bits[3]));
}

CAMLOC_POPCNT void distances_popcnt(const Descriptor& query, const Descriptor* train, std::size_t num_train, std::uint16_t* distances) {
  for (std::size_t i = 0; i < num_train; ++i) distances[i] = static_cast<std::uint16_t>(distance_popcnt(query, train[i]));
}

CAMLOC_POPCNT void distances_at_popcnt(const Descriptor& query, const Descriptor* train, const std::uint32_t* index, std::size_t count,
                                       std::uint16_t* distances) {
  const Descriptor q = query;  // stays in registers: `distances` might alias it
  for (std::size_t i = 0; i < count; ++i) distances[i] = static_cast<std::uint16_t>(distance_popcnt(q, train[index[i]]));
}

CAMLOC_POPCNT void nearest_range_popcnt(const Descriptor* queries, std::size_t num_queries, const Descriptor* train, std::size_t begin,
                                        std::size_t end, TopTwo* top) {
  for (std::size_t q = 0; q < num_queries; ++q)
    for (std::size_t i = begin; i < end; ++i)
      top[q].add(make_key(static_cast<std::uint32_t>(distance_popcnt(queries[q], train[i])), static_cast<std::uint32_t>(i)));
}

void nearest_popcnt(const Descriptor* queries, std::size_t num_queries, const Descriptor* train, std::size_t num_train, TopTwo* top) {
  nearest_range_popcnt(queries, num_queries, train, 0, num_train, top);
}

void transpose(const Descriptor* train, std::size_t count, Transposed* out) {
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t k = 0; k < 4; ++k) out->words[i / 8][k][i % 8] = train[i].bits[k];
}

/// Adds the lane keys of a segment that starts at train index `base` to the result.
void reduce(const LaneKeys& keys, std::size_t base, TopTwo* top) {
  const auto add = [&](std::uint32_t key) {
    if (key != 0xffffffffU) top->add(make_key(key >> 16, static_cast<std::uint32_t>(base + (key & 0xffffU))));
  };
  for (int lane = 0; lane < 16; ++lane) {
    add(keys.best[lane]);
    add(keys.second[lane]);
  }
}

/// One chunk of whole groups of 16 descriptors against four queries; `position` is the chunk's first within the segment.
using ChunkFunction = void (*)(const Descriptor* queries, const Transposed& chunk, std::size_t count, std::uint32_t position,
                               LaneKeys* keys);

template <ChunkFunction kChunkFunction>
void nearest_in_chunks(const Descriptor* queries, std::size_t num_queries, const Descriptor* train, std::size_t num_train, TopTwo* top) {
  Transposed chunk;
  LaneKeys keys[kMaxQueriesPerCall];
  Descriptor padded[kMaxQueriesPerCall];
  static_assert(kMaxQueriesPerCall % kQueriesPerLoad == 0);
  std::copy_n(queries, num_queries, padded);
  const std::size_t whole = num_train / 16 * 16;
  for (std::size_t base = 0; base < whole; base += kSegment) {
    const std::size_t segment_end = std::min(whole, base + kSegment);
    std::memset(keys, 0xff, sizeof(keys));  // no key yet
    for (std::size_t begin = base; begin < segment_end; begin += kChunk) {
      const std::size_t count = std::min(kChunk, segment_end - begin);
      transpose(train + begin, count, &chunk);
      for (std::size_t q = 0; q < num_queries; q += kQueriesPerLoad)
        kChunkFunction(padded + q, chunk, count, static_cast<std::uint32_t>(begin - base), keys + q);
    }
    for (std::size_t q = 0; q < num_queries; ++q) reduce(keys[q], base, &top[q]);
  }
  nearest_range_popcnt(queries, num_queries, train, whole, num_train, top);
}

// ---- AVX2: population count by nibble table (Mula, Kurz, Lemire, "Faster population counts using AVX2", 2017) ----

CAMLOC_AVX2 CAMLOC_INLINE __m256i count_bytes(__m256i x) {
  const __m256i table = _mm256_setr_epi8(0, 1, 1, 2, 1, 2, 2, 3, 1, 2, 2, 3, 2, 3, 3, 4,  //
                                         0, 1, 1, 2, 1, 2, 2, 3, 1, 2, 2, 3, 2, 3, 3, 4);
  const __m256i nibble = _mm256_set1_epi8(15);
  const __m256i low = _mm256_shuffle_epi8(table, _mm256_and_si256(x, nibble));
  const __m256i high = _mm256_shuffle_epi8(table, _mm256_and_si256(_mm256_srli_epi16(x, 4), nibble));
  return _mm256_add_epi8(low, high);
}

/// Distances of four descriptors (half a transposed group) to a query whose words are broadcast, as 64-bit lanes.
CAMLOC_AVX2 CAMLOC_INLINE __m256i distances_of_four(const std::uint64_t (&group)[4][8], int half, const __m256i* query) {
  __m256i sum = _mm256_setzero_si256();
  for (int k = 0; k < 4; ++k) {
    const __m256i word = _mm256_load_si256(reinterpret_cast<const __m256i*>(&group[k][half * 4]));
    sum = _mm256_add_epi8(sum, count_bytes(_mm256_xor_si256(word, query[k])));
  }
  return _mm256_sad_epu8(sum, _mm256_setzero_si256());
}

CAMLOC_AVX2 void chunk_avx2(const Descriptor* queries, const Transposed& chunk, std::size_t count, std::uint32_t position, LaneKeys* keys) {
  for (std::size_t q = 0; q < kQueriesPerLoad; ++q) {
    __m256i query[4];
    for (int k = 0; k < 4; ++k) query[k] = _mm256_set1_epi64x(static_cast<long long>(queries[q].bits[k]));
    // Only eight of the sixteen lanes are used.
    __m256i best = _mm256_load_si256(reinterpret_cast<const __m256i*>(keys[q].best));
    __m256i second = _mm256_load_si256(reinterpret_cast<const __m256i*>(keys[q].second));
    // Even 32-bit lanes hold descriptors 0-3 of a group of eight, odd lanes 4-7.
    __m256i index = _mm256_add_epi32(_mm256_setr_epi32(0, 4, 1, 5, 2, 6, 3, 7), _mm256_set1_epi32(static_cast<int>(position)));
    for (std::size_t group = 0; group < count / 8; ++group) {
      const __m256i low = distances_of_four(chunk.words[group], 0, query);
      const __m256i high = distances_of_four(chunk.words[group], 1, query);
      const __m256i distance = _mm256_or_si256(_mm256_slli_epi64(low, 16), _mm256_slli_epi64(high, 48));
      const __m256i key = _mm256_or_si256(distance, index);
      second = _mm256_min_epu32(second, _mm256_max_epu32(best, key));
      best = _mm256_min_epu32(best, key);
      index = _mm256_add_epi32(index, _mm256_set1_epi32(8));
    }
    _mm256_store_si256(reinterpret_cast<__m256i*>(keys[q].best), best);
    _mm256_store_si256(reinterpret_cast<__m256i*>(keys[q].second), second);
  }
}

// ---- AVX-512 with VPOPCNTDQ ----

#define CAMLOC_AVX512 __attribute__((target("avx512f,avx512vpopcntdq,popcnt")))

CAMLOC_AVX512 void chunk_avx512(const Descriptor* queries, const Transposed& chunk, std::size_t count, std::uint32_t position,
                                LaneKeys* keys) {
  __m512i query[kQueriesPerLoad][4], best[kQueriesPerLoad], second[kQueriesPerLoad];
  for (std::size_t q = 0; q < kQueriesPerLoad; ++q) {
    for (int k = 0; k < 4; ++k) query[q][k] = _mm512_set1_epi64(static_cast<long long>(queries[q].bits[k]));
    best[q] = _mm512_load_si512(keys[q].best);
    second[q] = _mm512_load_si512(keys[q].second);
  }
  // Even 32-bit lanes hold the first group of eight, odd lanes the second.
  __m512i index = _mm512_add_epi32(_mm512_setr_epi32(0, 8, 1, 9, 2, 10, 3, 11, 4, 12, 5, 13, 6, 14, 7, 15),
                                   _mm512_set1_epi32(static_cast<int>(position)));
  for (std::size_t group = 0; group < count / 8; group += 2) {
    __m512i low[4], high[4];
    for (int k = 0; k < 4; ++k) {
      low[k] = _mm512_load_si512(chunk.words[group][k]);
      high[k] = _mm512_load_si512(chunk.words[group + 1][k]);
    }
    for (std::size_t q = 0; q < kQueriesPerLoad; ++q) {
      const auto counts = [&](const __m512i* word) CAMLOC_AVX512 {
        const __m512i a = _mm512_add_epi64(_mm512_popcnt_epi64(_mm512_xor_si512(word[0], query[q][0])),
                                           _mm512_popcnt_epi64(_mm512_xor_si512(word[1], query[q][1])));
        const __m512i b = _mm512_add_epi64(_mm512_popcnt_epi64(_mm512_xor_si512(word[2], query[q][2])),
                                           _mm512_popcnt_epi64(_mm512_xor_si512(word[3], query[q][3])));
        return _mm512_add_epi64(a, b);
      };
      const __m512i a = _mm512_slli_epi64(counts(low), 16);
      const __m512i b = _mm512_slli_epi64(counts(high), 48);
      const __m512i key = _mm512_ternarylogic_epi64(a, b, index, 0xfe);  // a | b | index
      second[q] = _mm512_min_epu32(second[q], _mm512_max_epu32(best[q], key));
      best[q] = _mm512_min_epu32(best[q], key);
    }
    index = _mm512_add_epi32(index, _mm512_set1_epi32(16));
  }
  for (std::size_t q = 0; q < kQueriesPerLoad; ++q) {
    _mm512_store_si512(keys[q].best, best[q]);
    _mm512_store_si512(keys[q].second, second[q]);
  }
}

CAMLOC_AVX512 void distances_avx512(const Descriptor& query, const Descriptor* train, std::size_t num_train, std::uint16_t* distances) {
  const __m512i q = _mm512_broadcast_i64x4(_mm256_load_si256(reinterpret_cast<const __m256i*>(&query)));
  std::size_t i = 0;
  for (; i + 8 <= num_train; i += 8) {
    __m512i count[4];
    for (std::size_t k = 0; k < 4; ++k) count[k] = _mm512_popcnt_epi64(_mm512_xor_si512(_mm512_loadu_si512(train + i + 2 * k), q));
    // Sum of the four words of each descriptor: neighbours first, then the 128-bit halves.
    const __m512i a = _mm512_add_epi64(_mm512_unpacklo_epi64(count[0], count[1]), _mm512_unpackhi_epi64(count[0], count[1]));
    const __m512i b = _mm512_add_epi64(_mm512_unpacklo_epi64(count[2], count[3]), _mm512_unpackhi_epi64(count[2], count[3]));
    const __m512i sum = _mm512_add_epi64(_mm512_shuffle_i64x2(a, b, 0x88), _mm512_shuffle_i64x2(a, b, 0xdd));
    // Lanes now hold descriptors 0 2 1 3 4 6 5 7.
    const __m512i ordered = _mm512_permutexvar_epi64(_mm512_setr_epi64(0, 2, 1, 3, 4, 6, 5, 7), sum);
    _mm_storeu_si128(reinterpret_cast<__m128i*>(distances + i), _mm512_cvtepi64_epi16(ordered));
  }
  for (; i < num_train; ++i) distances[i] = static_cast<std::uint16_t>(distance_popcnt(query, train[i]));
}

}  // namespace

const Kernels kPopcntKernels{"popcnt", distance_popcnt, distances_popcnt, distances_at_popcnt, nearest_popcnt};
const Kernels kAvx2Kernels{"avx2", distance_popcnt, distances_popcnt, distances_at_popcnt, nearest_in_chunks<chunk_avx2>};
const Kernels kAvx512Kernels{"avx512", distance_popcnt, distances_avx512, distances_at_popcnt, nearest_in_chunks<chunk_avx512>};

}  // namespace camloc::hamming
#endif
