// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// First views are taken, each time the one that adds most (take_views); then those whose items the later ones all see are
// given back, in the order in which they were taken.
#include "core/mapmaking/keyframe_cover.h"

#include <algorithm>
#include <cassert>
#include <queue>

namespace camloc {
namespace {

struct CandidateView {
  std::uint32_t gain;
  std::uint32_t view;
  bool operator<(const CandidateView& other) const { return gain != other.gain ? gain < other.gain : view > other.view; }
};

std::uint32_t gain_of(const std::vector<std::uint32_t>& items, const std::vector<std::uint32_t>& times_covered) {
  return static_cast<std::uint32_t>(std::count_if(items.begin(), items.end(), [&](std::uint32_t i) { return times_covered[i] == 0; }));
}

// A gain can only shrink as views are taken, so an old gain is an upper bound: only the top of the queue is looked at again
// (Minoux, "Accelerated greedy algorithms for maximizing submodular set functions", 1978).
std::vector<std::uint32_t> take_views(std::span<const std::vector<std::uint32_t>> items_of_view, std::uint32_t min_gain,
                                      std::vector<std::uint32_t>* times_covered) {
  std::priority_queue<CandidateView> queue;
  for (std::uint32_t v = 0; v < items_of_view.size(); ++v) queue.push({static_cast<std::uint32_t>(items_of_view[v].size()), v});
  std::vector<std::uint32_t> taken;
  while (!queue.empty()) {
    CandidateView top = queue.top();
    queue.pop();
    top.gain = gain_of(items_of_view[top.view], *times_covered);
    if (top.gain < std::max(min_gain, 1U)) continue;
    if (!queue.empty() && top < queue.top()) {
      queue.push(top);
      continue;
    }
    taken.push_back(top.view);
    for (const std::uint32_t item : items_of_view[top.view]) ++(*times_covered)[item];
  }
  return taken;
}

}  // namespace

KeyframeCover cover_with_keyframes(std::span<const std::vector<std::uint32_t>> items_of_view, std::size_t num_items,
                                   std::uint32_t min_gain) {
  std::vector<std::uint32_t> times_covered(num_items, 0);
  const std::vector<std::uint32_t> taken = take_views(items_of_view, min_gain, &times_covered);
  KeyframeCover cover;
  for (const std::uint32_t view : taken) {
    const auto& items = items_of_view[view];
    if (std::all_of(items.begin(), items.end(), [&](std::uint32_t i) { return times_covered[i] >= 2; })) {
      for (const std::uint32_t item : items) --times_covered[item];
    } else {
      cover.views.push_back(view);
    }
  }
  std::sort(cover.views.begin(), cover.views.end());
  for (std::uint32_t item = 0; item < num_items; ++item) {
    if (times_covered[item] == 0) cover.uncovered.push_back(item);
  }
  return cover;
}

}  // namespace camloc
