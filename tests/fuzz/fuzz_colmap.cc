// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Arbitrary text as one file of a COLMAP model beside two good ones; the first byte says which. A model that was read is
// consistent and survives being written; an error is one line.
#include <cstdint>
#include <cstdlib>
#include <string>

#include "tests/fuzz/scratch_folder.h"
#include "tools/mapping/colmap/colmap_model.h"

namespace {

using camloc::fuzz::ScratchFolder;
using camloc::mapping::ColmapModel;

void require(bool condition) {
  if (!condition) std::abort();
}

void check_consistent(const ColmapModel& model) {
  require(!model.cameras.empty() && !model.images.empty());
  for (const auto& image : model.images) {
    require(!image.name.empty() && std::abs(image.T_camera_world.rotation.norm() - 1) < 1e-9 &&
            image.T_camera_world.translation.allFinite());
    for (const auto& seen : image.observations) require(seen.point < model.points.size());
  }
  for (const auto& point : model.points) require(point.position.allFinite());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const ScratchFolder scratch;
  if (size == 0) return 0;
  const std::string text(reinterpret_cast<const char*>(data) + 1, size - 1);
  scratch.write("cameras.txt", data[0] == 'c' ? text : "1 PINHOLE 640 480 500 500 320 240\n");
  scratch.write("points3D.txt", data[0] == 'p' ? text : "5 1 2 3 10 20 30 0.5 1 0\n6 1 2 3 10 20 30 0.5\n");
  scratch.write("images.txt", data[0] == 'i' ? text : "1 1 0 0 0 0 0 0 1 a.png\n1 2 5\n");
  const auto model = camloc::mapping::read_colmap_model(scratch.path());
  require(model.status().message().find('\n') == std::string::npos);
  if (!model) return 0;
  check_consistent(*model);
  require(camloc::mapping::write_colmap_model(*model, scratch.path() + "/again", "fuzz").is_ok());
  const auto again = camloc::mapping::read_colmap_model(scratch.path() + "/again");
  require(again.is_ok() && again->images.size() == model->images.size() && again->points.size() == model->points.size());
  return 0;
}
