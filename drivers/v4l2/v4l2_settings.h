// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What a v4l2:// URL asks for.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "core/base/result.h"
#include "core/geometry/camera.h"
#include "drivers/frame_source.h"
#include "drivers/source_url.h"
#include "drivers/v4l2/v4l2_negotiation.h"

namespace camloc {

/// One node and what is wanted of it.
struct V4l2NodeSettings {
  std::string node;  ///< path, link, or "serial:XXXX"; empty: not wanted
  V4l2Wish wish;
  std::map<std::string, std::string> controls;
};

struct V4l2Settings {
  V4l2NodeSettings image;  ///< the node of the URL's path; may turn out to be the only one and to give depth
  V4l2NodeSettings depth;
  std::optional<unsigned> gray_bits;  ///< significant bits of infrared pixels where the format does not say
  std::int64_t stamp_offset_ns = 0;
  std::optional<RgbdCamera> camera;
};

/// kInvalid names the option and what it takes; errors of the camera file as read_camera_file().
[[nodiscard]] Result<V4l2Settings> parse_v4l2_settings(const SourceUrl& url, const FrameSourceOptions& options);

}  // namespace camloc
