// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/fakes/kinect_model.h"

namespace camloc::fakes {
namespace {

constexpr std::uint8_t kSetLed = 0x06, kIdentify = 0x10, kSetTilt = 0x31, kGetState = 0x32;
constexpr std::uint8_t kStopped = 0, kMoving = 4;
constexpr double kTurnRateDegS = 27, kLimitDeg = 31;

}  // namespace

KinectMotor::KinectMotor(UsbDescriptors descriptors, std::array<std::int16_t, 3> level_counts)
    : UsbFunction(std::move(descriptors)), level_counts_(level_counts) {}

void KinectMotor::reset(std::int64_t now_ns) {
  start_deg_ = target_deg_ = angle_deg(now_ns);
  start_ns_ = now_ns;
  led_ = 0;
}

double KinectMotor::angle_deg(std::int64_t now_ns) const {
  const double turned = kTurnRateDegS * static_cast<double>(now_ns - start_ns_) * 1e-9;
  const double to_go = target_deg_ - start_deg_;
  return start_deg_ + std::copysign(std::min(std::abs(to_go), turned), to_go);
}

ControlReply KinectMotor::vendor_request(const UsbSetup& setup, std::span<const std::uint8_t> /*data_out*/, std::int64_t now_ns) {
  if (setup.is_in() && setup.request == kIdentify) return {false, {0x22}};
  if (setup.is_in() && setup.request == kGetState) return {false, state(now_ns)};
  if (!setup.is_in() && setup.request == kSetLed && setup.value <= 7) {
    led_ = setup.value;
    return {};
  }
  if (!setup.is_in() && setup.request == kSetTilt) {
    start_deg_ = angle_deg(now_ns);
    start_ns_ = now_ns;
    target_deg_ = std::clamp(static_cast<std::int16_t>(setup.value) / 2.0, -kLimitDeg, kLimitDeg);
    return {};
  }
  return {true, {}};
}

std::vector<std::uint8_t> KinectMotor::state(std::int64_t now_ns) const {
  constexpr std::uint8_t kAngleUnknown = 0x80;  // while it moves
  const double angle = angle_deg(now_ns);
  const bool is_moving = std::abs(angle - target_deg_) > 1e-9;
  // The head turns about the sensor's x axis: gravity moves from y to z.
  const double tilt_rad = angle * std::numbers::pi / 180;
  const double y = level_counts_[1] * std::cos(tilt_rad) - level_counts_[2] * std::sin(tilt_rad);
  const double z = level_counts_[1] * std::sin(tilt_rad) + level_counts_[2] * std::cos(tilt_rad);
  std::vector<std::uint8_t> bytes = {0, 0};
  for (const double counts : {static_cast<double>(level_counts_[0]), y, z}) {
    const auto value = static_cast<std::uint16_t>(static_cast<std::int16_t>(std::lround(counts)));
    bytes.push_back(static_cast<std::uint8_t>(value >> 8));  // big endian
    bytes.push_back(static_cast<std::uint8_t>(value));
  }
  bytes.push_back(is_moving ? kAngleUnknown : static_cast<std::uint8_t>(static_cast<std::int8_t>(std::lround(2 * angle))));
  bytes.push_back(is_moving ? kMoving : kStopped);
  return bytes;
}

}  // namespace camloc::fakes
