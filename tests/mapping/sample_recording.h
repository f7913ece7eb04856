// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A recording of the generated room of sample:// whose map is SampleWorld's.
#pragma once

#include <string>

#include "core/io/camera_file.h"
#include "core/io/image_writer.h"
#include "tests/localize/sample_world.h"
#include "tests/tools/command_runner.h"
#include "tools/common/text_format.h"

namespace camloc::mapping {

/// The first frames of the room's path as a TUM folder, and its camera file.
struct SampleRecording {
  explicit SampleRecording(std::uint64_t count) {
    const testing::SampleWorld& world = testing::SampleWorld::get();
    std::string rgb, depth;
    for (std::uint64_t i = 0; i < count; ++i) {
      const FrameBuffer frame = world.frame(i);
      const std::string stamp = tools::text_of("%.4f", static_cast<double>(frame.stamp_ns) * 1e-9), name = std::to_string(i) + ".png";
      EXPECT_TRUE(write_png(folder / ("rgb" + name), frame.gray).is_ok());
      EXPECT_TRUE(write_depth_png(folder / ("depth" + name), frame.depth).is_ok());
      rgb += stamp + " rgb" + name + "\n";
      depth += stamp + " depth" + name + "\n";
    }
    static_cast<void>(folder.write("rgb.txt", rgb));
    static_cast<void>(folder.write("depth.txt", depth));
    camera_path = folder.write("camera.toml", format_camera_toml(world.camera()));
  }
  tools::TemporaryFolder folder;
  std::string camera_path;
};

}  // namespace camloc::mapping
