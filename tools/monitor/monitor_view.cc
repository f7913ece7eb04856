// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Text from a message passes printable() on its way to the terminal: whoever can send on the network must not drive it.
#include "tools/monitor/monitor_view.h"

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/base/order_statistics.h"
#include "tools/common/text_format.h"

namespace camloc::tools {
namespace {

constexpr std::array kStageNames{"extract", "candidates", "match", "estimate", "verify", "total"};

bool has_pose(const pose_t& pose) { return pose.state == pose_t::LOCALIZED || pose.state == pose_t::COASTING; }

double largest_sigma(const Eigen::Matrix3d& covariance) {
  if (!covariance.allFinite()) return std::nan("");
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance, Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0.0, solver.eigenvalues().maxCoeff()));
}

/// As camlocd's control socket writes it: JSON numbers lose the low bits of 64-bit integers.
std::string map_id_text(std::int64_t map_id) { return text_of("%016llx", llu(static_cast<std::uint64_t>(map_id))); }

std::string age_text(const pose_t& pose) { return pose.age_us < 0 ? "unknown" : text_of("%.1f ms", pose.age_us / 1e3); }

std::vector<std::string> warnings(const MonitorState& state) {
  std::vector<std::string> texts;
  if (state.seconds_since_pose > 1) texts.push_back(text_of("no pose for %.0f s", state.seconds_since_pose));
  if (!state.status) return texts;
  const status_t& status = *state.status;
  if (status.is_calibration_suspect != 0) {
    texts.push_back(
        text_of("calibration suspect: the images fit the map with %.3f times the focal length of the camera file", status.focal_scale));
  }
  if (status.frames_corrupt > 0) texts.push_back(text_of("%lld corrupt frames", static_cast<long long>(status.frames_corrupt)));
  if (status.map_reload_failures > 0) {
    texts.push_back(text_of("%lld map reloads refused, the old map is kept", static_cast<long long>(status.map_reload_failures)));
  }
  if (status.camera_state == "stalled") texts.push_back("the camera is silent; camlocd restarts it");
  if (status.camera_state == "missing") texts.push_back("the camera is not there; see 'camloc doctor'");
  return texts;
}

std::string pose_part(const MonitorState& state) {
  const pose_t& pose = *state.pose;
  std::string screen =
      "state     " + state_name(pose.state) + (pose.reason_text.empty() ? "" : "  (" + printable(pose.reason_text) + ")") + "\n";
  if (has_pose(pose)) {
    const PoseSigma sigma = pose_sigma(pose);
    screen += text_of("position  %+9.3f %+9.3f %+9.3f m in %s, sigma %.1f cm\n", pose.pos[0], pose.pos[1], pose.pos[2],
                      printable(pose.parent_frame).c_str(), 100 * sigma.position_m);
    screen += text_of("risk      %.2g that it is off by more than 25 cm or 10 deg; else within %.1f cm, %.2f deg (99.9 %%)\n",
                      pose.integrity_risk, 100 * pose.protection_m[1], degrees(pose.protection_rad[1]));
    screen += text_of("rotation  %+9.4f %+9.4f %+9.4f %+9.4f (w x y z), sigma %.2f deg\n", pose.orientation[0], pose.orientation[1],
                      pose.orientation[2], pose.orientation[3], degrees(sigma.rotation_rad));
  } else {
    screen += "position  none\nrotation  none\n";
  }
  screen += text_of("quality   %d, %d inliers of %d matches of %d features\n", static_cast<int>(pose.quality), pose.num_inliers,
                    pose.num_matches, pose.num_features);
  screen += text_of("poses     %lld, %.1f %% localized, %.1f Hz, %d resets\n", state.num_poses,
                    100.0 * static_cast<double>(state.num_localized) / static_cast<double>(std::max(1LL, state.num_poses)), state.rate_hz,
                    pose.reset_counter);
  return screen;
}

std::string latency_part(const MonitorState& state) {
  std::string names = "latency ", medians = "  p50 ms", worst = "  p99 ms";
  for (std::size_t stage = 0; stage < kStageNames.size(); ++stage) {
    const StageLatencies::Summary summary = state.latencies.of(stage);
    names += text_of(" %10s", kStageNames[stage]);
    medians += text_of(" %10.2f", summary.median_ms);
    worst += text_of(" %10.2f", summary.p99_ms);
  }
  return names + "\n" + medians + "\n" + worst + "\n" + "  capture to publishing " + age_text(*state.pose) + "\n";
}

std::string camera_part(const status_t& status) {
  const auto count = [](std::int64_t value) { return static_cast<long long>(value); };
  std::string screen = "camera    " + (status.camera_state.empty() ? "" : printable(status.camera_state) + ", ") +
                       printable(status.source) + text_of(", %.1f Hz\n", status.frame_rate_hz);
  screen += text_of("  frames  %lld received, %lld dropped, %lld corrupt, %lld incomplete, %lld unpaired, %lld packets lost\n",
                    count(status.frames_received), count(status.frames_dropped), count(status.frames_corrupt),
                    count(status.frames_incomplete), count(status.frames_unpaired), count(status.packets_lost));
  screen += text_of("  recovery %lld stalls: %lld stream restarts, %lld opened again, %lld resets", count(status.camera_stalls),
                    count(status.stream_restarts), count(status.device_reopens), count(status.device_resets));
  if (status.last_recovery_ms > 0) screen += text_of("; the last took %.0f ms", status.last_recovery_ms);
  if (status.clock_drift_ppm != 0) screen += text_of("; clock %+.1f ppm", status.clock_drift_ppm);
  return screen + "\n";
}

}  // namespace

std::string state_name(int state) {
  static constexpr std::array kNames{"NO_CAMERA", "NO_MAP", "LOST", "COARSE", "LOCALIZED", "COASTING"};
  return state >= 0 && state < static_cast<int>(kNames.size()) ? kNames[static_cast<std::size_t>(state)] : "state " + std::to_string(state);
}

PoseSigma pose_sigma(const pose_t& pose) {
  using RowMajor = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;
  const Eigen::Map<const RowMajor> covariance(&pose.covariance[0]);
  return {largest_sigma(covariance.topLeftCorner<3, 3>()), largest_sigma(covariance.bottomRightCorner<3, 3>())};
}

std::string pose_line(const pose_t& pose) {
  std::string line = text_of("%lld.%06lld %-9s", static_cast<long long>(pose.utime / 1000000), static_cast<long long>(pose.utime % 1000000),
                             state_name(pose.state).c_str());
  if (has_pose(pose)) {
    const PoseSigma sigma = pose_sigma(pose);
    line += text_of("  %s [%+.3f %+.3f %+.3f] m  sigma %.1f cm %.2f deg  quality %d", printable(pose.parent_frame).c_str(), pose.pos[0],
                    pose.pos[1], pose.pos[2], 100 * sigma.position_m, degrees(sigma.rotation_rad), static_cast<int>(pose.quality));
  }
  if (pose.state != pose_t::LOCALIZED) line += "  " + printable(pose.reason_text);
  line += text_of("  inliers %d/%d", pose.num_inliers, pose.num_matches);
  line += text_of("  latency %.1f ms  age %s", pose.latency_us[5] / 1e3, age_text(pose).c_str());
  return line;
}

std::string status_line(const status_t& status) {
  std::string line = text_of("status %s", state_name(status.state).c_str());
  line += "  " + printable(status.state_text) + "  source " + printable(status.source) + "  map " + printable(status.map_path);
  line += text_of("  camera %s  %.1f Hz  dropped %lld  %.1f MB", printable(status.camera_state).c_str(), status.frame_rate_hz,
                  static_cast<long long>(status.frames_dropped), static_cast<double>(status.rss_bytes) / 1e6);
  MonitorState only_status;
  only_status.status = status;
  for (const auto& warning : warnings(only_status)) line += "  WARNING: " + warning;
  return line;
}

nlohmann::json pose_json(const pose_t& pose) {
  nlohmann::json record{{"type", "pose"},
                        {"utime", pose.utime},
                        {"sequence", pose.sequence},
                        {"map_id", map_id_text(pose.map_id)},
                        {"parent_frame", pose.parent_frame},
                        {"child_frame", pose.child_frame},
                        {"pos", std::vector<double>(std::begin(pose.pos), std::end(pose.pos))},
                        {"orientation_wxyz", std::vector<double>(std::begin(pose.orientation), std::end(pose.orientation))},
                        {"covariance", std::vector<double>(std::begin(pose.covariance), std::end(pose.covariance))},
                        {"state", static_cast<int>(pose.state)},
                        {"state_name", state_name(pose.state)},
                        {"reason", static_cast<int>(pose.reason)},
                        {"reason_text", pose.reason_text},
                        {"quality", static_cast<int>(pose.quality)},
                        {"integrity_risk", pose.integrity_risk},
                        {"protection_m", {pose.protection_m[0], pose.protection_m[1]}},
                        {"protection_rad", {pose.protection_rad[0], pose.protection_rad[1]}},
                        {"num_features", pose.num_features},
                        {"num_matches", pose.num_matches},
                        {"num_inliers", pose.num_inliers},
                        {"reset_counter", pose.reset_counter},
                        {"jump_m", pose.jump_m},
                        {"age_us", pose.age_us}};
  for (std::size_t i = 0; i < kStageNames.size(); ++i) record["latency_us"][kStageNames[i]] = pose.latency_us[i];
  return record;
}

nlohmann::json status_json(const status_t& status) {
  return {{"type", "status"},
          {"utime", status.utime},
          {"state", static_cast<int>(status.state)},
          {"state_name", state_name(status.state)},
          {"state_text", status.state_text},
          {"source", status.source},
          {"map_path", status.map_path},
          {"map_id", map_id_text(status.map_id)},
          {"uptime_us", status.uptime_us},
          {"frames_received", status.frames_received},
          {"frames_dropped", status.frames_dropped},
          {"frames_corrupt", status.frames_corrupt},
          {"frames_localized", status.frames_localized},
          {"poses_published", status.poses_published},
          {"reset_counter", status.reset_counter},
          {"map_reloads", status.map_reloads},
          {"map_reload_failures", status.map_reload_failures},
          {"camera_state", status.camera_state},
          {"camera_stalls", status.camera_stalls},
          {"stream_restarts", status.stream_restarts},
          {"device_reopens", status.device_reopens},
          {"device_resets", status.device_resets},
          {"last_recovery_ms", status.last_recovery_ms},
          {"packets_lost", status.packets_lost},
          {"frames_incomplete", status.frames_incomplete},
          {"frames_unpaired", status.frames_unpaired},
          {"clock_drift_ppm", status.clock_drift_ppm},
          {"frame_rate_hz", status.frame_rate_hz},
          {"latency_p50_ms", status.latency_p50_ms},
          {"latency_max_ms", status.latency_max_ms},
          {"rss_bytes", status.rss_bytes},
          {"is_calibration_suspect", status.is_calibration_suspect != 0},
          {"focal_scale", status.focal_scale}};
}

void StageLatencies::add(const pose_t& pose) {
  for (std::size_t stage = 0; stage < kNumStages; ++stage) {
    std::vector<double>& durations = durations_ms_[stage];
    if (durations.size() < kWindow) durations.resize(durations.size() + 1);
    durations[next_] = pose.latency_us[stage] / 1e3;
  }
  next_ = (next_ + 1) % kWindow;
}

StageLatencies::Summary StageLatencies::of(std::size_t stage) const {
  return {upper_median(durations_ms_[stage]), lower_quantile(durations_ms_[stage], 0.99)};
}

std::string monitor_screen(const MonitorState& state) {
  std::string screen = state.pose ? pose_part(state) + latency_part(state) : "state     waiting for the first pose\n";
  if (state.status) {
    const status_t& status = *state.status;
    screen += camera_part(status);
    screen += "map       " + printable(status.map_path) +
              text_of(", id %s, %lld reloads\n", map_id_text(status.map_id).c_str(), static_cast<long long>(status.map_reloads));
    screen += text_of("daemon    up %.0f s, capture to pose p50 %.1f max %.1f ms, %.1f MB\n", static_cast<double>(status.uptime_us) / 1e6,
                      status.latency_p50_ms, status.latency_max_ms, static_cast<double>(status.rss_bytes) / 1e6);
  }
  for (const auto& warning : warnings(state)) screen += "WARNING   " + warning + "\n";
  return screen + state.sketch;
}

}  // namespace camloc::tools
