// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Where could the camera be? Each proposer knows one way to ask: the motion so far, what somebody said, what the image looks like. A
// proposal is a place to look and nothing more; solving, verification and the gate are the same for all. A new one is a file with a
// class and a line in the table of proposers.cc.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>

#include "core/geometry/camera.h"
#include "core/localize/coarse_hint.h"
#include "core/localize/gate.h"
#include "core/localize/localizer_numbers.h"
#include "core/localize/pose_hint.h"
#include "core/map/map_view.h"
#include "core/registration/frame_features.h"

namespace camloc {

/// A predicted pose, or mapped views of one place.
struct Proposal {
  static constexpr int kMaxKeyframes = 16;

  Rigid3 T_map_camera;  ///< used where there are no keyframes
  float radius_px = 0;  ///< how far from there landmarks may be in the image
  std::array<std::uint32_t, kMaxKeyframes> keyframes{};
  int num_keyframes = 0;
  bool is_continuation = false;   ///< follows from the last pose: what is found there is tracked, no jump
  bool overrides_motion = false;  ///< who says so knows better than the motion so far

  [[nodiscard]] std::span<const std::uint32_t> places() const {
    return std::span(keyframes).first(static_cast<std::size_t>(num_keyframes));
  }
};

/// The frame at hand.
struct ProposerInput {
  std::int64_t stamp_ns = 0;
  const FrameFeatures* view = nullptr;
  const Gate* gate = nullptr;  ///< what is known from the frames before
};

/// What proposers are made from; all of it outlives them.
struct ProposerContext {
  const MapView* map = nullptr;
  const RgbdCamera* camera = nullptr;
  const LocalizerNumbers* numbers = nullptr;
  int max_features = 0;
};

/// Not thread-safe. Allocates at construction only; the same calls give the same proposals.
class Proposer {
 public:
  virtual ~Proposer() = default;
  /// Places to look at for this frame, most promising first; at most LocalizerNumbers::max_places count. Valid until the next call.
  [[nodiscard]] virtual std::span<const Proposal> propose(const ProposerInput& input) = 0;
  /// Its places are weighed together with those of the proposer before it, which was asked for the same frame: each is a rival of the
  /// others. Without a better one than those, it has said nothing.
  [[nodiscard]] virtual bool joins_earlier() const { return false; }
  /// A proposal of the last propose() became the pose.
  virtual void on_accepted() {}
  /// Somebody says where the camera is.
  virtual void on_hint(const PoseHint&) {}
  /// Somebody has looked at a frame and says roughly where it was taken.
  virtual void on_coarse(const CoarseHint&) {}
};

struct ProposerEntry {
  const char* name;
  std::unique_ptr<Proposer> (*make)(const ProposerContext& context);
};

/// In the order in which they are asked: cheapest first.
[[nodiscard]] std::span<const ProposerEntry> proposer_table();

}  // namespace camloc
