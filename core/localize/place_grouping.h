// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Mapped views of the same corner of the building, as one place to look at.
#pragma once

#include <vector>

#include "core/localize/proposer.h"

namespace camloc {

class PlaceGrouping {
 public:
  explicit PlaceGrouping(const ProposerContext& context);
  void clear() { places_.clear(); }
  /// To the first place whose first view is near and looks the same way, or a new one; ignored when there are enough of both.
  void add(std::uint32_t keyframe);
  [[nodiscard]] std::span<Proposal> places() { return places_; }

 private:
  const MapView* map_;
  const LocalizerNumbers* numbers_;
  std::vector<Proposal> places_;
};

}  // namespace camloc
