// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The quantized values inside the .cmap file: how a position, a direction, a distance, an angle or a sorted list becomes bytes and
// what the bytes mean. Where a code stands for a bound it is rounded so that the bound still holds.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <span>
#include <vector>

namespace camloc::map_format {

/// Reference distances: code c means kMinReferenceM * 2^(c / kReferenceCodesPerOctave), 0.1 m to 117 m in steps of 2.8 %.
inline constexpr double kMinReferenceM = 0.1;
inline constexpr double kReferenceCodesPerOctave = 25;

/// All 256 distances, by repeated multiplication so that they are the same bits everywhere.
[[nodiscard]] constexpr std::array<float, 256> make_reference_table() {
  constexpr double kStep = 1.0281138266560665;  // 2^(1/25)
  std::array<float, 256> table{};
  double distance_m = kMinReferenceM;
  for (float& entry : table) {
    entry = static_cast<float>(distance_m);
    distance_m *= kStep;
  }
  return table;
}
inline constexpr std::array<float, 256> kReferenceTable = make_reference_table();

/// The largest code whose distance is not above `distance_m`; 0 below the range.
[[nodiscard]] inline std::uint8_t encode_reference_down(float distance_m) {
  const auto above = std::upper_bound(kReferenceTable.begin(), kReferenceTable.end(), distance_m);
  return static_cast<std::uint8_t>(std::max<std::ptrdiff_t>(0, above - kReferenceTable.begin() - 1));
}

/// The smallest code whose distance is not below `distance_m`; 255 above the range.
[[nodiscard]] inline std::uint8_t encode_reference_up(float distance_m) {
  const auto not_below = std::lower_bound(kReferenceTable.begin(), kReferenceTable.end(), distance_m);
  return static_cast<std::uint8_t>(std::min<std::ptrdiff_t>(255, not_below - kReferenceTable.begin()));
}

/// One coordinate within its cube: p = cube_m * (cell + code / 65535).
struct CubeCoordinate {
  std::int32_t cell = 0;
  std::uint16_t code = 0;
  friend bool operator==(const CubeCoordinate&, const CubeCoordinate&) = default;
};

/// `position_m / cube_m` must fit into 32 bits.
[[nodiscard]] inline CubeCoordinate encode_position(float position_m, double cube_m) {
  const double in_cells = static_cast<double>(position_m) / cube_m;
  const double cell = std::floor(in_cells);
  return {static_cast<std::int32_t>(cell), static_cast<std::uint16_t>(std::lround(std::clamp(in_cells - cell, 0.0, 1.0) * 65535))};
}

/// Unit vector to two bytes: the octahedron |x| + |y| + |z| = 1 unfolded into a square (Cigolle et al., "A survey of
/// efficient representations for independent unit vectors", 2014). Codes 0..254 are -1..1; the error stays below 1 degree.
[[nodiscard]] inline std::array<std::uint8_t, 2> encode_direction(const Eigen::Vector3f& direction) {
  const Eigen::Vector3f p = direction / direction.lpNorm<1>();
  float x = p.x(), y = p.y();
  if (p.z() < 0) {
    x = (1 - std::abs(p.y())) * (p.x() >= 0 ? 1.0F : -1.0F);
    y = (1 - std::abs(p.x())) * (p.y() >= 0 ? 1.0F : -1.0F);
  }
  const auto code = [](float v) { return static_cast<std::uint8_t>(std::lround(std::clamp(v, -1.0F, 1.0F) * 127.0F) + 127); };
  return {code(x), code(y)};
}

[[nodiscard]] inline Eigen::Vector3f decode_direction(const std::array<std::uint8_t, 2>& code) {
  const float x = (static_cast<float>(code[0]) - 127.0F) / 127.0F;
  const float y = (static_cast<float>(code[1]) - 127.0F) / 127.0F;
  const float z = 1 - std::abs(x) - std::abs(y);
  const float fold = std::max(-z, 0.0F);
  const Eigen::Vector3f direction(x + (x >= 0 ? -fold : fold), y + (y >= 0 ? -fold : fold), z);
  return direction.normalized();
}

/// [-1, 1] to 0..255, rounded down so that the cone of views is never drawn too narrow.
[[nodiscard]] inline std::uint8_t encode_view_cosine(float cosine) {
  return static_cast<std::uint8_t>(std::floor((std::clamp(cosine, -1.0F, 1.0F) + 1.0F) * 127.5F));
}

/// Any angle to 0..255 over a full turn.
[[nodiscard]] inline std::uint8_t encode_angle(float angle_rad) {
  const long turn_256 = std::lround(static_cast<double>(angle_rad) / (2 * std::numbers::pi) * 256);
  return static_cast<std::uint8_t>(turn_256 & 255);
}

/// A rotation as it is stored: a quaternion whose norm is 1 to the last bits is left alone, so that reading and writing it
/// again changes none of them.
[[nodiscard]] inline Eigen::Quaterniond stored_rotation(const Eigen::Quaterniond& rotation) {
  return std::abs(rotation.squaredNorm() - 1) < 1e-14 ? rotation : rotation.normalized();
}

/// Appends base-128 digits, lowest first, high bit set on all but the last.
inline void append_varint(std::uint32_t value, std::vector<std::uint8_t>* bytes) {
  for (; value >= 128; value >>= 7) bytes->push_back(static_cast<std::uint8_t>(value | 128U));
  bytes->push_back(static_cast<std::uint8_t>(value));
}

/// Reads one number at `*cursor` and moves the cursor behind it. Reads at most five digits and never past the end; what
/// does not fit into 32 bits is lost, so a caller that must know compares with what it expects.
[[nodiscard]] inline std::uint32_t read_varint(std::span<const std::uint8_t> bytes, std::size_t* cursor) {
  std::uint32_t value = 0;
  for (unsigned shift = 0; shift < 35 && *cursor < bytes.size(); shift += 7) {
    const std::uint8_t digit = bytes[(*cursor)++];
    value |= static_cast<std::uint32_t>(digit & 127U) << shift;
    if (digit < 128) break;
  }
  return value;
}

}  // namespace camloc::map_format
