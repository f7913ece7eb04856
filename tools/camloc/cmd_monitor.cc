// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// `camloc monitor`: what camlocd publishes, as it arrives.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <deque>
#include <lcm/lcm-cpp.hpp>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "tools/camloc/commands.h"
#include "tools/common/terminal_observer.h"
#include "tools/doctor/doctor_checks.h"
#include "tools/monitor/map_sketch.h"
#include "tools/monitor/message_layout.h"
#include "tools/monitor/monitor_view.h"

namespace camloc::tools {
namespace {

using Clock = std::chrono::steady_clock;

struct MonitorOptions {
  std::string lcm_url = kDefaultLcmUrl;
  std::string pose_channel = "CAMLOC_POSE";
  std::string status_channel = "CAMLOC_STATUS";
  bool is_json = false;
  bool is_plain = false;
  long long count = 0;   // poses, 0 = no end
  double timeout_s = 0;  // 0 = wait for ever
};

constexpr const char* kHints =
    "  is the daemon running?            camloc ctl status\n"
    "  does it publish on this URL?      [publish] lcm_url in camlocd.toml, --lcm-url here\n"
    "  is there a multicast route?       camloc doctor\n"
    "  other machine or namespace?       the default URL has ttl=0 and stays on this machine\n";

double seconds_between(Clock::time_point from, Clock::time_point to) { return std::chrono::duration<double>(to - from).count(); }

std::span<const std::uint8_t> bytes_of(const lcm::ReceiveBuffer* buffer) {
  return {static_cast<const std::uint8_t*>(buffer->data), buffer->data_size};
}

/// Receives and shows. Not thread-safe; LCM calls back from handleTimeout only.
class Monitor {
 public:
  explicit Monitor(const MonitorOptions& options)
      : options_(options), is_screen_(!options.is_json && !options.is_plain && ::isatty(STDOUT_FILENO) == 1), start_(Clock::now()) {}

  void on_pose(const lcm::ReceiveBuffer* buffer, const std::string& channel) {
    pose_t pose;
    if (!decode_message(bytes_of(buffer), kPoseLayout, &pose)) return refuse(channel);
    const auto now = Clock::now();
    arrivals_.push_back(now);
    while (seconds_between(arrivals_.front(), now) > 2) arrivals_.pop_front();
    ++state_.num_poses;
    if (pose.state == pose_t::LOCALIZED) ++state_.num_localized;
    state_.latencies.add(pose);
    if (options_.is_json) {
      std::printf("%s\n", dump(pose_json(pose)).c_str());
    } else if (!is_screen_) {
      std::printf("%s\n", pose_line(pose).c_str());
    }
    state_.pose = std::move(pose);
  }

  void on_status(const lcm::ReceiveBuffer* buffer, const std::string& channel) {
    status_t status;
    if (!decode_message(bytes_of(buffer), kStatusLayout, &status)) return refuse(channel);
    const bool is_news = !state_.status || state_.status->state != status.state || state_.status->map_id != status.map_id ||
                         state_.status->is_calibration_suspect != status.is_calibration_suspect ||
                         state_.status->camera_state != status.camera_state;
    if (options_.is_json) {
      std::printf("%s\n", dump(status_json(status)).c_str());
    } else if (!is_screen_ && is_news) {
      std::printf("%s\n", status_line(status).c_str());
    }
    state_.status = std::move(status);
  }

  /// Draws at most ten times a second.
  void refresh() {
    const auto now = Clock::now();
    if (!is_screen_ || seconds_between(last_draw_, now) < 0.1) return;
    last_draw_ = now;
    state_.rate_hz =
        arrivals_.size() < 2 ? 0 : static_cast<double>(arrivals_.size() - 1) / seconds_between(arrivals_.front(), arrivals_.back());
    state_.seconds_since_pose = silence_s();
    state_.sketch = sketch();
    std::printf("\x1b[H\x1b[J%s", monitor_screen(state_).c_str());
  }

  [[nodiscard]] long long num_poses() const { return state_.num_poses; }
  [[nodiscard]] bool has_heard() const { return state_.num_poses > 0 || state_.status.has_value(); }
  [[nodiscard]] double silence_s() const { return seconds_between(arrivals_.empty() ? start_ : arrivals_.back(), Clock::now()); }

 private:
  /// Text from a message may be no UTF-8.
  static std::string dump(const nlohmann::json& record) { return record.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace); }

  /// Where in the map, if the daemon's map can be read here and is the one it has open.
  std::string sketch() {
    if (!state_.status || !state_.pose) return "";
    const status_t& status = *state_.status;
    if (!sketch_ || sketched_map_id_ != status.map_id) {
      sketched_map_id_ = status.map_id;
      sketch_.emplace(std::vector<Eigen::Vector2d>(), std::vector<Eigen::Vector2d>());
      const Result<MapView> map = MapView::open(status.map_path);
      if (!map || map->info().map_id != static_cast<std::uint64_t>(status.map_id)) return "";
      sketch_ = MapSketch::of(*map);
      T_map_wcs_ = map->info().wcs ? map->info().wcs->T_wcs_map.inverse() : Rigid3{};
    }
    const pose_t& pose = *state_.pose;
    if (pose.state != pose_t::LOCALIZED && pose.state != pose_t::COASTING) return sketch_->draw(std::nullopt);
    const Rigid3 T_parent_camera{Eigen::Quaterniond(pose.orientation[0], pose.orientation[1], pose.orientation[2], pose.orientation[3]),
                                 {pose.pos[0], pose.pos[1], pose.pos[2]}};
    return sketch_->draw(pose.parent_frame == "wcs" ? T_map_wcs_ * T_parent_camera : T_parent_camera);
  }

  void refuse(const std::string& channel) {
    if (has_refused_) return;
    has_refused_ = true;
    std::fprintf(stderr, "camloc: messages on %s are of another type or version than this program reads; skipping them\n", channel.c_str());
  }

  const MonitorOptions& options_;
  bool is_screen_;
  bool has_refused_ = false;
  Clock::time_point start_;
  Clock::time_point last_draw_{};
  std::deque<Clock::time_point> arrivals_;  // of the last two seconds, at least one
  MonitorState state_;
  std::optional<MapSketch> sketch_;
  std::int64_t sketched_map_id_ = 0;
  Rigid3 T_map_wcs_;
};

int run(const MonitorOptions& options) {
  const auto route = find_multicast_route(options.lcm_url);
  if (!route) return report(route.status());
  lcm::LCM lcm(options.lcm_url);
  if (!lcm.good()) return report({ErrorCode::kUnavailable, "LCM cannot open " + options.lcm_url + "; see 'camloc doctor'"});
  Monitor monitor(options);
  lcm.subscribe(options.pose_channel, &Monitor::on_pose, &monitor);
  lcm.subscribe(options.status_channel, &Monitor::on_status, &monitor);

  bool has_hinted = false;
  const InterruptGuard guard;
  while (!InterruptGuard::is_interrupted() && (options.count == 0 || monitor.num_poses() < options.count)) {
    if (lcm.handleTimeout(100) < 0) break;  // a log file ends this way
    monitor.refresh();
    std::fflush(stdout);
    if (options.timeout_s > 0 && monitor.silence_s() > options.timeout_s) {
      std::fprintf(stderr, "camloc: no pose on %s for %g s (%s)\n%s", options.pose_channel.c_str(), options.timeout_s,
                   options.lcm_url.c_str(), kHints);
      return 1;
    }
    if (!has_hinted && options.timeout_s <= 0 && !monitor.has_heard() && monitor.silence_s() > 3) {
      has_hinted = true;
      std::fprintf(stderr, "camloc: nothing on %s yet, still waiting (%s)\n%s", options.pose_channel.c_str(), options.lcm_url.c_str(),
                   kHints);
    }
  }
  std::fflush(stdout);
  if (InterruptGuard::is_interrupted()) return 0;  // whoever watches is not told of a failure when told to stop
  if (monitor.num_poses() > 0 && monitor.num_poses() >= options.count) return 0;
  return report({ErrorCode::kEnd, options.lcm_url + " ended after " + std::to_string(monitor.num_poses()) + " poses"});
}

}  // namespace

void add_monitor_command(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<MonitorOptions>();
  CLI::App* command = app.add_subcommand("monitor", "Show the poses camlocd publishes");
  command->add_option("--lcm-url", options->lcm_url, "LCM URL; file://LOG?mode=r reads a log")->capture_default_str();
  command->add_option("--channel", options->pose_channel, "channel of the poses")->capture_default_str();
  command->add_option("--status-channel", options->status_channel, "channel of the status")->capture_default_str();
  command->add_option("--count", options->count, "end after so many poses")->check(CLI::NonNegativeNumber);
  command->add_option("--timeout", options->timeout_s, "fail when no pose arrives for so many seconds (default: wait)")
      ->check(CLI::NonNegativeNumber);
  command->add_flag("--json", options->is_json, "one JSON object a line");
  command->add_flag("--plain", options->is_plain, "lines instead of the live view, also on a terminal");
  command->callback([options, &exit_code] { exit_code = run(*options); });
}

}  // namespace camloc::tools
