// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Questions to the camera and their answers, over anything that can carry a control transfer: the device, or a test that lies.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <span>
#include <utility>

#include "core/base/result.h"
#include "drivers/kinect/kinect_calibration.h"
#include "drivers/kinect/kinect_protocol.h"

namespace camloc::kinect {

/// Bytes of a request, ready to be sent.
struct ControlRequest {
  std::array<std::uint8_t, kControlHeaderBytes + 2 * kMaxRequestWords> bytes{};
  std::size_t size = 0;
};
/// `body` has at most kMaxRequestWords words.
[[nodiscard]] ControlRequest encode_request(Command command, std::uint16_t tag, std::span<const std::uint16_t> body);

enum class ReplyState : std::uint8_t {
  kNone,     ///< empty, or as long as the buffer: the device is not ready yet [FN]
  kStale,    ///< answers an earlier request
  kCorrupt,  ///< not a reply at all: wrong magic, or lengths that contradict each other
  kOk,
};
struct ControlReply {
  ReplyState state = ReplyState::kNone;
  std::span<const std::uint8_t> body;  ///< points into the bytes that were parsed
};
/// Bytes behind the body that the header announces are ignored.
[[nodiscard]] ControlReply parse_reply(std::span<const std::uint8_t> bytes, Command command, std::uint16_t tag);

/// Carries the vendor requests of the camera (see kinect_protocol.h).
class ControlTransport {
 public:
  virtual ~ControlTransport() = default;
  [[nodiscard]] virtual Status send(std::span<const std::uint8_t> request) = 0;
  /// What the device has to say now, at most reply.size() bytes: their number, 0 for nothing yet.
  [[nodiscard]] virtual Result<std::size_t> receive(std::span<std::uint8_t> reply) = 0;
  virtual void pause(std::chrono::microseconds duration) = 0;
};

/// What can be set on the colour sensor. An unset value leaves what the device does by itself.
struct ColorControls {
  std::optional<bool> auto_exposure;
  std::optional<bool> auto_white_balance;
  std::optional<int> exposure_us;  ///< implies manual exposure
  std::optional<double> gain;      ///< 1 to 16; implies manual exposure; model 1473 and K4W only
};

/// Not thread-safe. Every call is bounded: a reply is awaited for kReplyPatience, stale ones are thrown away, and what went wrong
/// on the way is asked again, kMaxAttempts times in all (every request may be repeated).
class KinectControl {
 public:
  explicit KinectControl(ControlTransport* transport) : transport_(transport) {}
  static constexpr std::chrono::milliseconds kReplyPatience{500};
  static constexpr std::chrono::microseconds kPollInterval{1000};
  static constexpr int kMaxAttempts = 3;

  /// The body of the reply, valid until the next call. kTimeout: no reply with this tag; kCorrupt: a reply that is none, or
  /// that is shorter than `min_body_bytes`; else what the transport says, kUnavailable at once.
  [[nodiscard]] Result<std::span<const std::uint8_t>> command(Command command, std::span<const std::uint16_t> body,
                                                              std::size_t min_body_bytes);
  /// kInvalid: the device refused (status word other than 0 [PS]).
  [[nodiscard]] Status write_register(Register address, std::uint16_t value);

  /// What the device says of itself; what it does not know, or says nonsense about, stays unset. An error where it does not
  /// answer at all: it would be another camera after the next start.
  [[nodiscard]] Result<KinectCalibration> read_calibration();
  /// 640x480 Bayer at 30 Hz, unmirrored.
  [[nodiscard]] Status start_color();
  /// 640x480, 11 bits, 30 Hz, unmirrored; switches the projector on.
  [[nodiscard]] Status start_depth();
  [[nodiscard]] Status stop_color() { return write_register(Register::kColorStream, 0); }
  [[nodiscard]] Status stop_depth() { return write_register(Register::kDepthStream, 0); }
  /// Sets and reads back. `is_1414` decides which of two ways the device understands. kUnsupported: it took no notice.
  [[nodiscard]] Status set_color(const ColorControls& controls, bool is_1414);

 private:
  [[nodiscard]] Result<std::span<const std::uint8_t>> attempt(Command command, std::span<const std::uint16_t> body,
                                                              std::size_t min_body_bytes);
  [[nodiscard]] Status write_registers(std::initializer_list<std::pair<Register, std::uint16_t>> values);
  /// Sends `write`, then `read`; false where the answer to that is not `value`.
  [[nodiscard]] Result<bool> set_control(std::span<const std::uint16_t> write, std::span<const std::uint16_t> read, std::uint16_t value);
  [[nodiscard]] Result<std::uint16_t> read_sensor(std::uint16_t address);
  [[nodiscard]] Status write_sensor(std::uint16_t address, std::uint16_t value, std::uint16_t mask);
  [[nodiscard]] Status set_sensor_mode(std::uint16_t bit, bool is_on);
  [[nodiscard]] Status write_control_word(std::uint16_t control, std::uint16_t value);
  [[nodiscard]] Status set_exposure_mode(bool is_automatic);
  [[nodiscard]] Status set_color_1414(const ColorControls& controls);
  [[nodiscard]] Status set_color_1473(const ColorControls& controls);
  [[nodiscard]] Result<std::span<const std::uint8_t>> algorithm_parameter(AlgorithmParameter parameter, std::size_t bytes);

  ControlTransport* transport_;
  std::uint16_t tag_ = 0;
  std::array<std::uint8_t, kMaxControlBytes> reply_{};
};

}  // namespace camloc::kinect
