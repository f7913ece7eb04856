// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/sinks/lcm_sink.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "daemon/lcm_connection.h"

namespace camloc {
namespace {

template <typename Integer>
std::int32_t clip(Integer value) {
  if (std::cmp_greater(value, std::numeric_limits<std::int32_t>::max())) return std::numeric_limits<std::int32_t>::max();
  return static_cast<std::int32_t>(value);
}

class LcmSink final : public PoseSink {
 public:
  explicit LcmSink(const SinkOptions& options) : options_(options), pose_(), bot_core_pose_(), status_(), buffer_() {
    // Texts of the longest kind, so that none grows later.
    constexpr std::size_t kLongestReason = 128, kLongestState = 255, kLongestPath = 1000;
    pose_.reason_text.reserve(kLongestReason);
    status_.state_text.reserve(kLongestState);
    status_.source.reserve(kLongestPath);
    status_.map_path.reserve(kLongestPath);
  }

  [[nodiscard]] Status connect() override {
    if (lcm_) return Status::ok();
    Result<Lcm> lcm = connect_lcm(options_.url);
    if (!lcm) return lcm.status();
    lcm_ = std::move(lcm).value();
    return Status::ok();
  }
  [[nodiscard]] bool is_connected() const override { return lcm_ != nullptr; }

  bool publish(const PoseReport& report) override {
    fill_pose(report, &pose_);
    if (!send(options_.pose_channel, pose_)) return false;
    if (report.localization.state != State::kLocalized || options_.bot_core_channel.empty()) return true;
    fill_bot_core(pose_, &bot_core_pose_);
    send(options_.bot_core_channel, bot_core_pose_);
    return true;
  }

  bool publish(const DaemonStatus& status) override {
    fill_status(status, &status_);
    return send(options_.status_channel, status_);
  }

 private:
  template <typename Message>
  bool send(const std::string& channel, const Message& message) {
    if (!lcm_) return false;
    const int size = message.encode(buffer_.data(), 0, static_cast<int>(buffer_.size()));
    if (size < 0) return false;
    return lcm_publish(lcm_.get(), channel.c_str(), buffer_.data(), static_cast<unsigned int>(size)) == 0;
  }

  SinkOptions options_;
  Lcm lcm_;
  pose_t pose_;
  bot_core::pose_t bot_core_pose_;
  status_t status_;
  std::array<std::uint8_t, 4096> buffer_;
};

}  // namespace

void fill_pose(const PoseReport& report, pose_t* message) {
  const Localization& found = report.localization;
  message->utime = report.capture_epoch_ns / 1000;
  message->sequence = static_cast<std::int64_t>(found.sequence);
  message->map_id = static_cast<std::int64_t>(report.map_id);
  message->parent_frame = report.parent_frame;
  message->child_frame = "camera";
  message->state = static_cast<std::int8_t>(found.state);
  message->reason = static_cast<std::int8_t>(found.reason);
  message->reason_text = to_string(found.reason);
  message->quality = static_cast<std::int8_t>(report.quality);
  message->integrity_risk = found.has_pose ? found.integrity_risk : 1.0;
  const Protection protection = found.has_pose ? found.protection : Protection{};
  message->protection_m[0] = protection.p95.position_m;
  message->protection_m[1] = protection.p999.position_m;
  message->protection_rad[0] = protection.p95.rotation_rad;
  message->protection_rad[1] = protection.p999.rotation_rad;
  message->num_features = clip(found.num_features);
  message->num_matches = clip(found.evidence.num_matches);
  message->num_inliers = clip(found.evidence.num_inliers);
  message->reset_counter = clip(report.reset_counter);
  message->jump_m = found.jump_m;
  for (std::size_t i = 0; i < found.stage_ns.size(); ++i) message->latency_us[i] = clip(found.stage_ns[i] / 1000);
  message->age_us = report.age_ns < 0 ? -1 : clip(report.age_ns / 1000);

  const Rigid3& T_parent_camera = report.T_parent_camera.pose;
  Eigen::Map<Eigen::Vector3d>(message->pos) = T_parent_camera.translation;
  const Eigen::Quaterniond& q = T_parent_camera.rotation;
  Eigen::Map<Eigen::Vector4d>(message->orientation) << q.w(), q.x(), q.y(), q.z();
  Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(message->covariance) = report.T_parent_camera.covariance;
}

void fill_bot_core(const pose_t& pose, bot_core::pose_t* message) {
  *message = bot_core::pose_t{};
  message->utime = pose.utime;
  std::copy_n(pose.pos, 3, message->pos);
  std::copy_n(pose.orientation, 4, message->orientation);
}

void fill_status(const DaemonStatus& status, status_t* message) {
  message->utime = status.written_epoch_us;
  message->state = static_cast<std::int8_t>(status.state);
  message->state_text = status.state_text;
  message->source = status.source;
  message->map_path = status.map_path;
  message->map_id = static_cast<std::int64_t>(status.map_id);
  message->uptime_us = status.uptime_us;
  message->frames_received = status.frames_received;
  message->frames_dropped = status.frames_dropped;
  message->frames_corrupt = status.frames_corrupt;
  message->frames_localized = status.frames_localized;
  message->poses_published = status.poses_published;
  message->reset_counter = status.reset_counter;
  message->map_reloads = status.map_reloads;
  message->map_reload_failures = status.map_reload_failures;
  message->camera_state = status.camera_state;
  message->camera_stalls = status.camera_stalls;
  message->stream_restarts = status.stream_restarts;
  message->device_reopens = status.device_reopens;
  message->device_resets = status.device_resets;
  message->last_recovery_ms = status.last_recovery_ms;
  message->packets_lost = status.packets_lost;
  message->frames_incomplete = status.frames_incomplete;
  message->frames_unpaired = status.frames_unpaired;
  message->clock_drift_ppm = status.clock_drift_ppm;
  message->frame_rate_hz = status.frame_rate_hz;
  message->latency_p50_ms = status.latency_p50_ms;
  message->latency_max_ms = status.latency_max_ms;
  message->rss_bytes = status.rss_bytes;
  message->is_calibration_suspect = status.is_calibration_suspect ? 1 : 0;
  message->focal_scale = status.focal_scale;
}

Result<std::unique_ptr<PoseSink>> open_lcm_sink(const SinkOptions& options) {
  return std::unique_ptr<PoseSink>(std::make_unique<LcmSink>(options));
}

}  // namespace camloc
