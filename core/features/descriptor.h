// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Image features: keypoints with 256-bit binary descriptors, in the bit order of cv::ORB.
#pragma once

#include <array>
#include <cstddef>
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

/// The pixels around a feature, on the pyramid level it was found on: enough to find out later, to a fraction of a pixel, where one
/// image shows what another one shows.
struct FeaturePatch {
  static constexpr int kHalf = 8, kSide = 2 * kHalf + 1;
  std::array<std::uint8_t, static_cast<std::size_t>(kSide* kSide)> pixels{};  ///< row by row, the feature in the middle

  /// Grey level at whole pixels from the feature, each in [-kHalf, kHalf].
  [[nodiscard]] std::uint8_t at(int dx, int dy) const { return pixels[static_cast<std::size_t>((dy + kHalf) * kSide + dx + kHalf)]; }
};

}  // namespace camloc
