// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What a pair of Kinect images costs, step by step, from its packets to a frame.
#include <benchmark/benchmark.h>

#include "drivers/kinect/kinect_depth.h"
#include "drivers/raw_pixels.h"
#include "tests/drivers/kinect_packet_maker.h"

namespace camloc::kinect {
namespace {

constexpr std::size_t kNumPixels = static_cast<std::size_t>(kWidth) * kHeight;

/// A tilted wall.
std::vector<std::uint16_t> sample_disparities() {
  std::vector<std::uint16_t> raw(kNumPixels);
  for (std::size_t i = 0; i < kNumPixels; ++i) raw[i] = static_cast<std::uint16_t>(500 + i % kWidth / 2 + i / kWidth / 4);
  return raw;
}

KinectCalibration sample_calibration() {
  KinectCalibration calibration;
  calibration.zero_plane = ZeroPlane{};
  calibration.const_shift = 200;
  calibration.registration = RegistrationBlock{};
  calibration.registration->x.start = 6161;
  calibration.registration->y.start = 6434;
  return calibration;
}

void BM_Assemble(benchmark::State& state) {
  const StreamLayout layout = state.range(0) == 0 ? color_layout() : depth_layout();
  PacketMaker maker(layout);
  const std::vector<Packet> packets = maker.packets_of(numbered_frame(layout, 1));
  std::vector<std::uint8_t> target(layout.frame_bytes);
  FrameAssembler assembler(layout);
  assembler.set_target(target);
  for (auto _ : state) {
    assembler.resynchronize();
    for (const Packet& packet : packets) benchmark::DoNotOptimize(assembler.push(packet, 0));
  }
}
BENCHMARK(BM_Assemble)->ArgName("depth")->Arg(0)->Arg(1);

void BM_UnpackDepth(benchmark::State& state) {
  const std::vector<std::uint8_t> packed = numbered_frame(depth_layout(), 1);
  std::vector<std::uint16_t> raw(kNumPixels);
  for (auto _ : state) {
    unpack_pixels(packed.data(), kNumPixels, 11, raw.data());
    benchmark::DoNotOptimize(raw.data());
  }
}
BENCHMARK(BM_UnpackDepth);

void BM_ConvertDepth(benchmark::State& state) {
  const DepthTable table = make_depth_table(sample_calibration());
  const std::vector<std::uint16_t> raw = sample_disparities();
  std::vector<std::uint16_t> millimetres(kNumPixels);
  for (auto _ : state) {
    convert_depth(raw, table, millimetres.data());
    benchmark::DoNotOptimize(millimetres.data());
  }
}
BENCHMARK(BM_ConvertDepth);

void BM_RegisterDepth(benchmark::State& state) {
  const KinectCalibration calibration = sample_calibration();
  const auto registration = DepthRegistration::create(calibration, make_depth_table(calibration));
  const std::vector<std::uint16_t> raw = sample_disparities();
  Image<std::uint16_t> registered;
  for (auto _ : state) {
    registration->apply(raw, &registered);
    benchmark::DoNotOptimize(registered.pixels.data());
  }
}
BENCHMARK(BM_RegisterDepth);

void BM_BayerToGray(benchmark::State& state) {
  const std::vector<std::uint8_t> mosaic = numbered_frame(color_layout(), 1);
  Image<std::uint8_t> gray;
  for (auto _ : state) {
    bayer_to_gray({mosaic.data(), kWidth, kHeight, kWidth}, BayerOrder::kGrbg, &gray);
    benchmark::DoNotOptimize(gray.pixels.data());
  }
}
BENCHMARK(BM_BayerToGray);

void BM_BayerToBgr(benchmark::State& state) {
  const std::vector<std::uint8_t> mosaic = numbered_frame(color_layout(), 1);
  Image<Bgr> color;
  for (auto _ : state) {
    bayer_to_bgr({mosaic.data(), kWidth, kHeight, kWidth}, BayerOrder::kGrbg, &color);
    benchmark::DoNotOptimize(color.pixels.data());
  }
}
BENCHMARK(BM_BayerToBgr);

}  // namespace
}  // namespace camloc::kinect
