// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/control_protocol.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <optional>
#include <vector>

#include "core/io/text.h"
#include "core/localize/localization.h"

namespace camloc {
namespace {

/// Appends members to one flat JSON object.
class JsonObject {
 public:
  void add(const char* key, std::string_view text) { add_raw(key, in_double_quotes(text, true)); }
  void add(const char* key, const char* text) { add(key, std::string_view(text)); }
  void add(const char* key, bool value) { add_raw(key, value ? "true" : "false"); }
  void add(const char* key, std::int64_t value) { add_raw(key, std::to_string(value)); }
  void add(const char* key, double value) {
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%.6g", value);
    add_raw(key, std::isfinite(value) ? text.data() : "null");
  }
  [[nodiscard]] std::string str() const { return text_ + '}'; }

 private:
  void add_raw(const char* key, const std::string& value) {
    if (text_.size() > 1) text_ += ',';
    text_ += std::string("\"") + key + "\":" + value;
  }

  std::string text_ = "{";
};

/// "hint" and its numbers.
Result<ControlRequest> parse_hint(const std::vector<std::string_view>& fields) {
  constexpr std::size_t kNumFields = 6;
  std::array<double, kNumFields> numbers{};
  bool is_complete = fields.size() == kNumFields;
  for (std::size_t i = 1; is_complete && i < kNumFields; ++i) {
    const std::optional<double> number = parse_double(fields[i]);
    is_complete = number.has_value();
    numbers[i] = number.value_or(0);
  }
  if (!is_complete) return Status(ErrorCode::kInvalid, "hint takes five numbers, X Y Z YAW_DEG RADIUS_M");
  ControlRequest request{ControlCommand::kHint, {}};
  request.hint.position_m = {numbers[1], numbers[2], numbers[3]};
  request.hint.yaw_rad = numbers[4] * std::numbers::pi / 180;
  request.hint.radius_m = numbers[5];
  if (request.hint.is_valid()) return request;
  return Status(ErrorCode::kInvalid, "hint: the radius is to be above 0 and at most 20 m, and every number finite");
}

}  // namespace

Result<ControlRequest> parse_control_request(std::string_view line) {
  const std::string_view text = trimmed(line);
  if (text == "status") return ControlRequest{ControlCommand::kStatus, {}};
  if (text == "reload") return ControlRequest{ControlCommand::kReload, {}};
  if (text == "reset") return ControlRequest{ControlCommand::kReset, {}};
  const std::vector<std::string_view> fields = split_fields(text, " \t");
  if (!fields.empty() && fields[0] == "hint") return parse_hint(fields);
  constexpr std::size_t kShown = 40;
  return Status(ErrorCode::kInvalid,
                "unknown command '" + std::string(text.substr(0, kShown)) + "': one of status, reload, reset, hint X Y Z YAW_DEG RADIUS_M");
}

std::string control_reply(const Status& status) {
  JsonObject json;
  json.add("ok", status.is_ok());
  if (!status) json.add("error", std::string_view(status.message()));
  return json.str();
}

std::string control_reply(const DaemonStatus& status) {
  JsonObject json;
  std::array<char, 20> map_id{};
  std::snprintf(map_id.data(), map_id.size(), "%016llx", static_cast<unsigned long long>(status.map_id));
  json.add("ok", true);
  json.add("utime", status.written_epoch_us);
  json.add("state", to_string(status.state));
  json.add("state_text", status.state_text);
  json.add("source", status.source);
  json.add("map_path", status.map_path);
  json.add("map_id", map_id.data());
  json.add("uptime_us", status.uptime_us);
  json.add("frames_received", status.frames_received);
  json.add("frames_dropped", status.frames_dropped);
  json.add("frames_corrupt", status.frames_corrupt);
  json.add("frames_localized", status.frames_localized);
  json.add("poses_published", status.poses_published);
  json.add("reset_counter", status.reset_counter);
  json.add("map_reloads", status.map_reloads);
  json.add("map_reload_failures", status.map_reload_failures);
  json.add("camera_state", status.camera_state);
  json.add("camera_stalls", status.camera_stalls);
  json.add("stream_restarts", status.stream_restarts);
  json.add("device_reopens", status.device_reopens);
  json.add("device_resets", status.device_resets);
  json.add("last_recovery_ms", status.last_recovery_ms);
  json.add("packets_lost", status.packets_lost);
  json.add("frames_incomplete", status.frames_incomplete);
  json.add("frames_unpaired", status.frames_unpaired);
  json.add("clock_drift_ppm", status.clock_drift_ppm);
  json.add("frame_rate_hz", status.frame_rate_hz);
  json.add("latency_p50_ms", status.latency_p50_ms);
  json.add("latency_max_ms", status.latency_max_ms);
  json.add("rss_bytes", status.rss_bytes);
  json.add("log_lines_lost", status.log_lines_lost);
  json.add("is_calibration_suspect", status.is_calibration_suspect);
  json.add("focal_scale", status.focal_scale);
  json.add("coarse_state", status.coarse_state);
  json.add("coarse_answers", status.coarse_answers);
  json.add("fixes_by_hint", status.fixes_by_hint);
  json.add("fixes_by_retrieval", status.fixes_by_retrieval);
  json.add("fixes_by_coarse", status.fixes_by_coarse);
  return json.str();
}

}  // namespace camloc
