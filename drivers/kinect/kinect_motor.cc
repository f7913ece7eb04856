// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/kinect/kinect_motor.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <thread>

#include "core/geometry/gravity.h"

namespace camloc::kinect {

namespace {

constexpr double kMaxAcceleration = 4 * kStandardGravity;  // twice the range of the sensor

}  // namespace

std::optional<Eigen::Vector3d> parse_acceleration(std::span<const std::uint8_t> state) {
  if (state.size() < kMotorStateBytes) return std::nullopt;
  const auto counts = [state](std::size_t at) { return static_cast<double>(static_cast<std::int16_t>(state[at] << 8 | state[at + 1])); };
  const Eigen::Vector3d sensor = Eigen::Vector3d(counts(2), counts(4), counts(6)) * (kStandardGravity / kAccelerationCountsPerG);
  if (sensor.norm() > kMaxAcceleration) return std::nullopt;
  return kinect_R_camera_accelerometer() * sensor;
}

std::unique_ptr<KinectMotor> KinectMotor::open(libusb_context* context, libusb_device* camera) {
  UsbHandle handle = open_motor(context, camera);
  if (!handle) return nullptr;
  std::unique_ptr<KinectMotor> motor(new KinectMotor(std::move(handle)));
  if (!motor->state_request_->transfer || !motor->led_request_->transfer) return nullptr;
  return motor;
}

KinectMotor::KinectMotor(UsbHandle handle)
    : handle_(std::move(handle)), state_request_(std::make_unique<Request>()), led_request_(std::make_unique<Request>()) {}

KinectMotor::~KinectMotor() {
  constexpr std::chrono::milliseconds kGrace{100};  // for a last word to the LED; what is not through by then is cancelled
  const auto start = std::chrono::steady_clock::now();
  for (std::unique_ptr<Request>* request : {&led_request_, &state_request_}) {
    while ((*request)->is_busy && std::chrono::steady_clock::now() - start < std::chrono::milliseconds(kTimeoutMs)) {
      if (std::chrono::steady_clock::now() - start > kGrace) libusb_cancel_transfer((*request)->transfer.get());
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    if ((*request)->is_busy) static_cast<void>(request->release());  // libusb may still write to it
  }
}

Status KinectMotor::set_tilt(double degrees) {
  const double clipped = std::clamp(degrees, -1.0 * kMaxTiltDeg, 1.0 * kMaxTiltDeg);
  const auto half_degrees = static_cast<std::int16_t>(std::lround(2 * clipped));
  errno = 0;
  const int code = libusb_control_transfer(handle_.get(), kVendorOut, kMotorSetTilt, static_cast<std::uint16_t>(half_degrees), 0, nullptr,
                                           0, kTimeoutMs);
  return code < 0 ? usb_error(code, errno, "Kinect motor") : Status::ok();
}

bool KinectMotor::submit(Request* request, std::uint8_t direction, std::uint8_t request_code, std::uint16_t value, std::uint16_t length,
                         libusb_transfer_cb_fn callback) {
  if (request->is_busy || num_failures_ >= kMaxFailures) return false;
  libusb_fill_control_setup(request->buffer.data(), direction, request_code, value, 0, length);
  libusb_fill_control_transfer(request->transfer.get(), handle_.get(), request->buffer.data(), callback, this, kTimeoutMs);
  request->is_busy = true;
  if (libusb_submit_transfer(request->transfer.get()) == LIBUSB_SUCCESS) return true;
  request->is_busy = false;
  ++num_failures_;
  return false;
}

void KinectMotor::set_led(Led led) {
  if (led_ == led) return;
  const auto on_led = [](libusb_transfer* transfer) { static_cast<KinectMotor*>(transfer->user_data)->led_request_->is_busy = false; };
  if (submit(led_request_.get(), kVendorOut, kMotorSetLed, static_cast<std::uint16_t>(led), 0, on_led)) led_ = led;
}

void KinectMotor::poll() {
  const auto now = std::chrono::steady_clock::now();
  if (now - last_poll_ < kPollInterval) return;
  if (submit(state_request_.get(), kVendorIn, kMotorGetState, 0, kMotorStateBytes, &KinectMotor::on_state)) last_poll_ = now;
}

void LIBUSB_CALL KinectMotor::on_state(libusb_transfer* transfer) {
  auto* const motor = static_cast<KinectMotor*>(transfer->user_data);
  const bool is_good = transfer->status == LIBUSB_TRANSFER_COMPLETED;
  const auto size = static_cast<std::size_t>(std::max(0, is_good ? transfer->actual_length : 0));
  const auto acceleration = parse_acceleration({libusb_control_transfer_get_data(transfer), std::min(size, kMotorStateBytes)});
  motor->num_failures_ = acceleration ? 0 : motor->num_failures_ + 1;
  {
    const std::lock_guard lock(motor->mutex_);
    motor->acceleration_ = acceleration;
  }
  motor->state_request_->is_busy = false;
}

std::optional<Eigen::Vector3d> KinectMotor::acceleration() const {
  const std::lock_guard lock(mutex_);
  return acceleration_;
}

}  // namespace camloc::kinect
