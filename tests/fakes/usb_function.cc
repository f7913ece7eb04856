// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/fakes/usb_function.h"

#include <algorithm>
#include <cassert>

namespace camloc::fakes {
namespace {

constexpr std::uint8_t kGetStatus = 0, kClearFeature = 1, kSetFeature = 3, kSetAddress = 5, kGetDescriptor = 6, kGetConfiguration = 8,
                       kSetConfiguration = 9, kGetInterface = 10, kSetInterface = 11;
constexpr std::uint8_t kDeviceDescriptor = 1, kConfigurationDescriptor = 2, kStringDescriptor = 3;
constexpr std::uint8_t kEnglishLow = 0x09, kEnglishHigh = 0x04;  // language 0x0409

ControlReply stalled() { return {true, {}}; }

ControlReply answer(std::vector<std::uint8_t> bytes, std::uint16_t limit) {
  bytes.resize(std::min<std::size_t>(bytes.size(), limit));
  return {false, std::move(bytes)};
}

std::vector<std::uint8_t> string_descriptor(const std::string& text) {
  std::vector<std::uint8_t> bytes = {static_cast<std::uint8_t>(2 + 2 * text.size()), kStringDescriptor};
  for (const char c : text) {
    bytes.push_back(static_cast<std::uint8_t>(c));
    bytes.push_back(0);
  }
  return bytes;
}

}  // namespace

UsbSetup parse_setup(std::span<const std::uint8_t> bytes) {
  assert(bytes.size() >= 8);
  const auto word = [&](std::size_t at) { return static_cast<std::uint16_t>(bytes[at] | bytes[at + 1] << 8); };
  return {bytes[0], bytes[1], word(2), word(4), word(6)};
}

std::uint16_t UsbDescriptors::word(std::size_t at) const { return static_cast<std::uint16_t>(device.at(at) | device.at(at + 1) << 8); }

const std::string& UsbDescriptors::serial() const {
  static const std::string kNone;
  const std::size_t index = device.at(16);
  return index == 0 || index > strings.size() ? kNone : strings[index - 1];
}

ControlReply UsbFunction::control(const UsbSetup& setup, std::span<const std::uint8_t> data_out, std::int64_t now_ns) {
  if (!setup.is_vendor()) return standard_request(setup);
  ControlReply reply = vendor_request(setup, data_out, now_ns);
  if (reply.data.size() > setup.length) reply.data.resize(setup.length);
  return reply;
}

ControlReply UsbFunction::standard_request(const UsbSetup& setup) const {
  switch (setup.request) {
    case kGetStatus: return answer({1, 0}, setup.length);
    case kGetDescriptor: return descriptor(setup);
    case kGetConfiguration: return answer({1}, setup.length);
    case kGetInterface: return answer({0}, setup.length);
    case kSetConfiguration: return setup.value <= 1 ? ControlReply{} : stalled();
    case kSetInterface: return setup.value == 0 ? ControlReply{} : stalled();
    case kClearFeature:
    case kSetFeature:
    case kSetAddress: return {};
    default: return stalled();
  }
}

ControlReply UsbFunction::descriptor(const UsbSetup& setup) const {
  const int type = setup.value >> 8;
  const std::size_t index = setup.value & 0xff;
  if (type == kDeviceDescriptor) return answer(descriptors_.device, setup.length);
  if (type == kConfigurationDescriptor && index == 0) return answer(descriptors_.configuration, setup.length);
  if (type != kStringDescriptor || index > descriptors_.strings.size()) return stalled();
  if (index == 0) return answer({4, kStringDescriptor, kEnglishLow, kEnglishHigh}, setup.length);
  return answer(string_descriptor(descriptors_.strings[index - 1]), setup.length);
}

}  // namespace camloc::fakes
