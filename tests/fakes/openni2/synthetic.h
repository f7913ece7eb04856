// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What the synthetic OpenNI2 driver and its tests share: the pixels that are delivered, and the switches of the faults. The
// test opens the driver's file, too, so that both see the one SyntheticControl in it.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

namespace camloc::synthetic {

/// Values are OniPixelFormat's. Read when a device is opened, but for what is said to act at once.
struct Control {
  std::atomic<int> num_devices{1};
  std::atomic<int> width{64}, height{48};
  std::atomic<int> depth_format{100};    ///< 0: no depth sensor
  std::atomic<int> color_format{200};    ///< 0: no colour sensor
  std::atomic<int> infrared_format{0};   ///< 0: no infrared sensor
  std::atomic<int> nominal_fps{30};      ///< of the mode and of the stamps
  std::atomic<int> real_fps{30};         ///< how fast frames really come
  std::atomic<int> max_frames{0};        ///< per stream and start; 0: no end
  std::atomic<int> depth_delay_us{0};    ///< added to the stamps of depth
  std::atomic<int> depth_latency_us{0};  ///< depth comes later by this, its stamps unchanged
  std::atomic<std::int64_t> stamp_zero_us{77'000'000};
  std::atomic<std::int64_t> depth_stamp_zero_us{0};  ///< added to the stamps of depth: a second clock
  std::atomic<bool> can_register{true};
  std::atomic<bool> forgets_registration{false};  ///< when a stream starts
  std::atomic<bool> is_mirrored{true};            ///< until told otherwise
  std::atomic<bool> insists_on_mirror{false};
  std::atomic<bool> has_field_of_view{true};
  std::atomic<bool> fails_to_start{false};
  // These act at once.
  std::atomic<bool> is_stalled{false};
  std::atomic<int> num_short_frames{0};  ///< so many next frames say less data than they need
  std::atomic<int> num_small_frames{0};  ///< are of another size than the mode
  std::atomic<int> num_wide_strides{0};  ///< have rows that reach beyond the data
  std::atomic<std::uint64_t> num_opened{0}, num_closed{0};
};

inline constexpr const char* kControlSymbol = "camloc_synthetic_control";
inline constexpr const char* kPlugSymbol = "camloc_synthetic_plug";
/// camloc_synthetic_plug(index, true | false): the device comes or goes, now.
using PlugFunction = void (*)(int, bool);
using ControlFunction = Control* (*)();

/// The truth, by the number of the frame since the stream was started.
inline std::uint16_t depth_at(int frame, int x, int y) {
  return static_cast<std::uint16_t>((x + 2 * y) % 11 == 0 ? 0 : 500 + (7 * x + 3 * y + 5 * frame + x * y / 9) % 4000);
}
inline std::uint16_t infrared_at(int frame, int x, int y) { return static_cast<std::uint16_t>((3 * x + y + 4 * frame) % 1024); }
/// Red, green, blue; smooth, so that JPEG changes it little. Red and green tell the frame.
inline std::array<std::uint8_t, 3> color_at(int frame, int x, int y) {
  return {static_cast<std::uint8_t>(frame % 250), static_cast<std::uint8_t>(20 + frame / 250 + 2 * x),
          static_cast<std::uint8_t>(30 + 3 * y)};
}
/// Bytes of a YUV pixel, limited range.
inline std::uint8_t luma_at(int frame, int x, int y) { return static_cast<std::uint8_t>(16 + (frame + x + 2 * y) % 220); }
inline std::uint8_t chroma_at(int frame, int pair, bool is_v) {
  return static_cast<std::uint8_t>(64 + (frame + 5 * pair + (is_v ? 40 : 0)) % 128);
}

}  // namespace camloc::synthetic
