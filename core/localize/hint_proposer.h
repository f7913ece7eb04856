// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The camera is where somebody says it is. A hint is looked at first until it led to a pose or is too old; what was mapped near it and
// in its direction is searched. It may contradict the motion so far, and it is verified like anything else.
#pragma once

#include <optional>
#include <vector>

#include "core/localize/place_grouping.h"

namespace camloc {

class HintProposer final : public Proposer {
 public:
  explicit HintProposer(const ProposerContext& context);
  [[nodiscard]] std::span<const Proposal> propose(const ProposerInput& input) override;
  void on_accepted() override { hint_.reset(); }
  void on_hint(const PoseHint& hint) override;

 private:
  struct NearKeyframe {
    double distance_m;
    std::uint32_t keyframe;
  };
  const MapView* map_;
  std::optional<PoseHint> hint_;
  std::optional<std::int64_t> first_tried_ns_;
  std::vector<NearKeyframe> near_;
  PlaceGrouping grouping_;
};

}  // namespace camloc
