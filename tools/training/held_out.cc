// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/training/held_out.h"

#include <algorithm>
#include <map>
#include <set>

#include "core/io/sequence.h"

namespace camloc::training {
namespace {

constexpr std::size_t kHeldOutShare = 10;  // one of so many

Split last_of_each(std::span<const TrainingView> views) {
  std::map<std::uint32_t, std::vector<std::size_t>> of_recording;
  for (std::size_t i = 0; i < views.size(); ++i) of_recording[views[i].recording].push_back(i);
  Split split;
  for (const auto& [recording, indices] : of_recording) {
    const auto end = indices.end() - static_cast<std::ptrdiff_t>((indices.size() + kHeldOutShare - 1) / kHeldOutShare);
    split.shown.insert(split.shown.end(), indices.begin(), end);
    split.held_out.insert(split.held_out.end(), end, indices.end());
  }
  return split;
}

}  // namespace

Result<Split> split_views(std::span<const TrainingView> views, const std::string& stretches) {
  if (stretches.empty()) return last_of_each(views);
  std::uint64_t num_frames = 0;
  for (const TrainingView& view : views) num_frames = std::max(num_frames, view.frame + 1);
  const auto chosen = select_frames(stretches, "", num_frames);
  if (!chosen) return chosen.status().with_context("--held-out");
  const std::set<std::uint64_t> is_held_out(chosen->begin(), chosen->end());
  Split split;
  for (std::size_t i = 0; i < views.size(); ++i) (is_held_out.contains(views[i].frame) ? split.held_out : split.shown).push_back(i);
  if (split.shown.empty())
    return {ErrorCode::kInvalid, "--held-out " + stretches + " keeps all frames back; nothing is left to learn from"};
  if (split.held_out.empty()) return {ErrorCode::kInvalid, "--held-out " + stretches + " keeps no frame back that has a pose"};
  return split;
}

}  // namespace camloc::training
