// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A driver for OpenNI2 whose devices exist only here: known pixels and stamps, and faults on request (openni2_synthetic.h).
// OpenNI2 loads it from OpenNI2/Drivers/lib*.so.0 beside libOpenNI2.so.0. Environment variables CAMLOC_SYNTHETIC_<NAME>
// (WIDTH, HEIGHT, COLOR_FORMAT, DEPTH_FORMAT, INFRARED_FORMAT, REAL_FPS, MAX_FRAMES, MIRROR) set the switches for programs that
// cannot.
//
// A recorder takes only streams that answer for STRIDE and CROPPING; without them a file is written that plays nothing.

// What the driver kit expects of a header that is not installed.
#define XN_NEW(type, ...) new type(__VA_ARGS__)
#define XN_DELETE(p) delete (p)

#include <Driver/OniDriverAPI.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "tests/fakes/openni2/synthetic.h"

namespace {

using camloc::synthetic::Control;

Control& control() {
  static Control instance;
  return instance;
}

template <typename Value>
OniStatus give(const Value& value, void* data, int* size) {
  if (*size < static_cast<int>(sizeof(value))) return ONI_STATUS_BAD_PARAMETER;
  std::memcpy(data, &value, sizeof(value));
  *size = sizeof(value);
  return ONI_STATUS_OK;
}

int bytes_per_pixel(int format) { return format == ONI_PIXEL_FORMAT_RGB888 ? 3 : format == ONI_PIXEL_FORMAT_GRAY8 ? 1 : 2; }

void put_u16(std::uint8_t* to, std::uint16_t value) { std::memcpy(to, &value, sizeof(value)); }

/// Pixel (x, y) of the scene at column `column` of the image.
void put_pixel(std::uint8_t* row, int format, int frame, int column, int x, int y) {
  using namespace camloc::synthetic;
  switch (format) {
    case ONI_PIXEL_FORMAT_DEPTH_1_MM:
    case ONI_PIXEL_FORMAT_DEPTH_100_UM: return put_u16(row + 2 * column, depth_at(frame, x, y));
    case ONI_PIXEL_FORMAT_GRAY16: return put_u16(row + 2 * column, infrared_at(frame, x, y));
    case ONI_PIXEL_FORMAT_GRAY8: row[column] = color_at(frame, x, y)[0]; return;
    case ONI_PIXEL_FORMAT_YUV422:
      row[2 * column + 1] = luma_at(frame, x, y);
      row[2 * column] = chroma_at(frame, column / 2, column % 2 == 1);
      return;
    case ONI_PIXEL_FORMAT_YUYV:
      row[2 * column] = luma_at(frame, x, y);
      row[2 * column + 1] = chroma_at(frame, column / 2, column % 2 == 1);
      return;
    default: std::memcpy(row + 3 * column, color_at(frame, x, y).data(), 3);
  }
}

class SyntheticStream final : public oni::driver::StreamBase {
 public:
  SyntheticStream(OniSensorType sensor, const OniVideoMode& mode) : sensor_(sensor), mode_(mode) {}
  ~SyntheticStream() override { halt(); }

  OniStatus start() override {
    if (control().fails_to_start) return ONI_STATUS_ERROR;
    is_running_ = true;
    thread_ = std::thread([this] { run(); });
    return ONI_STATUS_OK;
  }
  void stop() override { halt(); }

  OniBool isPropertySupported(int id) override {
    return id == ONI_STREAM_PROPERTY_VIDEO_MODE || id == ONI_STREAM_PROPERTY_MAX_VALUE || id == ONI_STREAM_PROPERTY_MIRRORING ||
           id == ONI_STREAM_PROPERTY_STRIDE || id == ONI_STREAM_PROPERTY_CROPPING ||
           (control().has_field_of_view && (id == ONI_STREAM_PROPERTY_HORIZONTAL_FOV || id == ONI_STREAM_PROPERTY_VERTICAL_FOV));
  }
  OniStatus getProperty(int id, void* data, int* size) override {
    if (!isPropertySupported(id)) return ONI_STATUS_NOT_SUPPORTED;
    switch (id) {
      case ONI_STREAM_PROPERTY_VIDEO_MODE: return give(mode_, data, size);
      case ONI_STREAM_PROPERTY_MAX_VALUE: return give(10000, data, size);
      case ONI_STREAM_PROPERTY_MIRRORING: return give<OniBool>(is_mirrored_, data, size);
      case ONI_STREAM_PROPERTY_STRIDE: return give(mode_.resolutionX * bytes_per_pixel(mode_.pixelFormat), data, size);
      case ONI_STREAM_PROPERTY_CROPPING: return give(OniCropping{FALSE, 0, 0, mode_.resolutionX, mode_.resolutionY}, data, size);
      case ONI_STREAM_PROPERTY_HORIZONTAL_FOV: return give(1.0F, data, size);
      default: return give(0.8F, data, size);
    }
  }
  OniStatus setProperty(int id, const void* data, int size) override {
    if (id == ONI_STREAM_PROPERTY_VIDEO_MODE && size == static_cast<int>(sizeof(mode_)))
      return std::memcmp(data, &mode_, sizeof(mode_)) == 0 ? ONI_STATUS_OK : ONI_STATUS_NOT_SUPPORTED;
    if (id != ONI_STREAM_PROPERTY_MIRRORING || size != static_cast<int>(sizeof(OniBool))) return ONI_STATUS_NOT_SUPPORTED;
    OniBool wanted = FALSE;
    std::memcpy(&wanted, data, sizeof(wanted));
    is_mirrored_ = wanted != FALSE || control().insists_on_mirror;
    return ONI_STATUS_OK;
  }

 private:
  void halt() {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      is_running_ = false;
    }
    wake_.notify_all();
    if (thread_.joinable()) thread_.join();
  }

  void run() {
    using Clock = std::chrono::steady_clock;
    const Clock::time_point begin =
        Clock::now() + std::chrono::microseconds(sensor_ == ONI_SENSOR_DEPTH ? control().depth_latency_us.load() : 0);
    const auto interval = std::chrono::nanoseconds(1'000'000'000 / control().real_fps);
    const int max_frames = control().max_frames;
    for (int frame = 0; max_frames == 0 || frame < max_frames; ++frame) {
      std::unique_lock<std::mutex> lock(mutex_);
      if (wake_.wait_until(lock, begin + frame * interval, [this] { return !is_running_; })) return;
      lock.unlock();
      if (!control().is_stalled) deliver(frame);
    }
  }

  void deliver(int number) {
    OniFrame* frame = getServices().acquireFrame();
    if (frame == nullptr) return;
    const int row_bytes = mode_.resolutionX * bytes_per_pixel(mode_.pixelFormat);
    frame->frameIndex = number + 1;
    frame->videoMode = mode_;
    frame->width = mode_.resolutionX;
    frame->height = mode_.resolutionY;
    frame->cropOriginX = frame->cropOriginY = 0;
    frame->croppingEnabled = FALSE;
    frame->sensorType = sensor_;
    frame->stride = row_bytes;
    frame->dataSize = row_bytes * mode_.resolutionY;
    frame->timestamp = stamp_us(number);
    for (int y = 0; y < mode_.resolutionY; ++y) {
      std::uint8_t* row = static_cast<std::uint8_t*>(frame->data) + y * row_bytes;
      for (int x = 0; x < mode_.resolutionX; ++x)
        put_pixel(row, mode_.pixelFormat, number, is_mirrored_ ? mode_.resolutionX - 1 - x : x, x, y);
    }
    if (take_one(control().num_short_frames)) frame->dataSize -= 1;
    if (take_one(control().num_small_frames)) frame->width /= 2;
    if (take_one(control().num_wide_strides)) frame->stride += 1;
    raiseNewFrame(frame);
    getServices().releaseFrame(frame);
  }

  static bool take_one(std::atomic<int>& count) {
    int left = count;
    while (left > 0 && !count.compare_exchange_weak(left, left - 1)) {}
    return left > 0;
  }

  std::uint64_t stamp_us(int number) const {
    const std::int64_t own = sensor_ == ONI_SENSOR_DEPTH ? control().depth_delay_us + control().depth_stamp_zero_us : 0;
    return static_cast<std::uint64_t>(control().stamp_zero_us + own + std::int64_t{number} * 1'000'000 / mode_.fps);
  }

  OniSensorType sensor_;
  OniVideoMode mode_;
  std::atomic<bool> is_mirrored_{control().is_mirrored.load()};
  std::mutex mutex_;
  std::condition_variable wake_;
  bool is_running_ = false;
  std::thread thread_;
};

class SyntheticDevice final : public oni::driver::DeviceBase {
 public:
  explicit SyntheticDevice(int index) : index_(index) {
    add_sensor(ONI_SENSOR_DEPTH, control().depth_format);
    add_sensor(ONI_SENSOR_COLOR, control().color_format);
    add_sensor(ONI_SENSOR_IR, control().infrared_format);
    for (std::size_t i = 0; i < modes_.size(); ++i) sensors_[i].pSupportedVideoModes = &modes_[i];
    ++control().num_opened;
  }
  ~SyntheticDevice() override { ++control().num_closed; }

  OniStatus getSensorInfoList(OniSensorInfo** sensors, int* count) override {
    *sensors = sensors_.data();
    *count = static_cast<int>(sensors_.size());
    return ONI_STATUS_OK;
  }
  oni::driver::StreamBase* createStream(OniSensorType sensor) override {
    for (const OniSensorInfo& info : sensors_) {
      if (info.sensorType == sensor) return new SyntheticStream(sensor, info.pSupportedVideoModes[0]);
    }
    return nullptr;
  }
  void destroyStream(oni::driver::StreamBase* stream) override { delete stream; }

  OniBool isImageRegistrationModeSupported(OniImageRegistrationMode mode) override {
    return mode == ONI_IMAGE_REGISTRATION_OFF || control().can_register;
  }
  OniBool isPropertySupported(int id) override {
    return id == ONI_DEVICE_PROPERTY_SERIAL_NUMBER || id == ONI_DEVICE_PROPERTY_IMAGE_REGISTRATION;
  }
  OniStatus getProperty(int id, void* data, int* size) override {
    if (id == ONI_DEVICE_PROPERTY_IMAGE_REGISTRATION) return give(registration_, data, size);
    const std::string serial = "SYNTH000" + std::to_string(index_);
    if (id != ONI_DEVICE_PROPERTY_SERIAL_NUMBER || *size <= static_cast<int>(serial.size())) return ONI_STATUS_NOT_SUPPORTED;
    std::memcpy(data, serial.c_str(), serial.size() + 1);
    *size = static_cast<int>(serial.size()) + 1;
    return ONI_STATUS_OK;
  }
  OniStatus setProperty(int id, const void* data, int size) override {
    if (id != ONI_DEVICE_PROPERTY_IMAGE_REGISTRATION || size != static_cast<int>(sizeof(registration_))) return ONI_STATUS_NOT_SUPPORTED;
    // Forgetful: takes the setting only at the second time, as after the streams have started.
    if (control().forgets_registration && !std::exchange(was_set_, true)) return ONI_STATUS_OK;
    std::memcpy(&registration_, data, sizeof(registration_));
    return ONI_STATUS_OK;
  }

 private:
  void add_sensor(OniSensorType sensor, int format) {
    if (format == 0) return;
    sensors_.push_back({sensor, 1, nullptr});
    modes_.push_back({static_cast<OniPixelFormat>(format), control().width, control().height, control().nominal_fps});
  }

  int index_;
  std::vector<OniSensorInfo> sensors_;
  std::vector<OniVideoMode> modes_;
  OniImageRegistrationMode registration_ = ONI_IMAGE_REGISTRATION_OFF;
  bool was_set_ = false;
};

class SyntheticDriver;
std::atomic<SyntheticDriver*>& current_driver() {
  static std::atomic<SyntheticDriver*> driver{nullptr};
  return driver;
}

OniDeviceInfo info_of(int index) {
  OniDeviceInfo info{};
  std::snprintf(info.uri, sizeof(info.uri), "synthetic://%d", index);
  std::snprintf(info.vendor, sizeof(info.vendor), "camloc");
  std::snprintf(info.name, sizeof(info.name), "Synthetic");
  info.usbVendorId = 0x1d27;
  info.usbProductId = 0x0601;
  return info;
}

class SyntheticDriver final : public oni::driver::DriverBase {
 public:
  explicit SyntheticDriver(OniDriverServices* services) : DriverBase(services) {}

  OniStatus initialize(oni::driver::DeviceConnectedCallback connected, oni::driver::DeviceDisconnectedCallback disconnected,
                       oni::driver::DeviceStateChangedCallback changed, void* cookie) override {
    const OniStatus status = DriverBase::initialize(connected, disconnected, changed, cookie);
    current_driver() = this;
    for (int i = 0; i < control().num_devices; ++i) plug(i, true);
    return status;
  }
  void plug(int index, bool is_in) {
    const OniDeviceInfo info = info_of(index);
    if (is_in) deviceConnected(&info);
    if (!is_in) deviceDisconnected(&info);
  }
  oni::driver::DeviceBase* deviceOpen(const char* uri, const char*) override {
    return new SyntheticDevice(std::atoi(std::strrchr(uri, '/') + 1));
  }
  void deviceClose(oni::driver::DeviceBase* device) override { delete device; }
  void shutdown() override { current_driver() = nullptr; }
};

void read_environment() {
  const std::map<std::string, std::atomic<int>*> switches{{"WIDTH", &control().width},
                                                          {"HEIGHT", &control().height},
                                                          {"COLOR_FORMAT", &control().color_format},
                                                          {"DEPTH_FORMAT", &control().depth_format},
                                                          {"INFRARED_FORMAT", &control().infrared_format},
                                                          {"REAL_FPS", &control().real_fps},
                                                          {"MAX_FRAMES", &control().max_frames}};
  for (const auto& [name, value] : switches) {
    if (const char* text = std::getenv(("CAMLOC_SYNTHETIC_" + name).c_str())) *value = std::atoi(text);
  }
  if (const char* text = std::getenv("CAMLOC_SYNTHETIC_MIRROR")) control().is_mirrored = *text == '1';
}

struct EnvironmentReader {
  EnvironmentReader() { read_environment(); }
} const environment_reader;

}  // namespace

extern "C" __attribute__((visibility("default"))) Control* camloc_synthetic_control() { return &control(); }
extern "C" __attribute__((visibility("default"))) void camloc_synthetic_plug(int index, bool is_in) {
  control().num_devices = is_in ? std::max(index + 1, control().num_devices.load()) : index;
  if (SyntheticDriver* driver = current_driver()) driver->plug(index, is_in);
}

ONI_EXPORT_DRIVER(SyntheticDriver)
