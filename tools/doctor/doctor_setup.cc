// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Configuration, map, camera and its calibration.
#include <toml++/toml.h>

#include <chrono>
#include <filesystem>

#include "core/io/camera_file.h"
#include "core/map/map_view.h"
#include "drivers/source_url.h"
#include "drivers/sources.h"
#include "tools/common/program.h"
#include "tools/common/text_format.h"
#include "tools/doctor/doctor_checks.h"

namespace camloc::tools {
namespace {

void read_setting(const toml::table& config, const char* key, std::string* setting) {
  if (const auto value = config.at_path(key).value<std::string>()) *setting = *value;
}

void read_settings(const std::string& config_text, Settings* settings) {
  const toml::parse_result config = toml::parse(config_text);
  if (!config) return;  // the configuration check has said so already: defaults remain
  read_setting(config.table(), "map.path", &settings->map_path);
  read_setting(config.table(), "source.url", &settings->source_url);
  read_setting(config.table(), "source.camera", &settings->camera_path);
  read_setting(config.table(), "publish.lcm_url", &settings->lcm_url);
  read_setting(config.table(), "control.socket", &settings->socket_path);
}

std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

}  // namespace

std::string Settings::scheme() const {
  const Result<SourceUrl> url = parse_source_url(source_url);
  return source_url.empty() || !url ? "" : url->scheme;
}

Check check_config(const std::string& path, Settings* settings) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) {
    return {"config", Level::kFailure, path + " does not exist", "install the package camloc, or name your file with --config"};
  }
  const auto camlocd = find_program("camlocd");
  if (!camlocd) return {"config", Level::kWarning, "not checked: " + camlocd.status().message(), "install the package camloc"};
  const auto checked = run_program(*camlocd, {"--config", path, "--check-config"}, std::chrono::seconds(10));
  if (!checked) return {"config", Level::kFailure, checked.status().message(), "run 'camlocd --check-config' yourself"};
  if (checked->exit_code != 0) return {"config", Level::kFailure, first_line(checked->err + checked->out), "correct that line of the file"};
  const auto printed = run_program(*camlocd, {"--config", path, "--print-config"}, std::chrono::seconds(10));
  if (printed && printed->exit_code == 0) read_settings(printed->out, settings);
  return {"config", Level::kOk, path, ""};
}

Check check_map(const std::string& path) {
  if (path.empty()) {
    return {"map", Level::kFailure, "none configured", "build one with 'camloc map build', then set map.path in the configuration"};
  }
  const auto map = MapView::open(path);
  if (!map) return {"map", Level::kFailure, map.status().message(), "build it with 'camloc map build' or copy it again"};
  const MapInfo& info = map->info();
  return {"map", Level::kOk,
          path + ": " + std::to_string(info.num_landmarks) + " landmarks, " + std::to_string(info.num_keyframes) + " keyframes, " +
              std::to_string(info.file_bytes / 1000) + " kB",
          ""};
}

Check check_source(const std::string& url, const DaemonAnswer& daemon, std::optional<ImageSize>* size) {
  if (url.empty())
    return {"camera", Level::kFailure, "none configured",
            "set source.url; 'camloc camera list' shows what is plugged in, camlocd.toml(5) what else it may be"};
  if (daemon) {
    const bool has_camera = daemon->value("state", std::string()) != "NO_CAMERA";
    if (has_camera) return {"camera", Level::kOk, url + ": in use by camlocd", ""};
    return {"camera", Level::kFailure, url + ": camlocd gets no frames", "see the usb lines; 'journalctl -u camlocd -b' has the reason"};
  }
  auto source = open_frame_source(url);
  if (!source) return {"camera", Level::kFailure, source.status().message(), "'camloc camera list' shows what is plugged in"};
  FrameBuffer frame;
  const Status status = (*source)->next(&frame, std::chrono::seconds(3));
  if (!status) return {"camera", Level::kFailure, url + ": " + status.message(), "check cable, power and permission of the device"};
  *size = ImageSize{frame.gray.width, frame.gray.height};
  return {"camera", Level::kOk,
          url + text_of(": %dx%d image, %dx%d depth", frame.gray.width, frame.gray.height, frame.depth.width, frame.depth.height), ""};
}

Check check_calibration(const std::string& path, const DaemonAnswer& daemon, const std::optional<ImageSize>& size) {
  const std::string name = path.empty() ? "that of the source" : path;
  const std::string mend = "'camloc camera calibrate' makes one; set source.camera to it";
  if (!path.empty()) {
    const auto camera = read_camera_file(path);
    if (!camera) return {"calibration", Level::kFailure, camera.status().message(), "correct that file or set another one"};
    if (size && (camera->color.width != size->width || camera->color.height != size->height)) {
      return {"calibration", Level::kFailure,
              path + text_of(": is for %dx%d pixels, the camera gives %dx%d", camera->color.width, camera->color.height, size->width,
                             size->height),
              mend};
    }
  }
  if (daemon && daemon->value("is_calibration_suspect", false)) {
    return {"calibration", Level::kWarning,
            name + text_of(": the images fit the map with %.3f times its focal length", daemon->value("focal_scale", 1.0)), mend};
  }
  return {"calibration", Level::kOk, name, ""};
}

}  // namespace camloc::tools
