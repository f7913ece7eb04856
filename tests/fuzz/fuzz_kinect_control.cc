// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Any replies of a Kinect: start-up comes to an end, the calibration that is believed is one that the rest can live with, and depth
// that is registered with it stays in its image. The input is a row of replies, each behind two length bytes; a first byte of 1 in a
// reply puts the right magic, command and tag in front, so that the fuzzer need not guess them.
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "drivers/kinect/kinect_control.h"
#include "drivers/kinect/kinect_depth.h"
#include "drivers/kinect/kinect_motor.h"

namespace {

using namespace camloc;
using namespace camloc::kinect;

class FuzzedCamera final : public ControlTransport {
 public:
  FuzzedCamera(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}
  [[nodiscard]] Status send(std::span<const std::uint8_t> request) override {
    command_ = word_at(request, 4);
    tag_ = word_at(request, 6);
    return Status::ok();
  }
  [[nodiscard]] Result<std::size_t> receive(std::span<std::uint8_t> reply) override {
    if (++num_polls_ > 100'000) std::abort();  // it would never end
    if (size_ - at_ < 3) return std::size_t{0};
    const std::size_t length =
        std::min<std::size_t>({static_cast<std::size_t>(data_[at_] | data_[at_ + 1] << 8) % 600, size_ - at_ - 2, reply.size()});
    const std::uint8_t* const bytes = data_ + at_ + 2;
    at_ += 2 + length;
    std::copy_n(bytes, length, reply.begin());
    if (length >= kControlHeaderBytes && reply[0] == 1) {
      const std::uint8_t header[] = {'R',
                                     'B',
                                     reply[2],
                                     reply[3],
                                     static_cast<std::uint8_t>(command_),
                                     static_cast<std::uint8_t>(command_ >> 8),
                                     static_cast<std::uint8_t>(tag_),
                                     static_cast<std::uint8_t>(tag_ >> 8)};
      std::copy_n(header, kControlHeaderBytes, reply.begin());
    }
    return length;
  }
  void pause(std::chrono::microseconds /*duration*/) override {}

 private:
  const std::uint8_t* data_;
  std::size_t size_, at_ = 0;
  std::uint16_t command_ = 0, tag_ = 0;
  int num_polls_ = 0;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  FuzzedCamera camera(data, size);
  KinectControl control(&camera);
  const KinectCalibration calibration = [&control] {
    const Result<KinectCalibration> result = control.read_calibration();
    return result ? *result : KinectCalibration{};
  }();
  if (!nominal_camera(calibration, false).validate() || !nominal_camera(calibration, true).validate()) std::abort();
  ColorControls controls;
  controls.exposure_us = 5000;
  static_cast<void>(control.set_color(controls, true));
  static_cast<void>(control.set_color(controls, false));
  static_cast<void>(control.start_color());
  static_cast<void>(control.start_depth());
  static_cast<void>(parse_acceleration({data, size}));
  if (!calibration.registration) return 0;
  const DepthTable table = make_depth_table(calibration);
  const auto registration = DepthRegistration::create(calibration, table);
  if (!registration) return 0;
  static std::vector<std::uint16_t> raw(static_cast<std::size_t>(kWidth) * kHeight);
  for (std::size_t i = 0; i < raw.size(); ++i) raw[i] = static_cast<std::uint16_t>(i * 7 % kNumDisparities);
  Image<std::uint16_t> registered;
  registration->apply(raw, &registered);
  return 0;
}
