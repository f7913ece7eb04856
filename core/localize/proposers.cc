// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The table of proposers. A new one adds its line here and nothing else.
#include "core/localize/coarse_proposer.h"
#include "core/localize/hint_proposer.h"
#include "core/localize/motion_proposer.h"
#include "core/localize/retrieval_proposer.h"

namespace camloc {
namespace {

template <typename T>
std::unique_ptr<Proposer> make(const ProposerContext& context) {
  return std::make_unique<T>(context);
}

constexpr ProposerEntry kProposers[] = {
    {"hint", make<HintProposer>},
    {"motion", make<MotionProposer>},
    {"retrieval", make<RetrievalProposer>},
    {"coarse", make<CoarseProposer>},
};

}  // namespace

std::span<const ProposerEntry> proposer_table() { return kProposers; }

}  // namespace camloc
