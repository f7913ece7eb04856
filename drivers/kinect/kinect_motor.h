// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The base of a Kinect model 1414, a USB device of its own: tilt, accelerometer, LED. It may be missing and may fail; the camera
// does not care. (Models 1473 and K4W reach theirs through the audio device and its firmware, which camloc does not load.)
#pragma once

#include <libusb.h>

#include <Eigen/Core>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>

#include "core/base/result.h"
#include "drivers/kinect/kinect_protocol.h"
#include "drivers/kinect/kinect_usb.h"

namespace camloc::kinect {

/// Acceleration in the axes of the colour camera, m/s^2, from the motor's state of kMotorStateBytes bytes; nullopt for fewer
/// bytes, or where it is more than the sensor can measure. With the tilt at zero: the sensor sits in the head and turns with the
/// camera.
[[nodiscard]] std::optional<Eigen::Vector3d> parse_acceleration(std::span<const std::uint8_t> state);

/// Needs somebody to handle libusb's events of its context, until after it is destroyed.
class KinectMotor {
 public:
  /// nullptr: this Kinect has none.
  [[nodiscard]] static std::unique_ptr<KinectMotor> open(libusb_context* context, libusb_device* camera);
  ~KinectMotor();
  KinectMotor(const KinectMotor&) = delete;
  KinectMotor& operator=(const KinectMotor&) = delete;

  /// Against the horizon, degrees, clipped to what the joint can do; waits for the request, not for the motor.
  [[nodiscard]] Status set_tilt(double degrees);
  /// Does not wait; does nothing while the LED is that already, or another request is under way (call it again).
  void set_led(Led led);
  /// Starts a reading when the last is old enough; does not wait.
  void poll();
  [[nodiscard]] std::optional<Eigen::Vector3d> acceleration() const;

 private:
  static constexpr unsigned kTimeoutMs = 500;
  static constexpr std::chrono::milliseconds kPollInterval{100};
  static constexpr int kMaxFailures = 10;  ///< in a row; then the motor is left alone

  /// An asynchronous control transfer with its buffer.
  struct Request {
    UsbTransfer transfer{libusb_alloc_transfer(0)};
    std::array<std::uint8_t, LIBUSB_CONTROL_SETUP_SIZE + kMotorStateBytes> buffer{};
    std::atomic<bool> is_busy{false};
  };
  explicit KinectMotor(UsbHandle handle);
  [[nodiscard]] bool submit(Request* request, std::uint8_t direction, std::uint8_t request_code, std::uint16_t value, std::uint16_t length,
                            libusb_transfer_cb_fn callback);
  static void LIBUSB_CALL on_state(libusb_transfer* transfer);

  UsbHandle handle_;
  std::unique_ptr<Request> state_request_, led_request_;
  std::chrono::steady_clock::time_point last_poll_;
  std::optional<Led> led_;
  std::atomic<int> num_failures_{0};
  mutable std::mutex mutex_;  // of acceleration_
  std::optional<Eigen::Vector3d> acceleration_;
};

}  // namespace camloc::kinect
