// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A map of the room that sample:// shows, made from its own frames and poses: a few hundred kilobytes in a second.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "core/base/result.h"
#include "core/map/map_writer.h"
#include "core/mapmaking/map_builder.h"
#include "drivers/frame_source.h"
#include "drivers/sample_source.h"

namespace camloc::testing {

struct SampleMapOptions {
  int width = 320, height = 240;
  std::uint64_t num_frames = 150;
  std::uint64_t step = 3;
  std::optional<WcsDatum> datum;
};

inline std::string sample_url(const SampleMapOptions& options, const std::string& rest) {
  return "sample://?width=" + std::to_string(options.width) + "&height=" + std::to_string(options.height) + "&" + rest;
}

inline Status write_sample_map(const SampleMapOptions& options, const std::string& path) {
  const RgbdCamera camera = sample_camera(options.width, options.height);
  MapBuilder builder(camera, MapBuildOptions{});
  const SampleRoom room;
  FrameBuffer buffer;
  for (std::uint64_t i = 0; i < options.num_frames; i += options.step) {
    room.render(camera, sample_pose(i), &buffer);
    if (const Status status = builder.add_frame(buffer.view(), sample_pose(i)); !status) return status;
  }
  MapBuildReport report;
  Result<MapData> map = builder.finish(&report);
  if (!map) return map.status();
  map->name = "sample room";
  map->wcs = options.datum;
  return write_map(*map, path);
}

}  // namespace camloc::testing
