// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A short recording of the generated room of sample://, in the layout of TUM RGB-D, for the tests of map building.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>
#include <string>

#include "core/io/image_writer.h"
#include "core/slam/slam.h"
#include "drivers/sample_source.h"

namespace camloc::mapping {

constexpr int kRoomWidth = 320, kRoomHeight = 240;
constexpr std::uint64_t kRoomStride = 2;  ///< frames of the path between two of the recording

inline RgbdCamera room_camera() { return sample_camera(kRoomWidth, kRoomHeight); }

/// What there is to find in images of this size.
inline SlamOptions room_options() {
  SlamOptions options;
  options.numbers.min_segment_features = 100;
  return options;
}

inline Rigid3 room_pose(std::uint64_t frame) { return sample_pose(kRoomStride * frame); }

/// Changes an image before it is written.
using ImageChange = std::function<void(std::uint64_t frame, FrameBuffer*)>;

/// `count` frames at 15 Hz.
inline void record_room(const std::string& folder, std::uint64_t count, const ImageChange& change = {}) {
  namespace fs = std::filesystem;
  fs::create_directories(fs::path(folder) / "rgb");
  fs::create_directories(fs::path(folder) / "depth");
  const SampleRoom room;
  std::ostringstream rgb, depth;
  for (std::uint64_t frame = 0; frame < count; ++frame) {
    FrameBuffer buffer;
    room.render(room_camera(), room_pose(frame), &buffer);
    if (change) change(frame, &buffer);
    const std::string name = std::to_string(1000 + frame) + ".png";
    char stamp[32];
    std::snprintf(stamp, sizeof stamp, "%.6f", 100 + static_cast<double>(frame) / 15);
    rgb << stamp << " rgb/" << name << "\n";
    depth << stamp << " depth/" << name << "\n";
    ASSERT_TRUE(write_png(folder + "/rgb/" + name, buffer.gray).is_ok());
    ASSERT_TRUE(write_depth_png(folder + "/depth/" + name, buffer.depth).is_ok());
  }
  std::ofstream(folder + "/rgb.txt") << rgb.str();
  std::ofstream(folder + "/depth.txt") << depth.str();
}

}  // namespace camloc::mapping
