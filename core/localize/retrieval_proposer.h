// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The camera is at a place that was mapped in views that look alike: visual words, over the whole map.
#pragma once

#include "core/localize/place_grouping.h"
#include "core/map/retrieval.h"

namespace camloc {

class RetrievalProposer final : public Proposer {
 public:
  explicit RetrievalProposer(const ProposerContext& context)
      : numbers_(context.numbers), retriever_(*context.map, context.max_features), grouping_(context) {}
  [[nodiscard]] std::span<const Proposal> propose(const ProposerInput& input) override {
    grouping_.clear();
    for (const RankedKeyframe& alike : retriever_.retrieve(input.view->features.descriptors, numbers_->num_retrieved))
      grouping_.add(alike.keyframe);
    return grouping_.places();
  }

 private:
  const LocalizerNumbers* numbers_;
  Retriever retriever_;
  PlaceGrouping grouping_;
};

}  // namespace camloc
