// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// One frame through the localizer, tracked and kidnapped, and the frames that end in no pose. 640 x 480 frames of the
// sample room, rendered beforehand. The counter is the share of frames that were localized.
#include <benchmark/benchmark.h>

#include "core/localize/localizer.h"
#include "tests/daemon/sample_map.h"
#include "tests/map/synthetic_map.h"

namespace camloc {
namespace {

constexpr int kWidth = 640, kHeight = 480;
constexpr std::uint64_t kNumFrames = 60;

struct Bench {
  Bench() : camera(sample_camera(kWidth, kHeight)) {
    const std::string path = folder.file("map.cmap");
    testing::SampleMapOptions options{.width = kWidth, .height = kHeight, .num_frames = kNumFrames, .step = 3, .datum = {}};
    if (testing::write_sample_map(options, path).is_ok()) map.emplace(MapView::open(path).value());
    const SampleRoom room;
    for (std::uint64_t i = 1; i < kNumFrames; i += 2) {
      FrameBuffer& frame = frames.emplace_back();
      room.render(camera, sample_pose(i), &frame);
      frame.sequence = i;
    }
  }
  testing::TemporaryFolder folder;
  RgbdCamera camera;
  std::optional<MapView> map;
  std::vector<FrameBuffer> frames;
};

const Bench& bench() {
  static const Bench made;
  return made;
}

/// Frames back and forth along the path, so that tracking never meets a jump.
void localize(benchmark::State& state, const LocalizerOptions& options) {
  Localizer localizer(*bench().map, bench().camera, options);
  const std::size_t last = bench().frames.size() - 1;
  std::uint64_t step = 0, num_localized = 0;
  for (auto _ : state) {
    const std::size_t at = step % (2 * last);
    Frame frame = bench().frames[at <= last ? at : 2 * last - at].view();
    frame.sequence = ++step;
    frame.stamp_ns = static_cast<std::int64_t>(step) * 66'666'667;
    num_localized += localizer.process(frame).state == State::kLocalized ? 1 : 0;
  }
  state.counters["localized"] = static_cast<double>(num_localized) / static_cast<double>(std::max<std::uint64_t>(step, 1));
}

void Track(benchmark::State& state) { localize(state, {}); }
BENCHMARK(Track)->Unit(benchmark::kMillisecond);

void Single(benchmark::State& state) { localize(state, {.orb = {}, .use_tracking = false}); }
BENCHMARK(Single)->Unit(benchmark::kMillisecond);

void SingleWithoutDepth(benchmark::State& state) { localize(state, {.orb = {}, .use_tracking = false, .use_depth = false}); }
BENCHMARK(SingleWithoutDepth)->Unit(benchmark::kMillisecond);

/// The most work a frame can ask for: tracking fails, then the whole map is searched in vain.
void AnotherPlace(benchmark::State& state) {
  Localizer localizer(*bench().map, bench().camera, {});
  FrameBuffer mirrored = bench().frames[7];
  for (int y = 0; y < kHeight; ++y) std::reverse(mirrored.gray.row(y), mirrored.gray.row(y) + kWidth);
  std::uint64_t num_localized = 0, step = 0;
  for (auto _ : state) {
    Frame frame = mirrored.view();
    frame.stamp_ns = static_cast<std::int64_t>(++step) * 33'333'333;
    num_localized += localizer.process(frame).state == State::kLocalized ? 1 : 0;
  }
  state.counters["localized"] = static_cast<double>(num_localized) / static_cast<double>(std::max<std::uint64_t>(step, 1));
}
BENCHMARK(AnotherPlace)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace camloc
