// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Greedy with lazy evaluation (Minoux, "Accelerated greedy algorithms for maximizing submodular set functions", 1978): gains
// only shrink, so the best of the queue is recomputed and goes back when another one is better now.
#include "core/mapmaking/landmark_budget.h"

#include <algorithm>
#include <cmath>
#include <queue>

namespace camloc {
namespace {

constexpr double kMinObservations = 2;          // landmarks with fewer are taken only for views that need them
constexpr std::uint32_t kWantedPerView = 1000;  // a landmark all of whose views have this many is not needed
constexpr std::uint32_t kMinPerView = 60;       // a view with fewer needs every landmark it can get

struct CandidateLandmark {
  double gain;
  std::uint32_t landmark;
  bool operator<(const CandidateLandmark& other) const { return gain != other.gain ? gain < other.gain : landmark > other.landmark; }
};

class Selector {
 public:
  Selector(std::span<const std::vector<ViewObservation>> views, std::size_t num_landmarks, std::span<const float> worth)
      : first_bin_(num_landmarks + 1, 0),
        count_of_bin_(views.size() * kNumCells, 0),
        count_of_view_(views.size(), 0),
        is_kept_(num_landmarks, 0),
        worth_(worth) {
    for (const auto& view : views) {
      for (const ViewObservation& o : view) ++first_bin_[o.landmark + 1];
    }
    for (std::size_t i = 0; i < num_landmarks; ++i) first_bin_[i + 1] += first_bin_[i];
    bins_.resize(first_bin_.back());
    std::vector<std::size_t> next(first_bin_.begin(), first_bin_.end() - 1);
    for (std::size_t v = 0; v < views.size(); ++v) {
      for (const ViewObservation& o : views[v]) bins_[next[o.landmark]++] = static_cast<std::uint32_t>(v * kNumCells + o.cell);
    }
  }

  /// Greedy over the landmarks with at least `min_observations` that some view with fewer than `wanted` still needs.
  void take(double min_observations, std::uint32_t wanted, std::uint32_t max_landmarks) {
    std::priority_queue<CandidateLandmark> queue;
    for (std::uint32_t i = 0; i < is_kept_.size(); ++i) {
      if (is_kept_[i] == 0 && num_observations(i) >= min_observations) queue.push({gain(i), i});
    }
    while (!queue.empty() && (max_landmarks == 0 || num_kept_ < max_landmarks)) {
      CandidateLandmark top = queue.top();
      queue.pop();
      if (!is_needed(top.landmark, wanted)) continue;  // counts only grow: never needed again
      top.gain = gain(top.landmark);
      if (!queue.empty() && top < queue.top()) {
        queue.push(top);
      } else {
        keep(top.landmark);
      }
    }
  }

  [[nodiscard]] std::vector<std::uint32_t> kept() const {
    std::vector<std::uint32_t> result;
    for (std::uint32_t i = 0; i < is_kept_.size(); ++i) {
      if (is_kept_[i] != 0) result.push_back(i);
    }
    return result;
  }

 private:
  [[nodiscard]] std::span<const std::uint32_t> bins_of(std::uint32_t landmark) const {
    return std::span(bins_).subspan(first_bin_[landmark], first_bin_[landmark + 1] - first_bin_[landmark]);
  }
  [[nodiscard]] double num_observations(std::uint32_t landmark) const {
    return worth_.empty() ? static_cast<double>(bins_of(landmark).size()) : static_cast<double>(worth_[landmark]);
  }
  [[nodiscard]] double gain(std::uint32_t landmark) const {
    double sum = 0;
    for (const std::uint32_t bin : bins_of(landmark))
      sum += std::sqrt(count_of_bin_[bin] + 1.0) - std::sqrt(static_cast<double>(count_of_bin_[bin]));
    return worth_.empty() || sum == 0 ? sum : sum * num_observations(landmark) / static_cast<double>(bins_of(landmark).size());
  }
  [[nodiscard]] bool is_needed(std::uint32_t landmark, std::uint32_t wanted) const {
    const auto bins = bins_of(landmark);
    return std::any_of(bins.begin(), bins.end(), [&](std::uint32_t bin) { return count_of_view_[bin / kNumCells] < wanted; });
  }
  void keep(std::uint32_t landmark) {
    is_kept_[landmark] = 1;
    ++num_kept_;
    for (const std::uint32_t bin : bins_of(landmark)) {
      ++count_of_bin_[bin];
      ++count_of_view_[bin / kNumCells];
    }
  }

  std::vector<std::size_t> first_bin_;  ///< per landmark, into bins_
  std::vector<std::uint32_t> bins_;     ///< (view, cell) of each observation, grouped by landmark
  std::vector<std::uint32_t> count_of_bin_, count_of_view_;
  std::vector<std::uint8_t> is_kept_;
  std::span<const float> worth_;
  std::uint32_t num_kept_ = 0;
};

}  // namespace

std::vector<std::uint32_t> select_landmarks(std::span<const std::vector<ViewObservation>> views, std::size_t num_landmarks,
                                            std::uint32_t max_landmarks, std::span<const float> worth) {
  Selector selector(views, num_landmarks, worth);
  selector.take(kMinObservations, kWantedPerView, max_landmarks);
  selector.take(1, kMinPerView, max_landmarks);
  return selector.kept();
}

}  // namespace camloc
