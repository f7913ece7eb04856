// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/kinect/kinect_control.h"

#include <gtest/gtest.h>

#include <cstring>
#include <deque>
#include <functional>
#include <map>

namespace camloc::kinect {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes reply_bytes(std::uint16_t command, std::uint16_t tag, const Bytes& body) {
  const auto words = static_cast<std::uint16_t>(body.size() / 2);
  Bytes bytes{'R', 'B'};
  for (const std::uint16_t word : {words, command, tag}) {
    bytes.push_back(static_cast<std::uint8_t>(word));
    bytes.push_back(static_cast<std::uint8_t>(word >> 8));
  }
  bytes.insert(bytes.end(), body.begin(), body.end());
  return bytes;
}

/// A camera with registers, and a hook for what it says.
class ScriptedCamera final : public ControlTransport {
 public:
  [[nodiscard]] Status send(std::span<const std::uint8_t> request) override {
    if (!send_status) return send_status;
    EXPECT_GE(request.size(), kControlHeaderBytes);
    EXPECT_EQ(request[0], 'G');
    EXPECT_EQ(request[1], 'M');
    EXPECT_EQ(request.size(), kControlHeaderBytes + 2U * word_at(request, 2));
    const std::uint16_t command = word_at(request, 4), tag = word_at(request, 6);
    std::vector<std::uint16_t> body;
    for (std::size_t i = kControlHeaderBytes; i < request.size(); i += 2) body.push_back(word_at(request, i));
    ++num_requests;
    answer(command, tag, body);
    return Status::ok();
  }
  [[nodiscard]] Result<std::size_t> receive(std::span<std::uint8_t> reply) override {
    ++num_polls;
    if (replies.empty()) return std::size_t{0};
    const Bytes bytes = replies.front();
    replies.pop_front();
    std::copy_n(bytes.begin(), std::min(bytes.size(), reply.size()), reply.begin());
    return std::min(bytes.size(), reply.size());
  }
  void pause(std::chrono::microseconds duration) override { slept += duration; }

  /// Right answers for registers and sensor registers.
  void answer(std::uint16_t command, std::uint16_t tag, const std::vector<std::uint16_t>& body) {
    Bytes reply_body{0, 0};
    if (command == 0x03) {
      registers[body[0]] = body[1];
      writes.emplace_back(body[0], body[1]);
    } else if (command == 0x95) {
      std::uint16_t& value = sensor[body[1] & 0x7fff];
      if ((body[1] & 0x8000) != 0 && takes_settings) value = body[2];
      reply_body = {0, 0, 0, 0, static_cast<std::uint8_t>(value), static_cast<std::uint8_t>(value >> 8)};
    } else if (command == 0x96) {
      const bool is_read = body[1] == kControlReadWord || body[1] == kControlReadByte;
      const std::uint16_t control = is_read || body[1] == kControlWriteByte ? body[2] : body[1];
      if (!is_read && takes_settings) controls[control] = body[1] == kControlWriteByte ? body[4] : body[2];
      const std::uint16_t value = controls[control];
      reply_body = {0, 0, 0, 0, 0, 0, static_cast<std::uint8_t>(value), static_cast<std::uint8_t>(value >> 8)};
    } else if (const auto fixed = bodies.find(command << 16 | body[0]); fixed != bodies.end()) {
      reply_body = fixed->second;
    }
    Bytes bytes = reply_bytes(command, tag, reply_body);
    if (spoil) spoil(&bytes);
    for (int i = 0; i < empty_polls; ++i) replies.emplace_back();
    replies.push_back(bytes);
  }

  Status send_status;
  std::deque<Bytes> replies;
  std::function<void(Bytes*)> spoil;
  int empty_polls = 0, num_polls = 0, num_requests = 0;
  bool takes_settings = true;
  std::chrono::microseconds slept{0};
  std::map<std::uint16_t, std::uint16_t> registers, sensor, controls;
  std::vector<std::pair<std::uint16_t, std::uint16_t>> writes;
  std::map<int, Bytes> bodies;  // by command << 16 | first word
};

TEST(KinectProtocol, RequestHasTheBytesOfTheDocumentation) {
  const std::uint16_t body[] = {0x0012, 0x0003};
  const ControlRequest request = encode_request(Command::kWriteRegister, 0x1234, body);
  const Bytes expected{'G', 'M', 2, 0, 3, 0, 0x34, 0x12, 0x12, 0, 3, 0};
  ASSERT_EQ(request.size, expected.size());
  EXPECT_TRUE(std::equal(expected.begin(), expected.end(), request.bytes.begin()));
}

TEST(KinectProtocol, RepliesAreToldApart) {
  const Bytes good = reply_bytes(3, 77, {0, 0});
  const ControlReply parsed = parse_reply(good, Command::kWriteRegister, 77);
  EXPECT_EQ(parsed.state, ReplyState::kOk);
  EXPECT_EQ(parsed.body.size(), 2U);
  EXPECT_EQ(parse_reply({}, Command::kWriteRegister, 77).state, ReplyState::kNone);
  EXPECT_EQ(parse_reply(Bytes(kMaxControlBytes), Command::kWriteRegister, 77).state, ReplyState::kNone);
  EXPECT_EQ(parse_reply(good, Command::kWriteRegister, 78).state, ReplyState::kStale);
  EXPECT_EQ(parse_reply(good, Command::kReadRegister, 77).state, ReplyState::kCorrupt);
  for (std::size_t size = 1; size < good.size(); ++size) {
    EXPECT_EQ(parse_reply(std::span(good).first(size), Command::kWriteRegister, 77).state, ReplyState::kCorrupt) << size;
  }
  Bytes too_long = good;
  too_long[2] = 0xff;
  too_long[3] = 0xff;
  EXPECT_EQ(parse_reply(too_long, Command::kWriteRegister, 77).state, ReplyState::kCorrupt);
  Bytes other_magic = good;
  other_magic[0] = 'G';
  EXPECT_EQ(parse_reply(other_magic, Command::kWriteRegister, 77).state, ReplyState::kCorrupt);
}

TEST(KinectControl, WaitsForALateReply) {
  ScriptedCamera camera;
  camera.empty_polls = 50;
  KinectControl control(&camera);
  EXPECT_TRUE(control.write_register(Register::kColorStream, 1).is_ok());
  EXPECT_EQ(camera.registers[0x05], 1);
}

TEST(KinectControl, GivesUpWhenNoReplyComes) {
  ScriptedCamera camera;
  camera.spoil = [](Bytes* reply) { reply->clear(); };
  KinectControl control(&camera);
  EXPECT_EQ(control.write_register(Register::kColorStream, 1).code(), ErrorCode::kTimeout);
  EXPECT_EQ(camera.num_requests, KinectControl::kMaxAttempts);
  EXPECT_LE(camera.slept, (KinectControl::kMaxAttempts + 1) * KinectControl::kReplyPatience);
}

TEST(KinectControl, ReplyToAnEarlierRequestIsThrownAway) {
  ScriptedCamera camera;
  KinectControl control(&camera);
  camera.replies.push_back(reply_bytes(0x03, 0x7777, {9, 9}));
  EXPECT_TRUE(control.write_register(Register::kColorStream, 1).is_ok());
}

TEST(KinectControl, NonsenseAndRefusalAreErrors) {
  ScriptedCamera camera;
  KinectControl control(&camera);
  camera.spoil = [](Bytes* reply) { (*reply)[1] = 'X'; };
  EXPECT_EQ(control.write_register(Register::kColorStream, 1).code(), ErrorCode::kCorrupt);
  camera.spoil = [](Bytes* reply) { reply->resize(kControlHeaderBytes + 1); };
  EXPECT_EQ(control.write_register(Register::kColorStream, 1).code(), ErrorCode::kCorrupt);
  camera.spoil = [](Bytes* reply) {
    (*reply)[2] = 0;
    reply->resize(kControlHeaderBytes);
  };
  EXPECT_EQ(control.write_register(Register::kColorStream, 1).code(), ErrorCode::kCorrupt) << "no status word";
  camera.spoil = [](Bytes* reply) { (*reply)[8] = 5; };
  const Status refused = control.write_register(Register::kDepthStream, 2);
  EXPECT_EQ(refused.code(), ErrorCode::kInvalid);
  EXPECT_NE(refused.message().find("0x06"), std::string::npos) << refused.message();
  camera.spoil = nullptr;
  camera.send_status = {ErrorCode::kUnavailable, "gone"};
  EXPECT_EQ(control.write_register(Register::kColorStream, 1).code(), ErrorCode::kUnavailable);
}

TEST(KinectControl, StartsStreamsLastAndUnmirrored) {
  ScriptedCamera camera;
  KinectControl control(&camera);
  ASSERT_TRUE(control.start_color().is_ok());
  ASSERT_TRUE(control.start_depth().is_ok());
  EXPECT_EQ(camera.registers[0x05], 1);
  EXPECT_EQ(camera.registers[0x06], 2);
  EXPECT_EQ(camera.registers[0x12], 3);
  EXPECT_EQ(camera.registers[0x47], 0);
  const std::pair<std::uint16_t, std::uint16_t> color_off{5, 0}, color_on{5, 1}, format{0x0c, 0};
  const auto at = [&camera](const auto& write) {
    return std::find(camera.writes.begin(), camera.writes.end(), write) - camera.writes.begin();
  };
  EXPECT_LT(at(color_off), at(format));
  EXPECT_LT(at(format), at(color_on));
  // The first that is not answered ends it: what follows would take as long.
  camera.spoil = [](Bytes* reply) { reply->clear(); };
  const int before = camera.num_requests;
  EXPECT_FALSE(control.start_depth().is_ok());
  EXPECT_EQ(camera.num_requests, before + KinectControl::kMaxAttempts);
}

TEST(KinectControl, ReadsTheCalibration) {
  ScriptedCamera camera;
  KinectControl control(&camera);
  Bytes registration(kRegistrationBodyBytes), zero_plane(334);
  registration[2 + 4 * 5] = 0x11;
  registration[2 + 4 * 5 + 1] = 0x18;
  const float plane[4] = {7.5F, 2.3F, 120.0F, 0.1042F};
  std::memcpy(&zero_plane[kZeroPlaneOffset], plane, sizeof(plane));
  camera.bodies = {{0x16 << 16 | 0x40, registration},
                   {0x16 << 16 | 0x41, {0, 0, 0, 0, 0, 0, 0, 0}},
                   {0x16 << 16, {0, 0, 200, 0}},
                   {0x04 << 16, zero_plane}};
  const Result<KinectCalibration> result = control.read_calibration();
  ASSERT_TRUE(result.is_ok()) << result.status().message();
  const KinectCalibration& calibration = *result;
  ASSERT_TRUE(calibration.registration);
  EXPECT_EQ(calibration.registration->x.start, 0x1811);
  ASSERT_TRUE(calibration.zero_plane);
  EXPECT_NEAR(calibration.zero_plane->pixel_size_cm, 0.1042, 1e-6);
  EXPECT_NEAR(calibration.zero_plane->focal_px(), 575.8, 0.1);
  EXPECT_EQ(calibration.const_shift, 200);
}

TEST(KinectControl, OneFaultOnTheWayChangesNothing) {
  for (int fault = 0; fault < 3; ++fault) {
    ScriptedCamera camera;
    KinectControl control(&camera);
    Bytes registration(kRegistrationBodyBytes, 1), zero_plane(322);
    registration[0] = registration[1] = 0;
    camera.bodies = {
        {0x16 << 16 | 0x40, registration}, {0x16 << 16 | 0x41, Bytes(8)}, {0x16 << 16, {0, 0, 200, 0}}, {0x04 << 16, zero_plane}};
    int num_replies = 0;
    camera.spoil = [&num_replies, fault](Bytes* reply) {
      if (num_replies++ != 0) return;
      if (fault == 0) reply->clear();
      if (fault == 1) (*reply)[0] = 'X';
      if (fault == 2) reply->resize(reply->size() / 2);
    };
    const Result<KinectCalibration> calibration = control.read_calibration();
    ASSERT_TRUE(calibration.is_ok()) << calibration.status().message();
    EXPECT_TRUE(calibration->registration) << fault;
    camera.spoil = [](Bytes* reply) { reply->clear(); };
    EXPECT_FALSE(control.read_calibration().is_ok()) << "not another camera";
  }
}

TEST(KinectControl, ADeviceThatIsGoneIsNotAskedAgain) {
  ScriptedCamera camera;
  camera.send_status = {ErrorCode::kUnavailable, "gone"};
  KinectControl control(&camera);
  EXPECT_EQ(control.read_calibration().status().code(), ErrorCode::kUnavailable);
  EXPECT_EQ(camera.slept.count(), 0);
}

TEST(KinectControl, CalibrationThatMakesNoSenseIsNotBelieved) {
  ScriptedCamera camera;
  KinectControl control(&camera);
  Bytes zero_plane(322);
  const float plane[4] = {7.5F, std::numeric_limits<float>::quiet_NaN(), 120.0F, 0.1042F};
  std::memcpy(&zero_plane[kZeroPlaneOffset], plane, sizeof(plane));
  camera.bodies = {
      {0x16 << 16 | 0x40, Bytes(kRegistrationBodyBytes)}, {0x16 << 16 | 0x41, Bytes(8)}, {0x16 << 16, Bytes(4)}, {0x04 << 16, zero_plane}};
  const Result<KinectCalibration> result = control.read_calibration();
  ASSERT_TRUE(result.is_ok()) << result.status().message();
  const KinectCalibration& calibration = *result;
  EXPECT_FALSE(calibration.registration) << "all zeros: the device has none";
  EXPECT_FALSE(calibration.zero_plane);
  EXPECT_FALSE(calibration.const_shift);
  EXPECT_EQ(calibration.padding_start_lines, 0);
  EXPECT_FALSE(parse_padding(Bytes(8, 0xff))) << "more rows than there are";
  EXPECT_TRUE(nominal_camera(calibration, false).validate().is_ok());
}

TEST(KinectControl, SetsExposureThroughTheSensorOf1414) {
  ScriptedCamera camera;
  camera.sensor[kSensorMode] = 0xffff;
  KinectControl control(&camera);
  ColorControls controls;
  controls.exposure_us = 10'000;
  controls.auto_white_balance = false;
  ASSERT_TRUE(control.set_color(controls, true).is_ok());
  EXPECT_EQ(camera.sensor[kSensorMode], 0xffff & ~kSensorModeAutoExposure & ~kSensorModeAutoWhiteBalance);
  EXPECT_NEAR(camera.sensor[kSensorShutterRows] * kSensorRowUs, 10'000, 30);
  controls = {};
  controls.auto_exposure = true;
  ASSERT_TRUE(control.set_color(controls, true).is_ok());
  EXPECT_NE(camera.sensor[kSensorMode] & kSensorModeAutoExposure, 0);
  controls.gain = 2;
  EXPECT_EQ(control.set_color(controls, true).code(), ErrorCode::kUnsupported);
  camera.takes_settings = false;
  controls = {};
  controls.exposure_us = 500;
  EXPECT_EQ(control.set_color(controls, true).code(), ErrorCode::kUnsupported) << "read back and compared";
}

TEST(KinectControl, SetsExposureAndGainThroughTheControlsOf1473) {
  ScriptedCamera camera;
  KinectControl control(&camera);
  ColorControls controls;
  controls.exposure_us = 20'000;
  controls.gain = 4;
  ASSERT_TRUE(control.set_color(controls, false).is_ok());
  EXPECT_EQ(camera.controls[kControlExposureMode], 1);
  EXPECT_EQ(camera.controls[kControlExposureLow], 200);
  EXPECT_EQ(camera.controls[kControlGain], 128);
  controls = {};
  controls.auto_exposure = true;
  ASSERT_TRUE(control.set_color(controls, false).is_ok());
  EXPECT_EQ(camera.controls[kControlExposureMode], 2);
  camera.takes_settings = false;
  controls = {};
  controls.gain = 8;
  EXPECT_EQ(control.set_color(controls, false).code(), ErrorCode::kUnsupported);
}

}  // namespace
}  // namespace camloc::kinect
