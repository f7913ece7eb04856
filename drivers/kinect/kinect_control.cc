// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/kinect/kinect_control.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdio>
#include <string>

namespace camloc::kinect {

namespace {

constexpr std::uint16_t kManual = 1, kAutomatic = 2;  // of kControlExposureMode
constexpr std::uint16_t kResolution640 = 1;

std::string hexadecimal(std::uint16_t value) {
  char text[8];
  std::snprintf(text, sizeof(text), "0x%02x", value);
  return text;
}

}  // namespace

ControlRequest encode_request(Command command, std::uint16_t tag, std::span<const std::uint16_t> body) {
  assert(body.size() <= kMaxRequestWords);
  ControlRequest request;
  const auto put = [&request](std::size_t word) {
    request.bytes[request.size++] = static_cast<std::uint8_t>(word & 0xff);
    request.bytes[request.size++] = static_cast<std::uint8_t>(word >> 8 & 0xff);
  };
  put('G' | 'M' << 8);
  put(body.size());
  put(static_cast<std::uint16_t>(command));
  put(tag);
  for (const std::uint16_t word : body) put(word);
  return request;
}

ControlReply parse_reply(std::span<const std::uint8_t> bytes, Command command, std::uint16_t tag) {
  if (bytes.empty() || bytes.size() >= kMaxControlBytes) return {ReplyState::kNone, {}};
  if (bytes.size() < kControlHeaderBytes || bytes[0] != 'R' || bytes[1] != 'B') return {ReplyState::kCorrupt, {}};
  const std::size_t body_bytes = 2U * word_at(bytes, 2);
  if (word_at(bytes, 6) != tag) return {ReplyState::kStale, {}};
  if (word_at(bytes, 4) != static_cast<std::uint16_t>(command)) return {ReplyState::kCorrupt, {}};
  if (kControlHeaderBytes + body_bytes > bytes.size()) return {ReplyState::kCorrupt, {}};
  return {ReplyState::kOk, bytes.subspan(kControlHeaderBytes, body_bytes)};
}

Result<std::span<const std::uint8_t>> KinectControl::attempt(Command command, std::span<const std::uint16_t> body,
                                                             std::size_t min_body_bytes) {
  const ControlRequest request = encode_request(command, ++tag_, body);
  if (Status status = transport_->send({request.bytes.data(), request.size}); !status) return status;
  for (auto waited = std::chrono::microseconds(0); waited <= kReplyPatience; waited += kPollInterval) {
    const Result<std::size_t> size = transport_->receive(reply_);
    if (!size) return size.status();
    const ControlReply reply = parse_reply({reply_.data(), std::min(*size, reply_.size())}, command, tag_);
    if (reply.state == ReplyState::kCorrupt) return Status(ErrorCode::kCorrupt, "the device answers nonsense");
    if (reply.state == ReplyState::kOk) {
      // A refusal is its status word and nothing else.
      const bool is_refusal = reply.body.size() >= 2 && word_at(reply.body, 0) != 0;
      if (is_refusal || reply.body.size() >= std::max<std::size_t>(min_body_bytes, 2)) return reply.body;
      return Status(ErrorCode::kCorrupt,
                    "the answer has " + std::to_string(reply.body.size()) + " bytes, expected " + std::to_string(min_body_bytes));
    }
    transport_->pause(kPollInterval);
  }
  return Status(ErrorCode::kTimeout, "no answer within " + std::to_string(kReplyPatience.count()) + " ms");
}

Result<std::span<const std::uint8_t>> KinectControl::command(Command command, std::span<const std::uint16_t> body,
                                                             std::size_t min_body_bytes) {
  Status problem;
  for (int i = 0; i < kMaxAttempts; ++i) {
    Result<std::span<const std::uint8_t>> reply = attempt(command, body, min_body_bytes);
    if (reply) return reply;
    problem = reply.status();
    if (problem.code() == ErrorCode::kUnavailable) break;
  }
  return problem.with_context("Kinect command " + hexadecimal(static_cast<std::uint16_t>(command)));
}

Status KinectControl::write_register(Register address, std::uint16_t value) {
  const std::uint16_t body[] = {static_cast<std::uint16_t>(address), value};
  const auto reply = command(Command::kWriteRegister, body, 2);
  if (!reply) return reply.status();
  if (const std::uint16_t refusal = word_at(*reply, 0); refusal != 0) {
    return {ErrorCode::kInvalid, "Kinect register " + hexadecimal(body[0]) + " does not take " + std::to_string(value) + " (status " +
                                     std::to_string(refusal) + ")"};
  }
  return Status::ok();
}

Status KinectControl::write_registers(std::initializer_list<std::pair<Register, std::uint16_t>> values) {
  for (const auto& [address, value] : values) {
    if (Status status = write_register(address, value); !status) return status;
  }
  return Status::ok();
}

Status KinectControl::start_color() {
  return write_registers({{Register::kColorStream, 0},
                          {Register::kColorFormat, 0},
                          {Register::kColorResolution, kResolution640},
                          {Register::kColorRate, kFrameRateHz},
                          {Register::kColorStream, 1},
                          {Register::kColorMirror, 0}});
}

Status KinectControl::start_depth() {
  return write_registers({{Register::kProjectorCycle, 0},
                          {Register::kDepthStream, 0},
                          {Register::kDepthFormat, 3},
                          {Register::kDepthResolution, kResolution640},
                          {Register::kDepthRate, kFrameRateHz},
                          {Register::kDepthStream, 2},
                          {Register::kDepthMirror, 0}});
}

Result<std::span<const std::uint8_t>> KinectControl::algorithm_parameter(AlgorithmParameter parameter, std::size_t bytes) {
  const std::uint16_t body[] = {static_cast<std::uint16_t>(parameter), 0, kResolution640, kFrameRateHz, 0};
  return command(Command::kAlgorithm, body, bytes);
}

Result<KinectCalibration> KinectControl::read_calibration() {
  // The body of each is used up before the next request.
  KinectCalibration calibration;
  const auto registration = algorithm_parameter(AlgorithmParameter::kRegistration, kRegistrationBodyBytes);
  if (!registration) return registration.status();
  calibration.registration = parse_registration(*registration);
  const auto padding = algorithm_parameter(AlgorithmParameter::kRegistrationPadding, kPaddingBodyBytes);
  if (!padding) return padding.status();
  calibration.padding_start_lines = parse_padding(*padding).value_or(0);
  const auto const_shift = algorithm_parameter(AlgorithmParameter::kConstShift, kConstShiftBodyBytes);
  if (!const_shift) return const_shift.status();
  calibration.const_shift = parse_const_shift(*const_shift);
  constexpr std::uint16_t kFromStart[5] = {};
  const auto zero_plane = command(Command::kFixedParameters, kFromStart, kZeroPlaneOffset + 16);
  if (!zero_plane) return zero_plane.status();
  calibration.zero_plane = parse_zero_plane(*zero_plane);
  return calibration;
}

// ---- colour sensor of model 1414

Result<std::uint16_t> KinectControl::read_sensor(std::uint16_t address) {
  const std::uint16_t body[] = {1, address, 0};
  const auto reply = command(Command::kSensorRegister, body, 6);
  if (!reply) return reply.status();
  if (reply->size() < 6) return Status(ErrorCode::kUnsupported, "the colour sensor of this Kinect cannot be read");
  return word_at(*reply, 4);
}

Status KinectControl::write_sensor(std::uint16_t address, std::uint16_t value, std::uint16_t mask) {
  const std::uint16_t body[] = {1, static_cast<std::uint16_t>(address | 0x8000U), value};
  if (const auto reply = command(Command::kSensorRegister, body, 2); !reply) return reply.status();
  const Result<std::uint16_t> now = read_sensor(address);
  if (!now) return now.status();
  if (((*now ^ value) & mask) != 0)
    return {ErrorCode::kUnsupported, "the colour sensor of this Kinect ignores register " + hexadecimal(address)};
  return Status::ok();
}

Status KinectControl::set_sensor_mode(std::uint16_t bit, bool is_on) {
  const Result<std::uint16_t> mode = read_sensor(kSensorMode);
  if (!mode) return mode.status();
  return write_sensor(kSensorMode, static_cast<std::uint16_t>(is_on ? *mode | bit : *mode & ~bit), bit);
}

Status KinectControl::set_color_1414(const ColorControls& controls) {
  if (controls.gain) return {ErrorCode::kUnsupported, "gain cannot be set on Kinect model 1414"};
  const bool is_manual = controls.exposure_us.has_value();
  if (is_manual || controls.auto_exposure) {
    if (Status status = set_sensor_mode(kSensorModeAutoExposure, !is_manual && *controls.auto_exposure); !status) return status;
  }
  if (is_manual) {
    const double rows = std::clamp(std::round(*controls.exposure_us / kSensorRowUs), 1.0, 65535.0);
    if (Status status = write_sensor(kSensorShutterRows, static_cast<std::uint16_t>(rows), 0xffff); !status) return status;
  }
  return controls.auto_white_balance ? set_sensor_mode(kSensorModeAutoWhiteBalance, *controls.auto_white_balance) : Status::ok();
}

// ---- colour sensor of model 1473 and K4W

Result<bool> KinectControl::set_control(std::span<const std::uint16_t> write, std::span<const std::uint16_t> read, std::uint16_t value) {
  if (const auto reply = command(Command::kCameraControl, write, 2); !reply) return reply.status();
  const auto reply = command(Command::kCameraControl, read, 8);
  if (!reply) return reply.status();
  return reply->size() >= 8 && word_at(*reply, 6) == value;
}

Status KinectControl::write_control_word(std::uint16_t control, std::uint16_t value) {
  const std::uint16_t write[] = {1, control, value}, read[] = {1, kControlReadWord, control};
  const Result<bool> is_set = set_control(write, read, value);
  if (!is_set || *is_set) return is_set.status();
  return {ErrorCode::kUnsupported, "this Kinect ignores colour control " + hexadecimal(control)};
}

Status KinectControl::set_exposure_mode(bool is_automatic) {
  const std::uint16_t mode = is_automatic ? kAutomatic : kManual;
  const std::uint16_t write[] = {2, kControlWriteByte, kControlExposureMode, kControlByteValue, mode};
  const std::uint16_t read[] = {1, kControlReadByte, kControlExposureMode};
  const Result<bool> is_set = set_control(write, read, mode);
  if (!is_set || *is_set) return is_set.status();
  return {ErrorCode::kUnsupported, "this Kinect does not change its exposure mode"};
}

Status KinectControl::set_color_1473(const ColorControls& controls) {
  if (controls.auto_white_balance) return {ErrorCode::kUnsupported, "white balance can be set on Kinect model 1414 only"};
  const bool is_manual = controls.exposure_us || controls.gain;
  if (is_manual || controls.auto_exposure) {
    if (Status status = set_exposure_mode(!is_manual && *controls.auto_exposure); !status) return status;
  }
  if (controls.exposure_us) {
    const auto hundreds_us = static_cast<std::uint32_t>(std::max(1, *controls.exposure_us / 100));
    Status status = write_control_word(kControlExposureHigh, static_cast<std::uint16_t>(hundreds_us >> 16));
    if (status) status = write_control_word(kControlExposureLow, static_cast<std::uint16_t>(hundreds_us & 0xffff));
    if (!status) return status;
  }
  return controls.gain ? write_control_word(kControlGain, static_cast<std::uint16_t>(std::lround(*controls.gain * 32))) : Status::ok();
}

Status KinectControl::set_color(const ColorControls& controls, bool is_1414) {
  return is_1414 ? set_color_1414(controls) : set_color_1473(controls);
}

}  // namespace camloc::kinect
