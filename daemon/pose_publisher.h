// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Localizations out over LCM. Messages are built and encoded in memory that is there from the start: nothing is allocated
// per frame.
#pragma once

#include <lcm/lcm.h>

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "bot_core/pose_t.hpp"
#include "camloc/pose_t.hpp"
#include "camloc/status_t.hpp"
#include "core/base/result.h"
#include "core/geometry/wcs.h"
#include "core/localize/localization.h"

namespace camloc {

struct PublishOptions {
  std::string lcm_url;
  std::string pose_channel;
  std::string status_channel;
  std::string bot_core_channel;  ///< empty: not published
};

/// What a message says beside the localization itself.
struct PoseContext {
  std::uint64_t map_id = 0;
  const WcsDatum* datum = nullptr;  ///< set: poses are published in `wcs`
  std::uint32_t reset_offset = 0;   ///< resets before the current localizer
  /// Added to a capture stamp it gives nanoseconds since the epoch: 0 for recordings, whose stamps are that by convention.
  std::int64_t stamp_to_epoch_ns = 0;
  std::int64_t now_epoch_ns = 0;
  bool is_capture_clock_ours = true;  ///< false for recordings: their age means nothing
};

/// Without a pose: position zero, orientation identity and a covariance so large (1e6 m^2, rad^2) that no filter will
/// believe it. Numbers that do not fit their field are clipped.
void fill_pose(const Localization& localization, const PoseContext& context, pose_t* message);
/// Pose and capture time only; velocities are zero.
void fill_bot_core(const pose_t& pose, bot_core::pose_t* message);

/// Belongs to one thread.
class PosePublisher {
 public:
  explicit PosePublisher(const PublishOptions& options);

  /// Errors: kUnavailable, try again later: no multicast route yet, or LCM refused. Does nothing once connected.
  [[nodiscard]] Status connect();
  [[nodiscard]] bool is_connected() const { return lcm_ != nullptr; }

  /// pose_t always, bot_core.pose_t when LOCALIZED. False when it could not be sent (also while not connected).
  bool publish(const Localization& localization, const PoseContext& context);
  bool publish(const status_t& status);
  [[nodiscard]] std::uint64_t num_poses_published() const { return num_poses_; }

 private:
  struct LcmDelete {
    void operator()(lcm_t* lcm) const { lcm_destroy(lcm); }
  };
  template <typename Message>
  bool send(const std::string& channel, const Message& message);

  PublishOptions options_;
  std::unique_ptr<lcm_t, LcmDelete> lcm_;
  pose_t pose_;
  bot_core::pose_t bot_core_pose_;
  std::array<std::uint8_t, 4096> buffer_;
  std::uint64_t num_poses_ = 0;
};

}  // namespace camloc
