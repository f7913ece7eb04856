// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The loop itself, and the way of a frame through it. Map and reload are in service_map.cc, what others ask for in
// service_control.cc.
#include "daemon/service.h"

#include <signal.h>
#include <sys/eventfd.h>
#include <sys/signalfd.h>
#include <sys/timerfd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <utility>

#include "core/io/camera_file.h"
#include "core/map/mapping_guard.h"
#include "daemon/clock.h"
#include "daemon/service_setup.h"

namespace camloc {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;
constexpr std::int64_t kTick_ns = 100'000'000;
constexpr std::chrono::milliseconds kStopPatience{500};

UniqueFd open_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  for (const int number : {SIGTERM, SIGINT, SIGHUP}) sigaddset(&signals, number);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);  // inherited by the capture thread, so that only the loop sees them
  return UniqueFd(::signalfd(-1, &signals, SFD_NONBLOCK | SFD_CLOEXEC));
}

UniqueFd open_timer(std::int64_t period_ns) {
  UniqueFd timer(::timerfd_create(CLOCK_MONOTONIC, TFD_NONBLOCK | TFD_CLOEXEC));
  itimerspec when{};
  when.it_interval.tv_nsec = when.it_value.tv_nsec = period_ns;
  ::timerfd_settime(timer.get(), 0, &when, nullptr);
  return timer;
}

void drain(int fd) {
  std::uint64_t count = 0;
  [[maybe_unused]] const ssize_t got = ::read(fd, &count, sizeof(count));
}

}  // namespace

Service::Service(ServiceInputs inputs)
    : in_(std::move(inputs)), log_(in_.config.parsed_log_level()), board_(in_.config.source_url, in_.config.map_path, monotonic_ns()) {
  no_map_.state = State::kNoMap;
  board_.set_state(State::kNoCamera, in_.config.source_url.empty() ? "source.url is not set" : "opening the source");
}

Service::~Service() = default;

Status Service::start() {
  Result<std::unique_ptr<PoseSink>> sink = open_pose_sink(sink_options(in_.config), in_.sinks);
  if (!sink) return sink.status().with_context("publish.lcm_url");
  sink_ = std::move(sink).value();
  if (!in_.config.control_socket.empty()) {
    Result<std::unique_ptr<ControlSocket>> control = ControlSocket::open(in_.config.control_socket);
    if (!control) return control.status();
    control_ = std::move(control).value();
  }
  if (!install_mapping_guard()) return {ErrorCode::kIo, std::string("cannot handle SIGBUS: ") + std::strerror(errno)};
  signal_fd_ = open_signals();
  wake_fd_.reset(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC));
  const std::int64_t watchdog_ns = notifier_.watchdog_ns();
  timer_fd_ = open_timer(watchdog_ns == 0 ? kTick_ns : std::clamp(watchdog_ns / 8, kTick_ns / 10, kTick_ns));
  if (!signal_fd_.is_open() || !wake_fd_.is_open() || !timer_fd_.is_open()) {
    return {ErrorCode::kIo, std::string("cannot open event descriptors: ") + std::strerror(errno)};
  }
  if (!in_.config.source_url.empty()) {
    capture_ = std::make_unique<CaptureThread>(capture_options(in_.config), in_.open_source, wake_fd_.get());
  }
  listen_for_hints();
  connect();
  log_.write(LogLevel::kInfo, "camlocd " CAMLOC_VERSION " started, source '%s', map %s", in_.config.source_url.c_str(),
             in_.config.map_path.c_str());
  notifier_.ready(board_.get().state_text.c_str());
  return Status::ok();
}

int Service::run() {
  while (!exit_code_) step(-1);
  notifier_.stopping();
  log_.write(LogLevel::kInfo, "stopping after %llu frames", static_cast<unsigned long long>(num_processed_));
  return *exit_code_;
}

void Service::step(int timeout_ms) {
  constexpr int kOwnFds = 4;
  std::array<pollfd, kOwnFds + ControlSocket::kMaxPollFds> fds{};
  fds[0] = {signal_fd_.get(), POLLIN, 0};
  fds[1] = {wake_fd_.get(), POLLIN, 0};
  fds[2] = {timer_fd_.get(), POLLIN, 0};
  fds[3] = {hint_listener_ ? hint_listener_->fd() : -1, POLLIN, 0};
  const std::span<pollfd> control_fds = std::span(fds).subspan(kOwnFds);
  const int num_control = control_ ? control_->prepare_poll(control_fds) : 0;
  if (::poll(fds.data(), static_cast<nfds_t>(kOwnFds + num_control), timeout_ms) <= 0) return;
  if (fds[0].revents != 0) on_signal();
  if (fds[1].revents != 0) on_wake();
  if (fds[2].revents != 0) on_tick();
  if (fds[3].revents != 0) hint_listener_->handle(realtime_ns());
  if (num_control > 0) {
    control_->handle(control_fds.first(static_cast<std::size_t>(num_control)), monotonic_ns(),
                     [this](const ControlRequest& request) { return on_control(request); });
  }
}

bool Service::stop() {
  control_.reset();
  coarse_.reset();
  return capture_ == nullptr || capture_->stop(kStopPatience);
}

void Service::on_signal() {
  signalfd_siginfo info{};
  while (::read(signal_fd_.get(), &info, sizeof(info)) == static_cast<ssize_t>(sizeof(info))) {
    if (info.ssi_signo == SIGHUP) {
      [[maybe_unused]] const Status status = reload();  // logged there
    } else {
      exit_code_ = 0;
    }
  }
}

void Service::on_wake() {
  drain(wake_fd_.get());
  // The report is read before the frame: when it says that the recording is over, the last frame is in the mailbox.
  const std::uint64_t number = capture_->report_number();
  const bool is_new = number != report_number_;
  CaptureReport report;
  if (is_new) {
    report = capture_->report();
    adopt_source(report);
  }
  const CapturedFrame* frame = capture_->mailbox().take();
  if (frame != nullptr && camera_ && !exit_code_) on_frame(*frame);
  if (is_new) on_phase(report);
  report_number_ = number;
}

void Service::on_tick() {
  drain(timer_fd_.get());
  const std::int64_t now_ns = monotonic_ns();
  feed_watchdog(now_ns);
  if (control_) control_->expire(now_ns);
  check_camera(now_ns);
  if (now_ns < next_second_ns_) return;
  next_second_ns_ = now_ns + kSecond_ns;

  connect();
  if (map_.is_loaded()) check_map_file();
  retry_map();
  check_coarse();
  board_.close_window(now_ns);
  publish_status();
  notifier_.status(board_.get().state_text.c_str());
}

// The first source decides what poses are computed with; a device that was put in another's place brings its own calibration.
void Service::adopt_source(const CaptureReport& report) {
  if (!report.was_open) return;
  is_live_ = report.info.stamp_clock == StampClock::kMonotonic;
  if (report.info.description == adopted_source_ && camera_) return;
  Result<RgbdCamera> camera = match_camera(in_.config, in_.camera, report.info);
  if (!camera) return fail(camera.status());
  adopted_source_ = report.info.description;
  is_size_checked_ = false;
  if (camera_ && format_camera_toml(*camera_) == format_camera_toml(*camera)) return;
  if (camera_ && map_.is_loaded()) {
    log_.write(LogLevel::kInfo, "another camera: the map is opened anew with its calibration");
    coarse_.reset();
    map_.drop();
  }
  camera_ = std::move(camera).value();
  retry_map();
}

void Service::on_phase(const CaptureReport& report) {
  is_streaming_ = report.phase == CapturePhase::kStreaming;
  is_over_ = report.phase == CapturePhase::kEnded;
  const bool was_stalled = std::exchange(is_stalled_, report.phase == CapturePhase::kStalled);
  board_.set_camera_state(to_string(report.phase));
  switch (report.phase) {
    case CapturePhase::kOpening: break;
    case CapturePhase::kStreaming:
      last_frame_ns_ = monotonic_ns();
      source_trouble_.clear();
      log_.write(LogLevel::kInfo, "%s: %s", was_stalled ? "frames arrive again" : "source open", report.info.description.c_str());
      if (!was_stalled) {
        for (const std::string& note : report.info.notes) log_.write(LogLevel::kWarning, "%s", note.c_str());
      }
      break;
    case CapturePhase::kStalled:
      log_.write(LogLevel::kWarning, "camera stalled: %s", report.problem.c_str());
      set_state(State::kNoCamera, report.problem.c_str());
      break;
    case CapturePhase::kUnavailable:
      if (source_trouble_.is_new(report.problem)) log_.write(LogLevel::kWarning, "no camera: %s", report.problem.c_str());
      set_state(State::kNoCamera, report.problem.c_str());
      break;
    case CapturePhase::kEnded:
      set_state(State::kNoCamera, "recording over");
      if (in_.config.source_exit_at_end && !exit_code_) exit_code_ = 0;
      break;
  }
}

// What the capture thread cannot report itself: a driver that does not come back from a call, or brings nothing whole.
void Service::check_camera(std::int64_t now_ns) {
  constexpr std::int64_t kMargin_ns = 200'000'000;  // the capture thread is the first to say so
  if (!is_live_ || !is_streaming_ || num_processed_ == 0) return;
  if (now_ns - last_frame_ns_ <= in_.config.source_stall_ms * 1'000'000 + kMargin_ns) return;
  set_state(State::kNoCamera, "the camera is open but no whole frame arrives");
}

void Service::on_frame(const CapturedFrame& captured) {
  const Frame frame = captured.buffer.view();
  if (!is_size_checked_) {
    is_size_checked_ = true;
    FrameSourceInfo first;
    first.color_width = frame.gray.width;
    first.color_height = frame.gray.height;
    if (const Result<RgbdCamera> camera = match_camera(in_.config, camera_, first); !camera) return fail(camera.status());
  }
  const Localization& localization = localize(frame);

  PoseContext context;
  context.reset_offset = reset_offset_;
  context.is_capture_clock_ours = is_live_;
  context.now_epoch_ns = realtime_ns();
  if (is_live_) context.stamp_to_epoch_ns = context.now_epoch_ns - monotonic_ns();
  if (map_.is_loaded()) {
    context.map_id = map_.info().map_id;
    if (in_.config.publish_frame == "wcs") context.datum = &*map_.info().wcs;
  }
  if (sink_->publish(make_pose_report(localization, context))) ++board_.counters().poses_published;

  ++num_processed_;
  last_frame_ns_ = monotonic_ns();
  board_.add_frame(localization, last_frame_ns_ - captured.received_ns);
  report_state(localization);
  feed_watchdog(last_frame_ns_);
}

const Localization& Service::localize(const Frame& frame) {
  if (map_.is_loaded()) {
    pass_hint_on();
    if (const auto hint = coarse_ ? coarse_->take() : std::nullopt) map_.localizer().coarse_hint(*hint);
    const Localization& localization = map_.localizer().process(frame);
    const bool is_lost = localization.state == State::kLost || localization.state == State::kCoarse;
    if (coarse_ && is_lost && !map_.is_damaged()) coarse_->offer(frame);
    // What was read from a page that is gone is not to be believed.
    if (!map_.is_damaged()) {
      num_resets_ = localization.reset_counter;
      report_calibration();
      return localization;
    }
    drop_map("a part of the map file is gone: it was truncated while in use");
  }
  no_map_.sequence = frame.sequence;
  no_map_.stamp_ns = frame.stamp_ns;
  return no_map_;
}

void Service::report_state(const Localization& localization) {
  std::array<char, 64> inliers{};
  const char* text = to_string(localization.reason);
  if (localization.state == State::kNoMap) text = map_trouble_.last().empty() ? "no map is open" : map_trouble_.last().c_str();
  if (localization.state == State::kLocalized) {
    std::snprintf(inliers.data(), inliers.size(), "%u inliers of %u matches", localization.evidence.num_inliers,
                  localization.evidence.num_matches);
    text = inliers.data();
  }
  set_state(localization.state, text);
}

void Service::report_calibration() {
  const CalibrationHealth& health = map_.localizer().calibration();
  const bool was_suspect = board_.get().is_calibration_suspect;
  board_.counters().is_calibration_suspect = health.is_suspect;
  board_.counters().focal_scale = health.focal_scale;
  if (health.is_suspect == was_suspect) return;
  if (health.is_suspect) {
    log_.write(LogLevel::kWarning, "calibration: the images fit the map with %.3f times the focal length of the camera file",
               health.focal_scale);
  } else {
    log_.write(LogLevel::kInfo, "calibration: the focal length fits the map again");
  }
}

void Service::set_state(State state, const char* text) {
  const State before = board_.state();
  if (!board_.set_state(state, text)) return;
  log_.write(LogLevel::kInfo, "%s -> %s: %s", to_string(before), to_string(state), text);
  publish_status();
}

void Service::connect() {
  if (hint_listener_) {
    const Status status = hint_listener_->connect();
    if (!status && hint_trouble_.is_new(status.message()))
      log_.write(LogLevel::kWarning, "hints are not listened for: %s", status.message().c_str());
  }
  if (sink_->is_connected()) return;
  const Status status = sink_->connect();
  if (status) {
    log_.write(LogLevel::kInfo, "publishing on %s", in_.config.publish_lcm_url.c_str());
    route_trouble_.clear();
  } else if (route_trouble_.is_new(status.message())) {
    log_.write(LogLevel::kWarning, "poses are not published: %s", status.message().c_str());
  }
}

void Service::publish_status() {
  refresh_counters();
  board_.stamp(monotonic_ns(), realtime_ns());
  sink_->publish(board_.get());
}

// What the capture thread counts, as of now: between two messages the control socket asks, too.
void Service::refresh_counters() {
  if (capture_) board_.set_capture(capture_->counts(), capture_->mailbox().num_dropped());
  board_.counters().coarse_state = coarse_ ? to_string(coarse_->phase()) : "off";
  board_.counters().coarse_answers = coarse_ ? coarse_->num_answers() : 0;
  board_.counters().reset_counter = std::int64_t{reset_offset_} + num_resets_;
  board_.counters().log_lines_lost = log_.num_lost();
}

// Twice as often as asked for, and only while things move; see ProgressWatch.
void Service::feed_watchdog(std::int64_t now_ns) {
  const std::int64_t period_ns = notifier_.watchdog_ns();
  if (period_ns == 0 || now_ns - watchdog_fed_ns_ < period_ns / 4) return;
  ProgressWatch::Counters counters;
  counters.frames_processed = num_processed_;
  counters.is_capture_over = capture_ == nullptr || is_over_;
  if (capture_) {
    const CaptureCounts captured = capture_->counts();
    counters.capture_turns = captured.turns;
    counters.frames_captured = captured.frames_received;
  }
  if (!progress_.has_progressed(counters)) return;
  notifier_.watchdog();
  watchdog_fed_ns_ = now_ns;
}

void Service::fail(const Status& status) {
  log_.write(LogLevel::kError, "%s", status.message().c_str());
  exit_code_ = 2;
}

}  // namespace camloc
