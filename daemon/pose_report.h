// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What camlocd knows about a frame and about itself, as plain values: what every output and the control socket get. Units and
// frames are here; how a message on some wire names and packs them is its sink's affair.
#pragma once

#include <cstdint>
#include <string>

#include "core/geometry/wcs.h"
#include "core/localize/localization.h"

namespace camloc {

/// One for every frame, whatever its state.
struct PoseReport {
  Localization localization;          ///< as it came: in the map, with the capture clock's stamp
  std::int64_t capture_epoch_ns = 0;  ///< of the exposure, since the epoch
  std::int64_t age_ns = -1;           ///< from the exposure to now; -1 where the capture clock is not this machine's
  std::uint64_t map_id = 0;           ///< 0 without a map
  const char* parent_frame = "map";   ///< or "wcs"
  /// The camera in the parent frame. Without a pose: identity, with a covariance so large (1e6 m^2, rad^2) that no filter will
  /// believe it.
  PoseWithCovariance T_parent_camera;
  int quality = -1;                 ///< 0..100, -1 without a pose
  std::uint64_t reset_counter = 0;  ///< grows whenever the pose may have jumped
};

/// Brought up to date once a second and on every change of state. Counts are since the start of the daemon.
struct DaemonStatus {
  std::int64_t written_epoch_us = 0, uptime_us = 0;
  State state = State::kNoCamera;
  std::string state_text;  ///< one line for people
  std::string source;      ///< URL
  std::string map_path;
  std::uint64_t map_id = 0;  ///< 0 without a map
  std::int64_t frames_received = 0;
  std::int64_t frames_dropped = 0;  ///< replaced in the mailbox by a newer one before they were looked at
  std::int64_t frames_corrupt = 0;
  std::int64_t frames_localized = 0;
  std::int64_t poses_published = 0;
  std::int64_t reset_counter = 0;
  std::int64_t map_reloads = 0, map_reload_failures = 0;
  const char* camera_state = "none";  ///< see to_string(CapturePhase); none without a source
  std::int64_t camera_stalls = 0, stream_restarts = 0, device_reopens = 0, device_resets = 0;
  double last_recovery_ms = 0;
  std::int64_t packets_lost = 0, frames_incomplete = 0, frames_unpaired = 0;  ///< of the camera since it was last opened
  double clock_drift_ppm = 0;
  double frame_rate_hz = 0, latency_p50_ms = 0, latency_max_ms = 0;  ///< over the last second
  std::int64_t rss_bytes = 0;
  const char* coarse_state = "off";  ///< of the neural network: off, or see to_string(CoarsePhase)
  std::int64_t coarse_answers = 0;   ///< of it since the map was opened
  std::int64_t fixes_by_hint = 0, fixes_by_retrieval = 0, fixes_by_coarse = 0;  ///< poses that were not tracked: who said where to look
  std::int64_t log_lines_lost = 0;  ///< nobody read them, or the disk is full; the control socket alone tells
  bool is_calibration_suspect = false;
  double focal_scale = 1;  ///< true / assumed focal length
};

/// What a report says beside the localization itself.
struct PoseContext {
  std::uint64_t map_id = 0;
  const WcsDatum* datum = nullptr;  ///< set: poses are reported in `wcs`
  std::uint32_t reset_offset = 0;   ///< resets before the current localizer
  /// Added to a capture stamp it gives nanoseconds since the epoch: 0 for recordings, whose stamps are that by convention.
  std::int64_t stamp_to_epoch_ns = 0;
  std::int64_t now_epoch_ns = 0;
  bool is_capture_clock_ours = true;  ///< false for recordings: their age means nothing
};

[[nodiscard]] PoseReport make_pose_report(const Localization& localization, const PoseContext& context);

}  // namespace camloc
