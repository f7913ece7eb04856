// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What a network learns from: images with the pose of the camera that took them, and the same images as a camera that is turned a
// little and exposed otherwise would have taken them.
#pragma once

#include <cstdint>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "core/base/frame.h"
#include "core/base/result.h"
#include "core/coarse/network_input.h"
#include "core/geometry/rigid3.h"

namespace camloc::training {

/// Twice as fine as the network's input and a little wider, of the ideal camera that the network sees through. Kept as it is small:
/// four bytes a pixel of the input.
struct TrainingView {
  Image<std::uint8_t> gray;
  Image<std::uint8_t> depth;  ///< 255 for 5 m, 0 where there is none; empty without depth
  Rigid3 T_map_camera;
  std::uint64_t frame = 0;  ///< of its recording
  std::uint32_t recording = 0;
};

/// Of everything that is varied, the largest deviation; all zero: the image as it is.
struct AugmentationLimits {
  double turn_rad = 0.06;  ///< to either side and up and down: a crop elsewhere, with the pose that belongs to it
  double roll_rad = 0.10;
  double exposure = 0.35;  ///< logarithm of the factor
  double gamma = 0.25;     ///< the same of the exponent
  double blur_px = 1.5;    ///< half width, of the input's pixels
  double noise = 6;        ///< standard deviation, grey levels
};

/// One view of a camera that looks through the layout of the network.
class TrainingSet {
 public:
  TrainingSet(const RgbdCamera& camera, const NetworkInputLayout& layout, bool has_depth);

  /// Takes a copy of what the network may see of the frame.
  void add(const Frame& frame, const Rigid3& T_map_camera, std::uint32_t recording);
  [[nodiscard]] std::span<const TrainingView> views() const { return views_; }
  [[nodiscard]] std::size_t input_size() const;

  /// Fills `input`, of input_size(), and returns the pose of the camera that sees it. The same generator gives the same input.
  [[nodiscard]] Rigid3 draw(std::size_t view, const AugmentationLimits& limits, std::mt19937_64* random, std::span<float> input) const;

 private:
  NetworkInputLayout layout_, fine_;
  NetworkInput to_fine_;
  std::vector<float> buffer_;
  std::vector<TrainingView> views_;
};

/// Why nothing can be learned from these views, else ok: fewer than 20, or the camera stood still (kInvalid).
[[nodiscard]] Status check_training_views(std::span<const TrainingView> views);

}  // namespace camloc::training
