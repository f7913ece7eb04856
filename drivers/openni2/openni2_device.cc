// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Every answer of the library is checked for its size, and what was set is read back: drivers accept
// settings that they ignore.
#include "drivers/openni2/openni2_device.h"

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <tuple>

#include "drivers/openni2/field_of_view.h"

namespace camloc::openni2 {

namespace {

template <typename Value>
std::optional<Value> stream_property(const Api& api, OniStreamHandle stream, int id) {
  Value value{};
  int size = sizeof(value);
  if (api.stream_get_property(stream, id, &value, &size) != ONI_STATUS_OK || size != static_cast<int>(sizeof(value))) return std::nullopt;
  return value;
}

std::string serial_of(const Api& api, OniDeviceHandle device) {
  char serial[ONI_MAX_STR] = {};
  int size = sizeof(serial);
  if (api.device_get_property(device, ONI_DEVICE_PROPERTY_SERIAL_NUMBER, serial, &size) != ONI_STATUS_OK) return {};
  std::string text(serial, ::strnlen(serial, sizeof(serial)));
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return text;
}

/// The device with this serial number. Devices say it only when they are open.
std::optional<DeviceEntry> find_serial(const Session& session, const std::vector<DeviceEntry>& devices, const std::string& serial) {
  for (const DeviceEntry& entry : devices) {
    OniDeviceHandle handle = nullptr;
    if (session.api().device_open(entry.uri.c_str(), &handle) != ONI_STATUS_OK) continue;
    const bool is_it = serial_of(session.api(), handle) == serial;
    session.api().device_close(handle);
    if (is_it) return entry;
  }
  return std::nullopt;
}

Result<DeviceEntry> find_device(const Session& session, const std::string& selector) {
  const std::vector<DeviceEntry> devices = session.devices();
  if (devices.empty()) {
    return Status(ErrorCode::kUnavailable, "OpenNI2 sees no device (" + session.library().path +
                                               "): is it plugged in, and does a driver for it lie in OpenNI2/Drivers? ask `camloc doctor`");
  }
  if (selector.empty()) return devices.front();
  const auto by_uri = std::find_if(devices.begin(), devices.end(), [&selector](const DeviceEntry& entry) { return entry.uri == selector; });
  if (by_uri != devices.end()) return *by_uri;
  std::size_t index = 0;
  const auto [rest, error] = std::from_chars(selector.data(), selector.data() + selector.size(), index);
  if (error == std::errc() && rest == selector.data() + selector.size() && index < devices.size()) return devices[index];
  if (const std::optional<DeviceEntry> entry = find_serial(session, devices, selector)) return *entry;
  std::string list;
  for (const DeviceEntry& entry : devices) list += (list.empty() ? "" : ", ") + entry.uri;
  return Status(ErrorCode::kUnavailable, "OpenNI2 sees no device with URI, index or serial number " + selector + "; it sees " + list);
}

/// Smaller is better; empty for formats of no use.
std::optional<int> format_rank(int oni_pixel_format, StreamUse use) {
  const std::optional<PixelFormat> format = pixel_format_of(oni_pixel_format);
  if (!format || (format->depth_unit_m > 0) != (use == StreamUse::kDepth)) return std::nullopt;
  switch (format->layout) {
    case PixelLayout::kDepth16: return format->depth_unit_m > 5e-4 ? 0 : 1;
    case PixelLayout::kRgb24: return 0;
    case PixelLayout::kUyvy: return 1;
    case PixelLayout::kYuyv: return 2;
    case PixelLayout::kGray8: return 3;
    case PixelLayout::kGray16: return 4;
    case PixelLayout::kJpeg: return std::nullopt;
  }
  return std::nullopt;
}

}  // namespace

std::optional<OniVideoMode> choose_mode(std::span<const OniVideoMode> offered, StreamUse use, const ModeRequest& request) {
  constexpr ModeRequest kUsual{640, 480, 30};
  std::optional<OniVideoMode> best;
  std::tuple<int, int, int> best_rank;
  for (const OniVideoMode& mode : offered) {
    const std::optional<int> rank_of_format = format_rank(mode.pixelFormat, use);
    if (!rank_of_format || mode.resolutionX <= 0 || mode.resolutionY <= 0 || mode.resolutionX > 16384 || mode.resolutionY > 16384 ||
        mode.fps <= 0 || mode.fps > 1000)
      continue;
    if ((request.width > 0 && mode.resolutionX != request.width) || (request.height > 0 && mode.resolutionY != request.height)) continue;
    if (request.fps > 0 && mode.fps != request.fps) continue;
    const std::tuple rank(std::abs(mode.resolutionX - kUsual.width) + std::abs(mode.resolutionY - kUsual.height),
                          std::abs(mode.fps - kUsual.fps), *rank_of_format);
    if (best && rank >= best_rank) continue;
    best = mode;
    best_rank = rank;
  }
  return best;
}

std::string describe(const OniVideoMode& mode) {
  const std::optional<PixelFormat> format = pixel_format_of(mode.pixelFormat);
  std::string pixels = "format " + std::to_string(mode.pixelFormat);
  if (format) pixels = format->depth_unit_m <= 0 ? name_of(format->layout) : format->depth_unit_m > 5e-4 ? "in 1 mm" : "in 0.1 mm";
  return std::to_string(mode.resolutionX) + "x" + std::to_string(mode.resolutionY) + "@" + std::to_string(mode.fps) + " " + pixels;
}

std::string describe(std::span<const OniVideoMode> modes) {
  constexpr std::size_t kMostListed = 40;
  std::string list;
  for (std::size_t i = 0; i < modes.size() && i < kMostListed; ++i) list += (i == 0 ? "" : ", ") + describe(modes[i]);
  return list.empty() ? "nothing" : list;
}

Result<std::unique_ptr<Device>> Device::open(const std::string& selector, const ModeRequest& request) {
  Result<std::shared_ptr<Session>> session = Session::acquire();
  if (!session) return session.status();
  std::unique_ptr<Device> device(new Device(std::move(session).value()));
  Result<DeviceEntry> entry = find_device(*device->session_, selector);
  if (!entry) return entry.status();
  device->entry_ = *entry;
  device->session_->watch(entry->uri, device->gone_);
  if (device->api().device_open(entry->uri.c_str(), &device->handle_) != ONI_STATUS_OK) {
    device->handle_ = nullptr;
    return device->error("cannot be opened; rights, another program, or unplugged");
  }
  device->serial_ = serial_of(device->api(), device->handle_);
  if (Status status = device->open_streams(request); !status) return status;
  return device;
}

Device::~Device() {
  stop();
  if (image_.handle != nullptr) api().stream_destroy(image_.handle);
  if (depth_.handle != nullptr) api().stream_destroy(depth_.handle);
  if (handle_ != nullptr) api().device_close(handle_);
  session_->unwatch(gone_);
}

Status Device::error(const std::string& what) const {
  return {ErrorCode::kUnavailable, "OpenNI2 device " + entry_.uri + ": " + what + " (" + session_->last_error() + ")"};
}

std::span<const OniVideoMode> Device::offered_modes(OniSensorType sensor) const {
  constexpr int kMaxModes = 1000;
  const OniSensorInfo* info = api().device_get_sensor_info(handle_, sensor);
  if (info == nullptr || info->pSupportedVideoModes == nullptr) return {};
  return {info->pSupportedVideoModes, static_cast<std::size_t>(std::clamp(info->numSupportedVideoModes, 0, kMaxModes))};
}

Status Device::open_streams(const ModeRequest& request) {
  is_infrared_ = offered_modes(ONI_SENSOR_COLOR).empty();
  if (is_infrared_ && offered_modes(ONI_SENSOR_IR).empty()) {
    return {ErrorCode::kUnsupported, "OpenNI2 device " + entry_.uri + ": has no colour nor infrared image; localization needs one"};
  }
  if (Status status = open_stream(is_infrared_ ? ONI_SENSOR_IR : ONI_SENSOR_COLOR, request, &image_); !status) return status;
  if (offered_modes(ONI_SENSOR_DEPTH).empty()) return Status::ok();
  // Registered depth has the pixels of the image, so the same size comes first.
  const ModeRequest like_image{image_.mode.resolutionX, image_.mode.resolutionY, image_.mode.fps};
  const bool fits = choose_mode(offered_modes(ONI_SENSOR_DEPTH), StreamUse::kDepth, like_image).has_value();
  if (Status status = open_stream(ONI_SENSOR_DEPTH, fits ? like_image : ModeRequest{0, 0, request.fps}, &depth_); !status) return status;
  set_registration();
  is_synchronized_ =
      api().device_enable_depth_color_sync(handle_) == ONI_STATUS_OK && api().device_get_depth_color_sync_enabled(handle_) != FALSE;
  return Status::ok();
}

Status Device::open_stream(OniSensorType sensor, const ModeRequest& request, Stream* stream) {
  const char* name = sensor == ONI_SENSOR_DEPTH ? "depth" : sensor == ONI_SENSOR_COLOR ? "colour" : "infrared";
  const std::span<const OniVideoMode> offered = offered_modes(sensor);
  const std::optional<OniVideoMode> mode =
      choose_mode(offered, sensor == ONI_SENSOR_DEPTH ? StreamUse::kDepth : StreamUse::kImage, request);
  if (!mode)
    return {ErrorCode::kUnsupported, "OpenNI2 device " + entry_.uri + ": no " + name + " mode fits; it offers " + describe(offered)};
  if (api().device_create_stream(handle_, sensor, &stream->handle) != ONI_STATUS_OK) {
    stream->handle = nullptr;
    return error(std::string("its ") + name + " stream cannot be opened");
  }
  (void)api().stream_set_property(stream->handle, ONI_STREAM_PROPERTY_VIDEO_MODE, &*mode, sizeof(*mode));
  const auto got = stream_property<OniVideoMode>(api(), stream->handle, ONI_STREAM_PROPERTY_VIDEO_MODE);
  if (!got || got->pixelFormat != mode->pixelFormat || got->resolutionX != mode->resolutionX || got->resolutionY != mode->resolutionY) {
    return error(std::string("its ") + name + " stream refuses the mode " + describe(*mode) + " that it offers");
  }
  stream->mode = {got->pixelFormat, got->resolutionX, got->resolutionY, got->fps > 0 ? got->fps : mode->fps};
  stream->pixels = *pixel_format_of(got->pixelFormat);
  const OniBool no = FALSE;
  (void)api().stream_set_property(stream->handle, ONI_STREAM_PROPERTY_MIRRORING, &no, sizeof(no));
  stream->is_mirrored = stream_property<OniBool>(api(), stream->handle, ONI_STREAM_PROPERTY_MIRRORING).value_or(FALSE) != FALSE;
  const OniCropping uncropped{FALSE, 0, 0, got->resolutionX, got->resolutionY};
  (void)api().stream_set_property(stream->handle, ONI_STREAM_PROPERTY_CROPPING, &uncropped, sizeof(uncropped));
  stream->horizontal_fov_rad = stream_property<float>(api(), stream->handle, ONI_STREAM_PROPERTY_HORIZONTAL_FOV).value_or(0);
  stream->vertical_fov_rad = stream_property<float>(api(), stream->handle, ONI_STREAM_PROPERTY_VERTICAL_FOV).value_or(0);
  return Status::ok();
}

void Device::set_registration() {
  if (is_infrared_ || api().device_is_image_registration_mode_supported(handle_, ONI_IMAGE_REGISTRATION_DEPTH_TO_COLOR) == FALSE) return;
  const OniImageRegistrationMode mode = ONI_IMAGE_REGISTRATION_DEPTH_TO_COLOR;
  (void)api().device_set_property(handle_, ONI_DEVICE_PROPERTY_IMAGE_REGISTRATION, &mode, sizeof(mode));
}

bool Device::read_registration() const {
  OniImageRegistrationMode mode = ONI_IMAGE_REGISTRATION_OFF;
  int size = sizeof(mode);
  return api().device_get_property(handle_, ONI_DEVICE_PROPERTY_IMAGE_REGISTRATION, &mode, &size) == ONI_STATUS_OK &&
         size == static_cast<int>(sizeof(mode)) && mode == ONI_IMAGE_REGISTRATION_DEPTH_TO_COLOR;
}

Status Device::start() {
  stop();
  is_running_ = true;
  if (api().stream_start(image_.handle) != ONI_STATUS_OK)
    return error(std::string("its ") + (is_infrared_ ? "infrared" : "colour") + " stream does not start");
  if (!has_depth()) return Status::ok();
  if (api().stream_start(depth_.handle) != ONI_STATUS_OK) return error("its depth stream does not start");
  // Some drivers forget the setting when a stream starts, others take it only then.
  if (!read_registration()) set_registration();
  is_registered_ = !is_infrared_ && read_registration();
  return Status::ok();
}

void Device::stop() {
  if (!is_running_) return;
  is_running_ = false;
  if (depth_.handle != nullptr) api().stream_stop(depth_.handle);
  if (image_.handle != nullptr) api().stream_stop(image_.handle);
}

void Device::disable_sync() {
  if (is_synchronized_) api().device_disable_depth_color_sync(handle_);
  is_synchronized_ = false;
}

std::string Device::description() const {
  std::string text = "OpenNI2 " + entry_.vendor + " " + entry_.name + " at " + entry_.uri + (serial_.empty() ? "" : ", serial " + serial_) +
                     ", " + (is_infrared_ ? "infrared " : "colour ") + describe(image_.mode);
  if (has_depth()) {
    text += ", depth " + describe(depth_.mode);
    text += is_registered_ ? ", registered to colour"
            : is_infrared_ ? ", of the same sensor"
                           : ", not registered to colour: needs a calibration file";
    text += is_synchronized_ ? ", synchronized with colour" : ", not synchronized: paired by time";
  }
  return text + ", library " + version_text(session_->library().version);
}

std::optional<RgbdCamera> Device::camera() const {
  if (has_depth() && !is_registered_ && !is_infrared_) return std::nullopt;
  const StreamGeometry image{image_.mode.resolutionX, image_.mode.resolutionY, image_.horizontal_fov_rad, image_.vertical_fov_rad};
  return registered_camera(image, depth_.mode.resolutionX, depth_.mode.resolutionY, has_depth() ? depth_.pixels.depth_unit_m : 0.001);
}

}  // namespace camloc::openni2
