// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/evaluation/recorded_poses.h"

#include "core/io/sequence.h"

namespace camloc::tools {

Result<RecordedPoses> read_recorded_poses(const std::string& folder, const std::string& frames,
                                          const std::optional<Rigid3>& T_color_depth) {
  auto sequence = read_sequence(folder);
  if (!sequence) return sequence.status();
  auto selected = select_frames(frames, "", sequence->frames.size());
  if (!selected) return selected.status();
  auto poses = read_embedded_poses(*sequence);
  if (!poses) return poses.status();
  RecordedPoses recorded;
  recorded.num_frames = selected->size();
  for (const std::size_t i : *selected) {
    if (!(*poses)[i]) continue;
    Rigid3 T_world_color = *(*poses)[i];
    if (T_color_depth) T_world_color = T_world_color * T_color_depth->inverse();
    recorded.poses.push_back({sequence->frames[i].stamp_ns, T_world_color});
  }
  return recorded;
}

}  // namespace camloc::tools
