// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A coarse model of the sample room's map that always says the same place.
#pragma once

#include <gtest/gtest.h>
#include <stdlib.h>

#include "tests/coarse/sample_model.h"
#include "tests/localize/sample_world.h"

namespace camloc::tools {

#ifdef CAMLOC_NETWORK_PLUGIN_FILE
inline constexpr bool kHasPlugin = true;
inline void use_built_plugin() { ::setenv("CAMLOC_NETWORK_PLUGIN", CAMLOC_NETWORK_PLUGIN_FILE, 1); }
#else
inline constexpr bool kHasPlugin = false;
inline void use_built_plugin() {}
#endif

/// Writes it to `path`.
inline void write_constant_model(const std::string& path, const Rigid3& T_map_camera,
                                 std::uint64_t map_id = testing::SampleWorld::get().map().info().map_id) {
  CoarseModelInfo info = sample_coarse_info();
  info.map_id = map_id_text(map_id);
  OnnxModel model = sample_onnx(info);
  model.weights[0].values.assign(model.weights[0].values.size(), 0.0F);
  const Eigen::Vector3f p = T_map_camera.translation.cast<float>();
  const Eigen::Quaternionf q = T_map_camera.rotation.cast<float>();
  model.weights[1].values = {p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z()};
  ASSERT_TRUE(write_onnx(path, model));
}

}  // namespace camloc::tools
