// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What the daemon's coarse worker does, without its thread: the same frames give the same hints.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "core/base/frame.h"
#include "core/coarse/coarse_network.h"
#include "core/localize/localizer.h"

namespace camloc::tools {

/// A network that is asked about lost frames, once a frame however many localizers lost it. Not thread-safe.
class CoarseAsking {
 public:
  /// Reads the model and loads its network. Errors: those of read_coarse_model, check_coarse_map and CoarseNetwork::load.
  [[nodiscard]] static Result<std::unique_ptr<CoarseAsking>> open(const std::string& model_path, const MapView& map,
                                                                  const RgbdCamera& camera);

  /// localizer.process(frame). Where that is lost, the network's answer is there with the next frame, as if it had taken one frame.
  const Localization& process(const Frame& frame, Localizer* localizer);
  /// The same for a frame on its own: the answer is there at once.
  const Localization& process_single(const Frame& frame, Localizer* localizer);

 private:
  explicit CoarseAsking(CoarseNetwork network) : network_(std::move(network)) {}
  void ask(const Frame& frame, Localizer* localizer);

  CoarseNetwork network_;
  std::optional<std::uint64_t> asked_;  ///< the frame that hint_ is for
  std::optional<CoarseHint> hint_;
};

}  // namespace camloc::tools
