// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Arbitrary text as the index of a recording, as its poses, as a frame selection and as a URL. The first byte chooses.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "core/io/sequence.h"
#include "drivers/source_url.h"
#include "tests/fuzz/scratch_folder.h"

namespace {

void require(bool condition) {
  if (!condition) std::abort();
}

/// The scratch folder with images to refer to.
class Scratch : public camloc::fuzz::ScratchFolder {
 public:
  Scratch() {
    for (const char* file : {"a", "b", "c", "frame-000000.color.png"}) write(file, "x");
  }
};

void check_status(const camloc::Status& status) { require(status.message().find('\n') == std::string::npos); }

void read_index(const Scratch& scratch, const std::string& text) {
  scratch.write("rgb.txt", text);
  scratch.write("depth.txt", text);
  scratch.write("groundtruth.txt", "1 0 0 0 0 0 0 1\n2 0 0 0 0 0 0 1\n");
  const auto sequence = camloc::read_sequence(scratch.path());
  check_status(sequence.status());
  if (!sequence) return;
  require(!sequence->frames.empty());
  for (std::size_t i = 1; i < sequence->frames.size(); ++i) require(sequence->frames[i].stamp_ns > sequence->frames[i - 1].stamp_ns);
  const auto poses = camloc::read_embedded_poses(*sequence);
  require(poses.is_ok() && poses->size() == sequence->frames.size());
}

void read_trajectory(const Scratch& scratch, const std::string& text) {
  scratch.write("t.tum", text);
  const auto trajectory = camloc::read_tum_trajectory(scratch.path() + "/t.tum");
  check_status(trajectory.status());
  if (!trajectory) return;
  for (const camloc::StampedPose& pose : *trajectory) {
    require(pose.T_world_camera.translation.allFinite());
    require(camloc::pose_at(*trajectory, pose.stamp_ns).has_value());
    (void)camloc::pose_at(*trajectory, pose.stamp_ns / 2);
  }
}

void read_matrix(const Scratch& scratch, const std::string& text) {
  scratch.remove("rgb.txt");
  scratch.write("frame-000000.pose.txt", text);
  const auto sequence = camloc::read_sequence(scratch.path());
  require(sequence.is_ok() && sequence->frames.size() == 1);
  const auto poses = camloc::read_embedded_poses(*sequence);
  check_status(poses.status());
  if (poses && (*poses)[0]) require(std::abs((*poses)[0]->rotation.norm() - 1) < 1e-9);
}

void read_selection(const std::string& text) {
  const auto selection = camloc::select_frames(text, "::3", 50);
  check_status(selection.status());
  if (selection)
    for (const std::size_t index : *selection) require(index < 50 && index % 3 != 0);
  const auto url = camloc::parse_source_url(text);
  if (url) (void)url->number_option("speed", 0, 0, 1);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Scratch scratch;
  if (size == 0) return 0;
  const std::string text(reinterpret_cast<const char*>(data) + 1, size - 1);
  switch (data[0]) {
    case 'm': read_matrix(scratch, text); break;
    case 't': read_trajectory(scratch, text); break;
    case 's': read_selection(text); break;
    default: read_index(scratch, text); break;
  }
  return 0;
}
