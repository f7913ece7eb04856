// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Opening a map of the size of a flat, and finding the keyframes for an image in it. The counters of Open are bytes a
// landmark, by section.
#include <benchmark/benchmark.h>

#include "core/map/map_view.h"
#include "core/map/map_writer.h"
#include "core/map/retrieval.h"
#include "tests/map/synthetic_map.h"

namespace camloc {
namespace {

/// 30k landmarks with 1.1 descriptors each, 60 keyframes with 800 landmarks, 1024 words.
const MapData& flat() {
  static const MapData map = testing::make_synthetic_map({.num_landmarks = 30000,
                                                          .num_keyframes = 60,
                                                          .landmarks_per_keyframe = 800,
                                                          .num_words = 1024,
                                                          .extra_descriptors_percent = 10,
                                                          .side_m = 12});
  return map;
}

void report_sizes(std::span<const std::byte> bytes, benchmark::State* state) {
  const double num_landmarks = static_cast<double>(flat().landmarks.size());
  for (std::uint32_t i = 0; i < map_format::kNumCoreSections; ++i) {
    const auto record = testing::section_record(bytes, static_cast<map_format::SectionId>(i));
    const auto section_bytes = static_cast<double>(record.num_elements * record.element_bytes);
    state->counters[known_sections()[i].name] = section_bytes / num_landmarks;
  }
  state->counters["total"] = static_cast<double>(bytes.size()) / num_landmarks;
}

void Open(benchmark::State& state) {
  const testing::TemporaryFolder folder;
  const std::string path = folder.file("map.cmap");
  const auto bytes = serialize_map(flat());
  testing::write_bytes(path, *bytes);
  for (auto _ : state) {
    const Result<MapView> view = MapView::open(path);
    if (!view.is_ok()) state.SkipWithError(view.status().message().c_str());
    benchmark::DoNotOptimize(view);
  }
  report_sizes(*bytes, &state);
}
BENCHMARK(Open)->Unit(benchmark::kMillisecond);

void Retrieve(benchmark::State& state) {
  const testing::TemporaryFolder folder;
  const std::string path = folder.file("map.cmap");
  static_cast<void>(write_map(flat(), path));
  const Result<MapView> view = MapView::open(path);
  Retriever retriever(*view, 1000);
  std::vector<Descriptor> image;
  testing::Random random(3);
  for (int i = 0; i < 1000; ++i) image.push_back(random.noisy(flat().words[random.below(1024)], 40));
  for (auto _ : state) benchmark::DoNotOptimize(retriever.retrieve(image, 10).data());
}
BENCHMARK(Retrieve)->Unit(benchmark::kMicrosecond);

void UnpackKeyframe(benchmark::State& state) {
  const testing::TemporaryFolder folder;
  const std::string path = folder.file("map.cmap");
  static_cast<void>(write_map(flat(), path));
  const Result<MapView> view = MapView::open(path);
  std::vector<std::uint32_t> landmarks(view->info().max_keyframe_landmarks);
  std::uint32_t keyframe = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(view->keyframe_landmarks(keyframe, landmarks));
    keyframe = (keyframe + 1) % view->info().num_keyframes;
  }
}
BENCHMARK(UnpackKeyframe)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace camloc
