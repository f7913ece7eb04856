// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Image features: keypoints with 256-bit binary descriptors, in the bit order of cv::ORB.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace camloc {

/// 256 bits, rotated BRIEF (Rublee et al., "ORB: an efficient alternative to SIFT or SURF", 2011). Byte i, bit j is
/// test 8 i + j of the pattern, as in a row of cv::ORB's descriptor matrix.
struct alignas(32) Descriptor {
  std::array<std::uint64_t, 4> bits{};
  friend bool operator==(const Descriptor&, const Descriptor&) = default;
};

struct Keypoint {
  float u = 0, v = 0;      ///< pixels of level 0, centres at integers
  float angle_rad = 0;     ///< orientation in [0, 2 pi), x towards y
  float response = 0;      ///< corner score, for ranking within a level
  std::uint8_t level = 0;  ///< pyramid level, 0 = full size
};

/// Features of one image. `keypoints[i]` and `descriptors[i]` belong together.
struct Features {
  std::vector<Keypoint> keypoints;
  std::vector<Descriptor> descriptors;
  [[nodiscard]] std::size_t size() const { return keypoints.size(); }
};

}  // namespace camloc
