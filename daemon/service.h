// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The daemon's main loop: frames in, poses out, and everything that may be missing at any time (camera, map, network) as
// a state with a retry. One thread beside the capture thread; it waits in one poll().
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "core/base/result.h"
#include "core/base/unique_fd.h"
#include "core/geometry/camera.h"
#include "core/localize/localization.h"
#include "daemon/capture_thread.h"
#include "daemon/coarse_worker.h"
#include "daemon/config.h"
#include "daemon/control_socket.h"
#include "daemon/hint_listener.h"
#include "daemon/log.h"
#include "daemon/map_slot.h"
#include "daemon/sd_notify.h"
#include "daemon/sinks/sinks.h"
#include "daemon/status_board.h"

namespace camloc {

struct ServiceInputs {
  Config config;
  std::optional<RgbdCamera> camera;               ///< of source.camera
  std::function<Result<Config>()> reload_config;  ///< reads the configuration anew
  OpenSource open_source;                         ///< open_frame_source, or a test's own
  SinkTable sinks = pose_sinks();
};

class Service {
 public:
  explicit Service(ServiceInputs inputs);
  ~Service();

  /// Takes the control socket, guards against truncated maps, blocks the signals it handles, starts the capture thread.
  /// Errors: those of ControlSocket and of the sink's configuration. A missing camera, map or network is none.
  [[nodiscard]] Status start();
  /// Runs until there is an exit code: 0 asked to stop or, if so configured, recording over; 2 configuration.
  [[nodiscard]] int run();
  /// One turn of run(): waits for something to do, at most `timeout_ms` (-1: for ever), and does it.
  void step(int timeout_ms);
  /// Ends the capture thread, gives the control socket back. False when the source hangs: see CaptureThread::stop().
  [[nodiscard]] bool stop();

  [[nodiscard]] const DaemonStatus& status() const { return board_.get(); }
  [[nodiscard]] std::optional<int> exit_code() const { return exit_code_; }

 private:
  // What poll() reports.
  void on_signal();
  void on_wake();
  void on_tick();
  [[nodiscard]] std::string on_control(const ControlRequest& request);

  // Hints.
  [[nodiscard]] Status take_hint(const PoseHint& hint);
  void pass_hint_on();
  void listen_for_hints();

  // Camera.
  void adopt_source(const CaptureReport& report);
  void on_phase(const CaptureReport& report);
  void check_camera(std::int64_t now_ns);
  void on_frame(const CapturedFrame& frame);
  [[nodiscard]] const Localization& localize(const Frame& frame);
  void report_state(const Localization& localization);
  void report_calibration();

  // Map.
  [[nodiscard]] Status reload();
  [[nodiscard]] Status apply_new_config();
  void retry_map();
  void check_map_file();
  void announce_map();
  void drop_map(const std::string& why);
  void start_coarse();
  void check_coarse();

  // State, network, watchdog.
  void set_state(State state, const char* text);
  void connect();
  void publish_status();
  void refresh_counters();
  void feed_watchdog(std::int64_t now_ns);
  void fail(const Status& status);

  ServiceInputs in_;
  Log log_;
  Notifier notifier_;
  ProgressWatch progress_;
  StatusBoard board_;
  std::unique_ptr<PoseSink> sink_;
  MapSlot map_;
  std::unique_ptr<CoarseWorker> coarse_;  // of this map, where one is configured
  UniqueFd signal_fd_, wake_fd_, timer_fd_;
  std::unique_ptr<ControlSocket> control_;
  std::unique_ptr<HintListener> hint_listener_;
  std::unique_ptr<CaptureThread> capture_;

  std::optional<RgbdCamera> camera_;  // in use; known once the source was open
  bool is_live_ = false;              // capture stamps are of this machine's clock
  std::string adopted_source_;        // description of the device that camera_ belongs to
  bool is_size_checked_ = false;      // of the frames of that device
  bool is_streaming_ = false, is_stalled_ = false, is_over_ = false;
  std::uint64_t report_number_ = 0, num_processed_ = 0;
  Localization no_map_;             // published without a map
  std::uint32_t num_resets_ = 0;    // of the current localizer
  std::uint32_t reset_offset_ = 0;  // of the ones before
  std::optional<PoseHint> hint_;    // waits for the next frame
  std::int64_t hint_ns_ = 0;        // when it came
  RepeatFilter coarse_trouble_, map_trouble_, route_trouble_, source_trouble_, hint_trouble_;
  std::int64_t last_frame_ns_ = 0, next_second_ns_ = 0, watchdog_fed_ns_ = 0;
  std::optional<int> exit_code_;
};

}  // namespace camloc
