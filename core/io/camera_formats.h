// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The two parsers behind camera_file.h, for its use only. Neither lets an exception out; neither checks more than that
// the keys are there and have the right type.
#pragma once

#include <string>

#include "core/base/result.h"
#include "core/geometry/camera.h"

namespace camloc {

[[nodiscard]] Result<RgbdCamera> parse_camera_toml(const std::string& text, const std::string& name);
[[nodiscard]] Result<RgbdCamera> parse_camera_yaml(const std::string& text, const std::string& name);

}  // namespace camloc
