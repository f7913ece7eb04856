// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A frame of 640x480 pixels from the bytes of every format to grey, depth and colour.
#include <benchmark/benchmark.h>
#include <linux/videodev2.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <vector>

#include "core/io/image_writer.h"
#include "drivers/v4l2/v4l2_conversion.h"

namespace camloc {
namespace {

constexpr int kWidth = 640, kHeight = 480;

std::vector<std::uint8_t> jpeg_bytes() {
  ColorImage image{{}, kWidth, kHeight};
  std::mt19937 random(1);
  for (int i = 0; i < kWidth * kHeight; ++i) {
    for (const int level : {i % kWidth / 4, i / kWidth / 3, 128})
      image.pixels.push_back(static_cast<std::uint8_t>(level + static_cast<int>(random() % 32)));
  }
  std::string folder = (std::filesystem::temp_directory_path() / "camloc_bench_XXXXXX").string();
  if (::mkdtemp(folder.data()) == nullptr) return {};
  const std::string path = folder + "/frame.jpg";
  std::vector<std::uint8_t> bytes;
  if (write_jpeg(path, image, 85)) {
    std::ifstream file(path, std::ios::binary);
    bytes.assign(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
  }
  std::filesystem::remove_all(folder);
  return bytes;
}

struct RawFrame {
  V4l2ImageLayout layout;
  std::vector<std::uint8_t> bytes;

  explicit RawFrame(const V4l2PixelFormat& format) {
    const std::size_t stride = min_row_bytes(format, kWidth);
    layout = {&format, kWidth, kHeight, {stride, stride}, {}};
    if (format.layout == PixelLayout::kJpeg) {
      bytes = jpeg_bytes();
      return;
    }
    bytes.resize(min_plane_bytes(format, 0, kWidth, kHeight, stride));
    std::mt19937 random(1);
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
  }
  [[nodiscard]] V4l2Planes planes() const { return {bytes, bytes}; }
};

void to_gray(benchmark::State& state, const V4l2PixelFormat& format) {
  const RawFrame frame(format);
  Image<std::uint8_t> gray;
  for (auto _ : state) {
    if (!convert_to_gray(frame.layout, frame.planes(), format.significant_bits, &gray)) return state.SkipWithError("conversion failed");
    benchmark::DoNotOptimize(gray.pixels.data());
  }
}

void to_bgr(benchmark::State& state, const V4l2PixelFormat& format) {
  const RawFrame frame(format);
  Image<std::uint8_t> scratch;
  Image<Bgr> color;
  for (auto _ : state) {
    if (!convert_to_bgr(frame.layout, frame.planes(), &scratch, &color)) return state.SkipWithError("conversion failed");
    benchmark::DoNotOptimize(color.pixels.data());
  }
}

void to_depth(benchmark::State& state, const V4l2PixelFormat& format) {
  const RawFrame frame(format);
  Image<std::uint16_t> depth;
  for (auto _ : state) {
    convert_to_depth(frame.layout, frame.planes(), &depth);
    benchmark::DoNotOptimize(depth.pixels.data());
  }
}

const bool kIsRegistered = [] {
  for (const V4l2PixelFormat& format : v4l2_pixel_formats()) {
    if (format.num_planes > 1) continue;  // the same work as its one-plane sister
    const std::string name = fourcc_name(format.fourcc);
    using benchmark::RegisterBenchmark;
    if (format.can_be_image) RegisterBenchmark(("gray/" + name).c_str(), to_gray, format)->Unit(benchmark::kMillisecond);
    if (format.can_be_depth) RegisterBenchmark(("depth/" + name).c_str(), to_depth, format)->Unit(benchmark::kMillisecond);
    if (format.has_color) RegisterBenchmark(("bgr/" + name).c_str(), to_bgr, format)->Unit(benchmark::kMillisecond);
  }
  return true;
}();

}  // namespace
}  // namespace camloc
