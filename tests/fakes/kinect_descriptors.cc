// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Descriptors of the Kinect's devices, as `lsusb -v` shows them for real ones.
#include "tests/fakes/kinect_model.h"

namespace camloc::fakes {
namespace {

std::vector<std::uint8_t> device_descriptor(std::uint16_t product, std::uint16_t release, std::uint8_t serial_index) {
  const auto low = [](std::uint16_t v) { return static_cast<std::uint8_t>(v); };
  const auto high = [](std::uint16_t v) { return static_cast<std::uint8_t>(v >> 8); };
  constexpr std::uint16_t kMicrosoft = 0x045e;
  return {
      18, 1, 0x00,         0x02, 0, 0, 0, 64, low(kMicrosoft), high(kMicrosoft), low(product), high(product), low(release), high(release),
      2,  1, serial_index, 1};
}

}  // namespace

UsbDescriptors camera_descriptors(KinectModel model, const std::string& serial) {
  UsbDescriptors d;
  const std::uint16_t product = model == KinectModel::kK4w ? 0x02bf : 0x02ae;
  const std::uint16_t release = model == KinectModel::k1414 ? 0x010b : model == KinectModel::k1473 ? 0x0114 : 0x0112;
  d.device = device_descriptor(product, release, 3);
  // One vendor interface, two isochronous IN endpoints of 2 x 960 bytes a microframe; the camera has its own power supply.
  d.configuration = {9, 2, 32,   0,    1,    1,    0,    0xc0, 8,  //
                     9, 4, 0,    0,    2,    0xff, 0xff, 0xff, 0,  //
                     7, 5, 0x81, 0x01, 0xc0, 0x0b, 1,              //
                     7, 5, 0x82, 0x01, 0xc0, 0x0b, 1};
  d.strings = {"Xbox NUI Camera", "Microsoft", serial};
  return d;
}

UsbDescriptors motor_descriptors(KinectModel /*model*/) {
  UsbDescriptors d;
  d.device = device_descriptor(0x02b0, 0x0105, 0);
  d.configuration = {9, 2, 18, 0, 1, 1,    0, 0x80, 50,  //
                     9, 4, 0,  0, 0, 0xff, 0, 0,    0};
  d.strings = {"Xbox NUI Motor", "Microsoft"};
  return d;
}

}  // namespace camloc::fakes
