// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What a depth camera delivers: a grey image and a depth image with the time of their exposure. `Frame` only looks at
// pixels that somebody else owns; `FrameBuffer` owns them and is reused from frame to frame.
#pragma once

#include <cstdint>
#include <vector>

namespace camloc {

/// Pixels in rows, owned by somebody else. `stride` counts elements, not bytes.
template <typename T>
struct ImageView {
  const T* data = nullptr;
  int width = 0;
  int height = 0;
  int stride = 0;

  [[nodiscard]] bool empty() const { return data == nullptr || width <= 0 || height <= 0; }
  [[nodiscard]] const T* row(int y) const { return data + static_cast<std::ptrdiff_t>(y) * stride; }
  [[nodiscard]] T at(int x, int y) const { return row(y)[x]; }
};

/// Pixels in rows without gaps, owned. `resize` allocates only when the image grows.
template <typename T>
struct Image {
  std::vector<T> pixels;
  int width = 0;
  int height = 0;

  void resize(int new_width, int new_height) {
    width = new_width;
    height = new_height;
    pixels.resize(static_cast<std::size_t>(new_width) * static_cast<std::size_t>(new_height));
  }
  [[nodiscard]] T* row(int y) { return pixels.data() + static_cast<std::ptrdiff_t>(y) * width; }
  [[nodiscard]] const T* row(int y) const { return pixels.data() + static_cast<std::ptrdiff_t>(y) * width; }
  [[nodiscard]] T& at(int x, int y) { return row(y)[x]; }
  [[nodiscard]] T at(int x, int y) const { return row(y)[x]; }
  [[nodiscard]] ImageView<T> view() const { return {pixels.data(), width, height, width}; }
};

/// One pixel of a colour image.
struct Bgr {
  std::uint8_t b = 0, g = 0, r = 0;
};

/// One exposure of an RGB-D camera. `depth` holds raw units of the depth camera (see RgbdCamera::depth_unit_m), in the
/// depth camera's own pixels; it may be empty.
struct Frame {
  std::uint64_t sequence = 0;  ///< counts exposures; for a recording the index of the frame in it
  std::int64_t stamp_ns = 0;   ///< time of capture, nanoseconds; the source says of which clock
  ImageView<std::uint8_t> gray;
  ImageView<std::uint16_t> depth;
};

/// Storage for one exposure, filled by a FrameSource.
struct FrameBuffer {
  std::uint64_t sequence = 0;
  std::int64_t stamp_ns = 0;
  Image<std::uint8_t> gray;
  Image<std::uint16_t> depth;
  Image<Bgr> color;  ///< empty unless the source was asked for it; localization does without

  [[nodiscard]] Frame view() const { return {sequence, stamp_ns, gray.view(), depth.view()}; }
};

}  // namespace camloc
