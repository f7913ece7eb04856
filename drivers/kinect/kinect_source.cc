// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The way of a frame: IsoStream > KinectReceiver (event thread) > next(): pair, stamp, demosaic, register.
#include "drivers/kinect/kinect_source.h"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "drivers/device_clock.h"
#include "drivers/kinect/kinect_depth.h"
#include "drivers/kinect/kinect_device.h"
#include "drivers/kinect/kinect_motor.h"
#include "drivers/kinect/kinect_options.h"
#include "drivers/raw_pixels.h"

namespace camloc {

namespace kinect {

namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr auto kHalfPeriodTicks = static_cast<std::int32_t>(kDeviceClockHz / kFrameRateHz / 2);
constexpr std::size_t kNumPixels = static_cast<std::size_t>(kWidth) * kHeight;
/// Depth that belongs to a colour image is complete at most a period later; its packets then take their time.
constexpr milliseconds kDepthPatience{50};
/// Without packets for this long a stream stands still, and so does the source.
constexpr milliseconds kSilence{200};

steady_clock::time_point time_of(std::int64_t monotonic_ns) { return steady_clock::time_point(std::chrono::nanoseconds(monotonic_ns)); }

class KinectSource final : public FrameSource {
 public:
  [[nodiscard]] static Result<std::unique_ptr<FrameSource>> open(const KinectOptions& kinect_options, const FrameSourceOptions& options) {
    std::unique_ptr<KinectSource> source(new KinectSource(kinect_options, options));
    if (Status status = source->connect(); !status) return status;
    return std::unique_ptr<FrameSource>(std::move(source));
  }

  ~KinectSource() override {
    if (device_ == nullptr) return;
    stop_streams();
    if (motor_ && kinect_options_.is_led_status) motor_->set_led(Led::kBlinkGreen);  // as after power-up: nobody is using it
  }

  [[nodiscard]] const FrameSourceInfo& info() const override { return info_; }

  // Every turn takes or gives back a frame, or waits until the deadline, so that it ends.
  [[nodiscard]] Status next(FrameBuffer* frame, milliseconds timeout) override {
    const steady_clock::time_point deadline = steady_clock::now() + timeout;
    if (motor_) motor_->poll();
    while (true) {
      if (is_reset_ || receiver_.report().is_gone) return {ErrorCode::kUnavailable, info_.description + ": the Kinect is gone"};
      const steady_clock::time_point now = steady_clock::now();
      if (color_ == nullptr) color_ = receiver_.take(Stream::kColor);
      if (depth_ == nullptr && has_depth()) depth_ = receiver_.take(Stream::kDepth);
      switch (pairing(now)) {
        case Pairing::kPair: deliver(true, frame); return Status::ok();
        case Pairing::kColorAlone:
          if (!has_depth() || !is_depth_silent(now)) {
            num_unpaired_ += has_depth() ? 1 : 0;
            deliver(false, frame);
            return Status::ok();
          }
          give_back(Stream::kColor, &color_);  // half a camera is a stall, too
          break;
        case Pairing::kDropDepth:
          ++num_unpaired_;
          give_back(Stream::kDepth, &depth_);
          break;
        case Pairing::kWait:
          if (Status status = check_incomplete(); !status) return status;
          if (now >= deadline) return stalled(timeout);
          receiver_.wait_until(color_ ? std::min(deadline, time_of(color_->complete_ns) + kDepthPatience + milliseconds(1)) : deadline);
          break;
      }
    }
  }

  [[nodiscard]] FrameSourceHealth health() const override {
    const ReceiverReport report = receiver_.report();
    FrameSourceHealth health;
    for (std::size_t i = 0; i < kNumStreams; ++i) {
      health.packets_lost += std::max(report.counts[i].lost, report.transport_errors[i]);
      health.frames_incomplete += report.counts[i].frames_incomplete;
    }
    health.frames_unpaired = num_unpaired_;
    health.clock_drift_ppm = clock_.drift_ppm();
    if (motor_) health.acceleration = motor_->acceleration();
    return health;
  }

  [[nodiscard]] Status restart() override {
    if (is_reset_ || receiver_.report().is_gone) return {ErrorCode::kUnavailable, info_.description + ": the Kinect is gone"};
    stop_streams();
    receiver_.restart();
    clock_.reset();
    num_incomplete_ = receiver_.report().counts[static_cast<std::size_t>(Stream::kColor)].frames_incomplete;
    if (Status status = start_streams(); !status) return {ErrorCode::kUnavailable, status.message()};
    return Status::ok();
  }

  [[nodiscard]] Status reset_device() override {
    stop_streams();
    is_reset_ = true;
    motor_.reset();  // sits behind the same hub
    return device_->reset();
  }

 private:
  KinectSource(KinectOptions kinect_options, const FrameSourceOptions& options)
      : kinect_options_(std::move(kinect_options)), wants_color_(options.wants_color), raw_depth_(kNumPixels), clock_(kDeviceClockHz) {}
  [[nodiscard]] bool has_depth() const { return kinect_options_.depth != DepthMode::kOff; }

  [[nodiscard]] Status connect() {
    Result<std::unique_ptr<KinectDevice>> device = KinectDevice::open(kinect_options_.selector, &receiver_);
    if (!device) return device.status();
    device_ = std::move(device).value();
    control_ = std::make_unique<KinectControl>(device_.get());
    if (has_depth()) {
      Result<KinectCalibration> calibration = control_->read_calibration();
      if (!calibration) return calibration.status();
      calibration_ = *calibration;
      depth_table_ = make_depth_table(calibration_);
      if (kinect_options_.depth == DepthMode::kRegistered) registration_ = DepthRegistration::create(calibration_, depth_table_);
    }
    describe();
    if (Status status = set_up_motor(); !status) return status;
    return start_streams();
  }

  [[nodiscard]] Status set_up_motor() {
    motor_ = KinectMotor::open(device_->context(), device_->usb_device());
    if (motor_ == nullptr) {
      if (!kinect_options_.tilt_deg && !kinect_options_.fixed_led) return Status::ok();
      return {ErrorCode::kUnsupported,
              device_->camera().model() + ": tilt and LED need its motor device (045e:02b0), which is not there or not permitted"};
    }
    if (kinect_options_.fixed_led) motor_->set_led(*kinect_options_.fixed_led);
    return kinect_options_.tilt_deg ? motor_->set_tilt(*kinect_options_.tilt_deg) : Status::ok();
  }

  void describe() {
    const OpenCamera& camera = device_->camera();
    info_.serial = camera.serial;
    info_.color_width = kWidth;
    info_.color_height = kHeight;
    info_.stamp_clock = StampClock::kMonotonic;
    const bool is_registered = !has_depth() || registration_.has_value();
    info_.camera = nominal_camera(calibration_, is_registered);
    if (has_depth()) {
      info_.depth_width = kWidth;
      info_.depth_height = kHeight;
    }
    info_.description = camera.model() + (camera.serial.empty() ? "" : " " + camera.serial) + ", " + camera.location + ", depth " +
                        (!has_depth()    ? "off"
                         : is_registered ? "registered"
                                         : "not registered") +
                        (has_depth() && !(calibration_.zero_plane && calibration_.const_shift) ? ", generic depth scale" : "");
  }

  [[nodiscard]] Status start_streams() {
    if (Status status = device_->start_transfers(has_depth()); !status) return status;
    const bool is_1414 = device_->camera().product == kProductCamera && device_->camera().release == kReleaseOf1414;
    Status status = has_depth() ? control_->start_depth() : Status::ok();  // first, or the first colour image has none
    if (status) status = control_->start_color();
    if (status) status = control_->set_color(kinect_options_.color, is_1414);
    if (!status) device_->stop_transfers();
    return status;
  }

  void stop_streams() {
    // A device that is gone or hangs cannot be asked to stop; the transfers end all the same.
    if (!receiver_.report().is_gone && !is_reset_) {
      if (control_->stop_color() && has_depth()) static_cast<void>(control_->stop_depth());
    }
    device_->stop_transfers();
    give_back(Stream::kColor, &color_);
    give_back(Stream::kDepth, &depth_);
  }

  void give_back(Stream stream, RawFrame** frame) {
    if (*frame != nullptr) receiver_.release(stream, std::exchange(*frame, nullptr));
  }

  [[nodiscard]] bool is_depth_silent(steady_clock::time_point now) const {
    const std::int64_t last_ns = receiver_.report().last_packet_ns[static_cast<std::size_t>(Stream::kDepth)];
    return now - time_of(last_ns) > kSilence;
  }

  [[nodiscard]] Pairing pairing(steady_clock::time_point now) const {
    if (color_ == nullptr) return Pairing::kWait;
    if (!has_depth()) return Pairing::kColorAlone;
    const bool is_overdue = now - time_of(color_->complete_ns) > kDepthPatience;
    return decide_pairing(color_->device_stamp, depth_ ? std::optional(depth_->device_stamp) : std::nullopt, is_overdue, kHalfPeriodTicks);
  }

  void deliver(bool with_depth, FrameBuffer* frame) {
    frame->sequence = sequence_++;
    frame->stamp_ns = clock_.host_time_ns(color_->device_stamp, color_->arrival_ns);
    const ImageView<std::uint8_t> mosaic{color_->bytes.data(), kWidth, kHeight, kWidth};
    bayer_to_gray(mosaic, BayerOrder::kGrbg, &frame->gray);
    if (wants_color_) {
      bayer_to_bgr(mosaic, BayerOrder::kGrbg, &frame->color);
    } else {
      frame->color.resize(0, 0);
    }
    if (with_depth) {
      convert_depth_image(frame);
      give_back(Stream::kDepth, &depth_);
    } else {
      frame->depth.resize(0, 0);
    }
    give_back(Stream::kColor, &color_);
    show(Led::kGreen);
  }

  void convert_depth_image(FrameBuffer* frame) {
    unpack_pixels(depth_->bytes.data(), kNumPixels, 11, raw_depth_.data());
    if (registration_) {
      registration_->apply(raw_depth_, &frame->depth);
    } else {
      frame->depth.resize(kWidth, kHeight);
      convert_depth(raw_depth_, depth_table_, frame->depth.pixels.data());
    }
  }

  void show(Led led) {
    if (motor_ && kinect_options_.is_led_status) motor_->set_led(led);
  }

  // Tells a camera whose packets get lost from one that stands still.
  [[nodiscard]] Status check_incomplete() {
    const PacketCounts counts = receiver_.report().counts[static_cast<std::size_t>(Stream::kColor)];
    if (counts.frames_incomplete == num_incomplete_) return Status::ok();
    num_incomplete_ = counts.frames_incomplete;
    return {ErrorCode::kCorrupt, info_.description + ": packets of a colour image were lost (" + std::to_string(counts.lost) +
                                     " so far); is the USB controller busy with other devices?"};
  }

  [[nodiscard]] Status stalled(milliseconds timeout) {
    show(Led::kBlinkRedYellow);
    if (Status problem = device_->transfer_problem(); !problem) return {ErrorCode::kTimeout, info_.description + ": " + problem.message()};
    const ReceiverReport report = receiver_.report();
    const std::uint64_t errors = report.transport_errors[0] + report.transport_errors[1];
    const std::uint64_t packets = report.counts[0].packets + report.counts[1].packets;
    const bool is_bandwidth = errors > packets / 10;
    return {ErrorCode::kTimeout, info_.description + ": no complete frame in " + std::to_string(timeout.count()) + " ms" +
                                     (is_bandwidth ? " (" + std::to_string(errors) + " USB packets failed, " + std::to_string(packets) +
                                                         " arrived: too little USB bandwidth? plug it into a USB controller of its own)"
                                                   : "")};
  }

  KinectOptions kinect_options_;
  bool wants_color_;
  FrameSourceInfo info_;
  KinectCalibration calibration_;  // this and how depth is read are fixed from open to close
  DepthTable depth_table_{};
  std::optional<DepthRegistration> registration_;
  std::vector<std::uint16_t> raw_depth_;
  CounterClock clock_;
  KinectReceiver receiver_;
  std::unique_ptr<KinectDevice> device_;
  std::unique_ptr<KinectControl> control_;
  std::unique_ptr<KinectMotor> motor_;  // after device_, whose thread handles its events
  RawFrame* color_ = nullptr;           // taken from the receiver, not yet delivered
  RawFrame* depth_ = nullptr;
  std::uint64_t sequence_ = 0, num_unpaired_ = 0, num_incomplete_ = 0;
  bool is_reset_ = false;
};

}  // namespace

}  // namespace kinect

Result<std::unique_ptr<FrameSource>> open_kinect_source(const SourceUrl& url, const FrameSourceOptions& options) {
  const Result<kinect::KinectOptions> kinect_options = kinect::parse_kinect_options(url);
  if (!kinect_options) return kinect_options.status();
  return kinect::KinectSource::open(*kinect_options, options);
}

}  // namespace camloc
