// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// See video_mode.h.
#include "drivers/openni2/video_mode.h"

#include <cstdlib>
#include <tuple>

namespace camloc::openni2 {

namespace {

/// Smaller is better; empty for formats of no use.
std::optional<int> format_rank(int oni_pixel_format, StreamUse use) {
  const std::optional<PixelFormat> format = pixel_format_of(oni_pixel_format);
  if (!format || (format->depth_unit_m > 0) != (use == StreamUse::kDepth)) return std::nullopt;
  switch (format->layout) {
    case PixelLayout::kDepth16: return format->depth_unit_m > 5e-4 ? 0 : 1;
    case PixelLayout::kRgb24: return 0;
    case PixelLayout::kUyvy: return 1;
    case PixelLayout::kYuyv: return 2;
    case PixelLayout::kGray8: return 3;
    case PixelLayout::kGray16: return 4;
    case PixelLayout::kJpeg: return std::nullopt;
  }
  return std::nullopt;
}

}  // namespace

std::optional<OniVideoMode> choose_mode(std::span<const OniVideoMode> offered, StreamUse use, const ModeRequest& request) {
  constexpr ModeRequest kUsual{640, 480, 30};
  std::optional<OniVideoMode> best;
  std::tuple<int, int, int> best_rank;
  for (const OniVideoMode& mode : offered) {
    const std::optional<int> rank_of_format = format_rank(mode.pixelFormat, use);
    if (!rank_of_format || mode.resolutionX <= 0 || mode.resolutionY <= 0 || mode.resolutionX > 16384 || mode.resolutionY > 16384 ||
        mode.fps <= 0 || mode.fps > 1000)
      continue;
    if ((request.width > 0 && mode.resolutionX != request.width) || (request.height > 0 && mode.resolutionY != request.height)) continue;
    if (request.fps > 0 && mode.fps != request.fps) continue;
    const std::tuple rank(std::abs(mode.resolutionX - kUsual.width) + std::abs(mode.resolutionY - kUsual.height),
                          std::abs(mode.fps - kUsual.fps), *rank_of_format);
    if (best && rank >= best_rank) continue;
    best = mode;
    best_rank = rank;
  }
  return best;
}

std::string describe(const OniVideoMode& mode) {
  const std::optional<PixelFormat> format = pixel_format_of(mode.pixelFormat);
  std::string pixels = "format " + std::to_string(mode.pixelFormat);
  if (format) pixels = format->depth_unit_m <= 0 ? name_of(format->layout) : format->depth_unit_m > 5e-4 ? "in 1 mm" : "in 0.1 mm";
  return std::to_string(mode.resolutionX) + "x" + std::to_string(mode.resolutionY) + "@" + std::to_string(mode.fps) + " " + pixels;
}

std::string describe(std::span<const OniVideoMode> modes) {
  constexpr std::size_t kMostListed = 40;
  std::string list;
  for (std::size_t i = 0; i < modes.size() && i < kMostListed; ++i) list += (i == 0 ? "" : ", ") + describe(modes[i]);
  return list.empty() ? "nothing" : list;
}

}  // namespace camloc::openni2
