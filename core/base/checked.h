// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Arithmetic on sizes and offsets that were read from a file: every operation says when it would wrap, so that a bounds
// test can never be fooled by a huge number.
#pragma once

#include <bit>
#include <cassert>
#include <cstdint>
#include <optional>

namespace camloc {

/// a + b, or nothing where the sum does not fit.
[[nodiscard]] inline std::optional<std::uint64_t> checked_add(std::uint64_t a, std::uint64_t b) {
  std::uint64_t sum = 0;
  if (__builtin_add_overflow(a, b, &sum)) return std::nullopt;
  return sum;
}

/// a * b, or nothing where the product does not fit.
[[nodiscard]] inline std::optional<std::uint64_t> checked_multiply(std::uint64_t a, std::uint64_t b) {
  std::uint64_t product = 0;
  if (__builtin_mul_overflow(a, b, &product)) return std::nullopt;
  return product;
}

/// The smallest multiple of `alignment` (a power of two) that is not below `value`, or nothing where it does not fit.
[[nodiscard]] inline std::optional<std::uint64_t> checked_align_up(std::uint64_t value, std::uint64_t alignment) {
  assert(std::has_single_bit(alignment));
  const std::optional<std::uint64_t> padded = checked_add(value, alignment - 1);
  if (!padded) return std::nullopt;
  return *padded & ~(alignment - 1);
}

/// First byte after `count` elements of `element_bytes` that start at `offset`, or nothing where it does not fit.
[[nodiscard]] inline std::optional<std::uint64_t> checked_end(std::uint64_t offset, std::uint64_t count, std::uint64_t element_bytes) {
  const std::optional<std::uint64_t> bytes = checked_multiply(count, element_bytes);
  if (!bytes) return std::nullopt;
  return checked_add(offset, *bytes);
}

}  // namespace camloc
