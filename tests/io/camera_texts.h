// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Texts of camera files, read, and what is expected of those that cannot be.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "core/io/camera_file.h"

namespace camloc {

inline RgbdCamera parsed(const std::string& text, std::vector<std::string>* notes = nullptr) {
  const auto camera = parse_camera(text, "dir/camera", {0, 0, notes});
  EXPECT_TRUE(camera.is_ok()) << camera.status().message();
  return camera ? *camera : RgbdCamera{};
}

inline void expect_error(const std::string& text, const std::string& part) {
  const auto camera = parse_camera(text, "dir/camera");
  ASSERT_FALSE(camera.is_ok()) << text;
  EXPECT_NE(camera.status().message().find(part), std::string::npos) << camera.status().message();
  EXPECT_EQ(camera.status().message().find('\n'), std::string::npos);
}

}  // namespace camloc
