// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The Kinect V1 as a state machine without transport, clock or thread: the camera (045e:02ae; K4W 045e:02bf) with its control
// protocol and two isochronous streams, and the motor (045e:02b0) with tilt, accelerometer and LED. Written from public facts:
// the OpenKinect wiki ("Protocol Documentation", "USB Protocol Information") and the Linux UAPI; what libfreenect, gspca_kinect and
// our own driver accept is what the tests show. Time is nanoseconds since the device was powered.
//
// Command (control OUT, request 0) and reply (control IN, request 0), little endian words:
//     "GM" length command tag [length words]        "RB" length command tag [length words]
// Isochronous packet, header 12 bytes:
//     'R' 'B' 0 kind 0 sequence size_high size_low stamp[4, little endian]      size counts the header
//     kind = stream (0x70 depth, 0x80 video) + 1 first | 2 middle | 5 last; the stamp is the time of the exposure in 60 MHz ticks,
//     the same in all packets of a frame but the first, where it is 0 (as the wiki has it from recorded traffic).
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tests/fakes/kinect_calibration.h"
#include "tests/fakes/usb_function.h"

namespace camloc::fakes {

inline constexpr std::size_t kMaxPacketBytes = 1920;  ///< two transactions of 960 bytes a microframe
inline constexpr std::size_t kPacketHeaderBytes = 12;
inline constexpr double kClockHz = 60e6;

enum class KinectModel { k1414, k1473, kK4w };
enum class StreamId { kVideo, kDepth };
inline constexpr std::array<StreamId, 2> kBothStreams = {StreamId::kVideo, StreamId::kDepth};
[[nodiscard]] inline std::size_t index_of(StreamId stream) { return static_cast<std::size_t>(stream); }
[[nodiscard]] const char* name_of(StreamId stream);

/// What a frame of a stream holds, as its registers choose it.
enum class FrameFormat { kBayer, kBayerHigh, kUyvy, kInfrared, kInfraredHigh, kDepth11, kDepth10 };
[[nodiscard]] std::size_t payload_bytes(FrameFormat format);
[[nodiscard]] const char* name_of(FrameFormat format);

/// Where frames come from: frame `index` of the show, in any format. The bytes stay valid until the second next call.
class FrameShow {
 public:
  virtual ~FrameShow() = default;
  [[nodiscard]] virtual std::span<const std::uint8_t> frame(FrameFormat format, std::uint64_t index) = 0;
};

struct KinectOptions {
  KinectModel model = KinectModel::k1414;
  std::string serial = "A00362A08602047A";
  KinectCalibration calibration;
  std::int64_t reply_delay_ns = 200'000;    ///< from a command to its reply; earlier reads give no bytes
  std::uint32_t clock_start = 0xf0000000U;  ///< ticks at power-up; the counter wraps after 4.5 s, then each 71.6 s
  double clock_ppm = 0;                     ///< how much too fast the device's clock is
  std::int64_t video_delay_ns = 4'000'000;  ///< exposure of colour after that of depth
  bool advance_needs_both = false;          ///< the show stays at frame 0 until both streams run
};

/// One isochronous packet on its way.
struct IsoPacket {
  std::array<std::uint8_t, kMaxPacketBytes> bytes;
  std::size_t size = 0;  ///< 0: the device had nothing to send in this microframe
  bool is_first = false, is_last = false;
  std::uint64_t show_index = 0;
  std::uint32_t stamp_ticks = 0;
  FrameFormat format = FrameFormat::kBayer;
};

[[nodiscard]] UsbDescriptors camera_descriptors(KinectModel model, const std::string& serial);
[[nodiscard]] UsbDescriptors motor_descriptors(KinectModel model);

/// What a fault may do to a reply before it is sent: change it, or delay it by the returned nanoseconds.
using ReplyFilter = std::function<std::int64_t(std::vector<std::uint8_t>* reply)>;

class KinectCamera final : public UsbFunction {
 public:
  /// `show` outlives the camera.
  KinectCamera(const KinectOptions& options, UsbDescriptors descriptors, FrameShow* show);

  void reset(std::int64_t now_ns) override;
  /// What the endpoint sends in the microframe at `now_ns`; call once a microframe, in order. Allocates nothing after the first frame
  /// of a format.
  void next_packet(StreamId stream, std::int64_t now_ns, IsoPacket* packet);
  [[nodiscard]] bool is_streaming(StreamId stream) const { return streams_[index_of(stream)].is_on; }
  [[nodiscard]] std::uint32_t ticks_at(std::int64_t now_ns) const;
  void set_reply_filter(ReplyFilter filter) { reply_filter_ = std::move(filter); }
  /// The next packets of the stream have sequence numbers `step` too high.
  void skip_sequence(StreamId stream, int step) { streams_[index_of(stream)].sequence += static_cast<std::uint8_t>(step); }
  /// The device's clock jumps.
  void jump_clock(std::int64_t ticks) { clock_jump_ticks_ += ticks; }
  [[nodiscard]] std::uint16_t register_value(std::uint16_t address) const;
  [[nodiscard]] std::uint64_t num_commands() const { return num_commands_; }
  [[nodiscard]] std::uint64_t num_bad_commands() const { return num_bad_commands_; }

 private:
  struct Stream {
    bool is_on = false;
    bool in_frame = false;
    FrameFormat format = FrameFormat::kBayer;
    std::uint8_t sequence = 0;
    std::size_t offset = 0;          ///< of the next byte of the frame
    std::int64_t next_exposure = 0;  ///< number of frame periods since power-up
    std::uint32_t stamp_ticks = 0;
    std::uint64_t show_index = 0;
  };

  [[nodiscard]] ControlReply vendor_request(const UsbSetup& setup, std::span<const std::uint8_t> data_out, std::int64_t now_ns) override;
  void accept_command(std::span<const std::uint8_t> bytes, std::int64_t now_ns);
  [[nodiscard]] std::optional<std::vector<std::uint8_t>> execute(std::uint16_t command, std::span<const std::uint8_t> arguments,
                                                                 std::int64_t now_ns);
  void write_register(std::uint16_t address, std::uint16_t value, std::int64_t now_ns);
  [[nodiscard]] std::vector<std::uint8_t> parameters(std::uint16_t which) const;
  [[nodiscard]] std::vector<std::uint8_t> sensor_register(std::uint16_t address, std::uint16_t value);
  void switch_stream(StreamId id, bool on, std::int64_t now_ns);
  [[nodiscard]] FrameFormat format_of(StreamId id) const;
  [[nodiscard]] std::int64_t exposure_ns(StreamId id, std::int64_t number) const;
  [[nodiscard]] std::int64_t period_ns(StreamId id) const;
  [[nodiscard]] bool begin_frame(StreamId id, std::int64_t now_ns);
  [[nodiscard]] std::uint64_t show_index_at(std::int64_t time_ns);

  KinectOptions options_;
  FrameShow* show_;
  std::map<std::uint16_t, std::uint16_t> registers_;
  std::map<std::uint16_t, std::uint16_t> sensor_registers_;
  std::array<Stream, 2> streams_;
  std::vector<std::uint8_t> reply_;
  std::int64_t reply_ready_ns_ = 0;
  std::int64_t clock_jump_ticks_ = 0;
  std::int64_t show_start_ns_ = -1;  ///< exposure that shows frame 0
  ReplyFilter reply_filter_;
  std::uint64_t num_commands_ = 0;
  std::uint64_t num_bad_commands_ = 0;
};

/// Tilt motor with accelerometer and LED. The motor turns at a constant rate to the angle it was sent.
class KinectMotor final : public UsbFunction {
 public:
  KinectMotor(UsbDescriptors descriptors, std::array<std::int16_t, 3> level_counts);

  void reset(std::int64_t now_ns) override;
  [[nodiscard]] int led() const { return led_; }
  [[nodiscard]] double angle_deg(std::int64_t now_ns) const;

 private:
  [[nodiscard]] ControlReply vendor_request(const UsbSetup& setup, std::span<const std::uint8_t> data_out, std::int64_t now_ns) override;
  [[nodiscard]] std::vector<std::uint8_t> state(std::int64_t now_ns) const;

  std::array<std::int16_t, 3> level_counts_;  ///< accelerometer at tilt 0; 819 counts are 1 g
  int led_ = 0;
  double start_deg_ = 0, target_deg_ = 0;
  std::int64_t start_ns_ = 0;
};

}  // namespace camloc::fakes
