// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Arbitrary text as a camera file: a valid camera that is written and read back, or an error in one line.
#include <cstdint>
#include <cstdlib>
#include <string>

#include "core/io/camera_file.h"

namespace {

void require(bool condition) {
  if (!condition) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  const camloc::Result<camloc::RgbdCamera> camera = camloc::parse_camera(text, "fuzz");
  if (!camera) {
    require(camera.status().message().find('\n') == std::string::npos);
    return 0;
  }
  require(camera->validate().is_ok());
  // A YAML name may hold any bytes, TOML only UTF-8.
  camloc::RgbdCamera named = *camera;
  named.name = "fuzz";
  const camloc::Result<camloc::RgbdCamera> again = camloc::parse_camera(camloc::format_camera_toml(named), "again");
  require(again.is_ok() && again->color.fx == named.color.fx && again->color.distortion == named.color.distortion &&
          again->depth_unit_m == named.depth_unit_m);
  return 0;
}
