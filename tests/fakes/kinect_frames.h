// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What the fake Kinect shows: a pattern that a test can compute for itself, or the frames of a recorded sequence turned back into
// what the sensors would have sent: colour into a GRBG mosaic, depth in millimetres into packed 11-bit disparities.
//
// Recorded depth loses resolution on the way there and back: it is rounded to the depth of the nearest disparity (see
// mm_to_disparity): at most 1.4 mm at 1 m, 5.7 mm at 2 m, 23 mm at 4 m. Recordings of a Kinect lose next to nothing, as their depth
// came from such disparities, unless the device that recorded them had another calibration.
#pragma once

#include <map>
#include <memory>
#include <string>

#include "core/base/result.h"
#include "core/base/unique_fd.h"
#include "core/io/image_file.h"
#include "tests/fakes/kinect_model.h"

namespace camloc::fakes {

inline constexpr std::size_t kColorBytes = 640 * 480;
inline constexpr std::size_t kDepthBytes = 640 * 480 * 11 / 8;

/// `bits` low bits of each value, most significant first, without gaps.
[[nodiscard]] std::vector<std::uint8_t> pack_bits(std::span<const std::uint16_t> values, int bits);
[[nodiscard]] std::vector<std::uint16_t> unpack_bits(std::span<const std::uint8_t> bytes, int bits);
/// What a GRBG sensor sees of a 640x480 picture: of each pixel the one colour that its filter lets through.
[[nodiscard]] std::vector<std::uint8_t> bayer_mosaic(const ColorImage& image);

/// The pattern repeats after kPatternPeriod frames.
inline constexpr std::uint64_t kPatternPeriod = 16;
[[nodiscard]] std::uint8_t pattern_color(int x, int y, std::uint64_t index);
[[nodiscard]] std::uint16_t pattern_disparity(int x, int y, std::uint64_t index);

class PatternShow final : public FrameShow {
 public:
  [[nodiscard]] std::span<const std::uint8_t> frame(FrameFormat format, std::uint64_t index) override;

 private:
  std::map<std::pair<FrameFormat, std::uint64_t>, std::vector<std::uint8_t>> frames_;
};

enum class AtEnd { kLoop, kHold };

struct ReplayOptions {
  std::string folder;        ///< TUM RGB-D or 7-Scenes, 640x480
  std::string frames;        ///< Python slices of it, comma-separated; empty: all
  double depth_unit_mm = 1;  ///< of the depth images: 1 for 7-Scenes, 0.2 for TUM RGB-D
  AtEnd at_end = AtEnd::kLoop;
  std::string cache_file;  ///< rendered frames are kept here for the next run; empty: in memory
};

class ReplayShow final : public FrameShow {
 public:
  /// Renders all frames before it returns (about 15 ms a frame), unless the cache file has them.
  [[nodiscard]] static Result<std::unique_ptr<ReplayShow>> open(const ReplayOptions& options, const KinectCalibration& calibration);
  ~ReplayShow() override;
  /// Formats that the recording cannot give (infrared, high resolution) are a pattern.
  [[nodiscard]] std::span<const std::uint8_t> frame(FrameFormat format, std::uint64_t index) override;
  [[nodiscard]] std::uint64_t num_frames() const { return num_frames_; }

 private:
  ReplayShow() = default;
  [[nodiscard]] std::uint64_t wrapped(std::uint64_t index) const;

  UniqueFd file_;
  const std::uint8_t* mapped_ = nullptr;
  std::uint64_t num_frames_ = 0;
  AtEnd at_end_ = AtEnd::kLoop;
  PatternShow pattern_;
  std::vector<std::uint8_t> depth10_;
  std::uint64_t depth10_index_ = ~std::uint64_t{0};
};

}  // namespace camloc::fakes
