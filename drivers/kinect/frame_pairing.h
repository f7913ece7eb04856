// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Which depth image belongs to which colour image: the two cameras run at one rate and on one clock, but not in step.
#pragma once

#include <cstdint>
#include <optional>

namespace camloc::kinect {

enum class Pairing : std::uint8_t {
  kWait,        ///< more has to come
  kPair,        ///< the two belong together
  kColorAlone,  ///< the depth of this colour image is missing
  kDropDepth,   ///< the colour of this depth image is missing
};

/// For the oldest colour and the oldest depth image that are waiting, by their device stamps (32 bits, wrapping). Images of one
/// rate that are at most half a period apart are each other's nearest. `is_overdue`: depth for this colour would be here by now.
[[nodiscard]] constexpr Pairing decide_pairing(std::optional<std::uint32_t> color, std::optional<std::uint32_t> depth, bool is_overdue,
                                               std::int32_t half_period_ticks) {
  if (!color) return Pairing::kWait;
  if (!depth) return is_overdue ? Pairing::kColorAlone : Pairing::kWait;
  const auto depth_after_color = static_cast<std::int32_t>(*depth - *color);
  if (depth_after_color > half_period_ticks) return Pairing::kColorAlone;
  return depth_after_color < -half_period_ticks ? Pairing::kDropDepth : Pairing::kPair;
}

}  // namespace camloc::kinect
