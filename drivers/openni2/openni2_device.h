// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// An open OpenNI2 device with its depth and its image stream: found, set up, started and stopped.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>

#include "core/geometry/camera.h"
#include "drivers/openni2/openni2_library.h"
#include "drivers/openni2/pixel_layout.h"

namespace camloc::openni2 {

// ---- which of the video modes that a device offers a camera is set to

/// What the user asks for. Zero: no matter, near 640x480 at 30 Hz.
struct ModeRequest {
  int width = 0;
  int height = 0;
  int fps = 0;
};

enum class StreamUse { kDepth, kImage };

/// The mode for the request, or nothing where no mode that is read has the size and rate asked for. Depth in millimetres is
/// preferred to tenths of them, whose 16 bits end at 6.5 m; RGB to YUV to grey, as RGB is what every device has been tried with.
[[nodiscard]] std::optional<OniVideoMode> choose_mode(std::span<const OniVideoMode> offered, StreamUse use, const ModeRequest& request);

/// "640x480@30 RGB888"; the number of a format that is not read.
[[nodiscard]] std::string describe(const OniVideoMode& mode);
[[nodiscard]] std::string describe(std::span<const OniVideoMode> modes);

// ---- the device

/// One running stream.
struct Stream {
  OniStreamHandle handle = nullptr;
  OniVideoMode mode{};
  PixelFormat pixels;
  bool is_mirrored = false;  ///< the device insists; the conversion undoes it
  double horizontal_fov_rad = 0, vertical_fov_rad = 0;
};

/// Not thread-safe. Everything is stopped and closed on destruction.
class Device {
 public:
  /// `selector`: empty for the first device, else its URI, its index or its serial number. kUnavailable: no such device now;
  /// kUnsupported: it has no colour nor infrared image, or no mode that fits the request.
  [[nodiscard]] static Result<std::unique_ptr<Device>> open(const std::string& selector, const ModeRequest& request);
  ~Device();
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  [[nodiscard]] Status start();
  void stop();
  /// Colour and depth are no longer delivered together: for devices that say they can and then deliver nothing.
  void disable_sync();

  [[nodiscard]] const Session& session() const { return *session_; }
  [[nodiscard]] const Stream& image() const { return image_; }
  [[nodiscard]] const Stream& depth() const { return depth_; }
  [[nodiscard]] bool has_depth() const { return depth_.handle != nullptr; }
  [[nodiscard]] bool is_gone() const { return gone_->load(); }
  [[nodiscard]] bool is_synchronized() const { return is_synchronized_; }
  [[nodiscard]] const std::string& uri() const { return entry_.uri; }
  [[nodiscard]] const std::string& serial() const { return serial_; }
  /// kUnavailable, with the library's words for its last error.
  [[nodiscard]] Status error(const std::string& what) const;
  /// One line: name, modes, registration, synchronization. After start().
  [[nodiscard]] std::string description() const;
  /// Where depth is registered to the image (or both are of one sensor) and the device tells its field of view. After start().
  [[nodiscard]] std::optional<RgbdCamera> camera() const;

 private:
  explicit Device(std::shared_ptr<Session> session) : session_(std::move(session)) {}
  [[nodiscard]] const Api& api() const { return session_->api(); }
  [[nodiscard]] Status open_streams(const ModeRequest& request);
  [[nodiscard]] Status open_stream(OniSensorType sensor, const ModeRequest& request, Stream* stream);
  [[nodiscard]] std::span<const OniVideoMode> offered_modes(OniSensorType sensor) const;
  void set_registration();
  [[nodiscard]] bool read_registration() const;

  std::shared_ptr<Session> session_;
  GoneFlag gone_ = std::make_shared<std::atomic<bool>>(false);
  DeviceEntry entry_;
  std::string serial_;
  OniDeviceHandle handle_ = nullptr;
  Stream image_, depth_;
  bool is_infrared_ = false;
  bool is_registered_ = false;
  bool is_synchronized_ = false;
  bool is_running_ = false;
};

}  // namespace camloc::openni2
