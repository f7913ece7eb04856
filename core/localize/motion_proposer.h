// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The camera is where its motion has carried it since the last verified pose.
#pragma once

#include "core/localize/proposer.h"

namespace camloc {

class MotionProposer final : public Proposer {
 public:
  explicit MotionProposer(const ProposerContext& context) : focal_px_(context.camera->color.mean_focal_px()) {}
  /// One pose, or none when the last one is too long ago.
  [[nodiscard]] std::span<const Proposal> propose(const ProposerInput& input) override;

 private:
  double focal_px_;
  Proposal proposal_;
};

}  // namespace camloc
