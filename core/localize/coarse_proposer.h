// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The camera is roughly where a neural network says (CoarseHint). It is decimetres or metres off, too far to look for landmarks by
// projection: what was mapped in that neighbourhood, and in about that direction, is searched instead, as for a view that looks alike.
// Its places are weighed together with those of retrieval, which is asked before: where two of them explain the view, none is believed.
#pragma once

#include <optional>
#include <vector>

#include "core/localize/place_grouping.h"

namespace camloc {

class CoarseProposer final : public Proposer {
 public:
  explicit CoarseProposer(const ProposerContext& context);
  [[nodiscard]] std::span<const Proposal> propose(const ProposerInput& input) override;
  [[nodiscard]] bool joins_earlier() const override { return true; }
  void on_accepted() override { hint_.reset(); }
  void on_coarse(const CoarseHint& hint) override { hint_ = hint; }

 private:
  struct NearKeyframe {
    double squared_distance;  ///< in standard deviations
    std::uint32_t keyframe;
  };
  const MapView* map_;
  std::optional<CoarseHint> hint_;
  std::vector<NearKeyframe> near_;
  PlaceGrouping grouping_;
};

}  // namespace camloc
