// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/service_setup.h"

#include <sys/resource.h>

#include <algorithm>

#include "core/coarse/coarse_network.h"
#include "core/io/camera_file.h"
#include "core/map/map_view.h"
#include "daemon/clock.h"

namespace camloc {
namespace {

std::string size_text(int width, int height) { return std::to_string(width) + " x " + std::to_string(height); }

Status check_size(const std::string& what, int source_width, int source_height, const Intrinsics& camera, const Config& config) {
  if (source_width == 0 || (source_width == camera.width && source_height == camera.height)) return Status::ok();
  const std::string calibration = config.source_camera.empty() ? "the source's own calibration" : config.source_camera;
  return {ErrorCode::kInvalid, config.source_url + " delivers " + what + " images of " + size_text(source_width, source_height) + " but " +
                                   calibration + " is for " + size_text(camera.width, camera.height) +
                                   "; set source.camera to its calibration"};
}

/// The map may be missing at start, and then nobody can say whose the model is.
Status check_coarse(const Config& config) {
  if (config.coarse_cnn.empty()) return Status::ok();
  const Result<CoarseModel> model = read_coarse_model(config.coarse_cnn);
  if (!model) return model.status();
  const Result<MapView> map = MapView::open(config.map_path);
  if (map) {
    if (Status status = check_coarse_map(model->info, map->info().map_id); !status) return status.with_context(config.coarse_cnn);
  }
  return check_network_plugin();
}

bool stays_on_machine(const std::string& lcm_url) {
  const Result<SourceUrl> url = parse_source_url(lcm_url);
  return url && url->scheme == "udpm" && url->text_option("ttl", "") == "0";
}

}  // namespace

CaptureOptions capture_options(const Config& config) {
  CaptureOptions options;
  options.url = config.source_url;
  options.wait_for_reader = config.source_lossless;
  options.retry = std::chrono::milliseconds(config.source_retry_ms);
  options.supervisor.stall_ns = config.source_stall_ms * 1'000'000;
  options.supervisor.first_frame_ns = std::max(options.supervisor.first_frame_ns, options.supervisor.stall_ns);
  return options;
}

MapSlotOptions map_slot_options(const Config& config) {
  MapSlotOptions options;
  options.path = config.map_path;
  options.needs_datum = config.publish_frame == "wcs";
  options.localizer.orb.num_features = static_cast<int>(config.localize_features);
  options.localizer.use_tracking = config.localize_tracking;
  options.localizer.use_depth = config.localize_depth;
  options.localizer.max_coast_ns = config.localize_max_coast_ms * 1'000'000;
  options.localizer.now_ns = monotonic_ns;
  return options;
}

SinkOptions sink_options(const Config& config) {
  return {config.publish_lcm_url, config.publish_pose_channel, config.publish_status_channel, config.publish_bot_core_channel};
}

Status check_settings(const Config& config, SourceTable sources, SinkTable sinks) {
  if (const Status status = find_sink(config.publish_lcm_url, sinks).status(); !status) return status.with_context("publish.lcm_url");
  if (!config.control_hint_channel.empty() && !stays_on_machine(config.publish_lcm_url)) {
    return {ErrorCode::kInvalid,
            "control.hint_channel: hints are taken from this machine only; set publish.lcm_url to udpm://GROUP:PORT?ttl=0"};
  }
  if (config.source_url.empty()) return Status::ok();
  const Result<const SourceEntry*> source = find_source(config.source_url, sources);
  return source ? Status::ok() : Status(ErrorCode::kInvalid, "source.url: " + source.status().message());
}

Result<std::optional<RgbdCamera>> read_configured_camera(const Config& config) {
  if (config.source_camera.empty()) return std::optional<RgbdCamera>();
  Result<RgbdCamera> camera = read_camera_file(config.source_camera);
  if (!camera) return camera.status().with_context("source.camera");
  return std::optional<RgbdCamera>(std::move(camera).value());
}

Result<RgbdCamera> match_camera(const Config& config, const std::optional<RgbdCamera>& configured, const FrameSourceInfo& source) {
  const std::optional<RgbdCamera>& camera = configured ? configured : source.camera;
  if (!camera)
    return Status(ErrorCode::kInvalid, config.source_url + " does not know its calibration; set source.camera to its calibration file");
  if (const Status status = check_size("colour", source.color_width, source.color_height, camera->color, config); !status) return status;
  const Intrinsics& depth = camera->is_depth_registered ? camera->color : camera->depth;
  if (const Status status = check_size("depth", source.depth_width, source.depth_height, depth, config); !status) return status;
  return *camera;
}

Status check_config(const Config& config, SourceTable sources, SinkTable sinks) {
  if (const Status status = check_settings(config, sources, sinks); !status) return status;
  const Result<std::optional<RgbdCamera>> camera = read_configured_camera(config);
  if (!camera) return camera.status();
  if (const Status status = check_coarse(config); !status) return status.with_context("coarse.cnn");
  if (config.source_url.empty() || !(*find_source(config.source_url, sources))->is_recording) return Status::ok();
  const Result<std::unique_ptr<FrameSource>> source = open_frame_source(config.source_url, {}, sources);
  if (!source) return source.status().with_context("source.url");
  return match_camera(config, *camera, (*source)->info()).status();
}

Status check_resource_limits() {
  // Streams, events, control socket and its clients, LCM twice, a camera's many, a map being exchanged; with room for libraries.
  constexpr rlim_t kNeeded = 64;
  rlimit files{};
  if (::getrlimit(RLIMIT_NOFILE, &files) != 0 || files.rlim_cur >= kNeeded) return Status::ok();
  const rlimit wanted{std::min(kNeeded, files.rlim_max), files.rlim_max};
  if (wanted.rlim_cur == kNeeded && ::setrlimit(RLIMIT_NOFILE, &wanted) == 0) return Status::ok();
  return {ErrorCode::kIo, "at most " + std::to_string(files.rlim_max) + " files may be open, " + std::to_string(kNeeded) +
                              " are needed; raise the limit (ulimit -n, LimitNOFILE=)"};
}

std::string changes_that_need_restart(const Config& from, const Config& to) {
  std::string out;
  for (const Setting& setting : settings()) {
    if (setting.is_reloadable || value_of(setting, from) == value_of(setting, to)) continue;
    out += (out.empty() ? "" : ", ") + setting.name();
  }
  return out;
}

}  // namespace camloc
