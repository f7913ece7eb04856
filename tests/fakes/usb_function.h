// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A USB device as its host sees it on endpoint 0: descriptors and control requests. Knows no transport and no clock; time comes in
// as nanoseconds since the device was powered. Facts: "Universal Serial Bus Specification", revision 2.0, chapter 9.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace camloc::fakes {

struct UsbSetup {
  std::uint8_t request_type = 0;
  std::uint8_t request = 0;
  std::uint16_t value = 0;
  std::uint16_t index = 0;
  std::uint16_t length = 0;

  [[nodiscard]] bool is_in() const { return (request_type & 0x80) != 0; }
  [[nodiscard]] bool is_vendor() const { return (request_type & 0x60) == 0x40; }
};
/// The eight bytes of a setup packet, little endian. `bytes` holds at least eight.
[[nodiscard]] UsbSetup parse_setup(std::span<const std::uint8_t> bytes);

struct ControlReply {
  bool is_stalled = false;         ///< the device refuses; the host sees EPIPE
  std::vector<std::uint8_t> data;  ///< of an IN request, at most setup.length bytes; may be empty
};

struct UsbDescriptors {
  std::vector<std::uint8_t> device;         ///< 18 bytes
  std::vector<std::uint8_t> configuration;  ///< with interfaces and endpoints
  std::vector<std::string> strings;         ///< strings[0] is string descriptor 1; ASCII

  [[nodiscard]] std::uint16_t vendor_id() const { return word(8); }
  [[nodiscard]] std::uint16_t product_id() const { return word(10); }
  [[nodiscard]] std::uint16_t release_bcd() const { return word(12); }
  [[nodiscard]] const std::string& serial() const;  ///< empty where the device has none

 private:
  [[nodiscard]] std::uint16_t word(std::size_t at) const;
};

class UsbFunction {
 public:
  explicit UsbFunction(UsbDescriptors descriptors) : descriptors_(std::move(descriptors)) {}
  virtual ~UsbFunction() = default;
  UsbFunction(const UsbFunction&) = delete;
  UsbFunction& operator=(const UsbFunction&) = delete;

  [[nodiscard]] const UsbDescriptors& descriptors() const { return descriptors_; }
  /// Answers any request; `data_out` is the data stage of an OUT request.
  [[nodiscard]] ControlReply control(const UsbSetup& setup, std::span<const std::uint8_t> data_out, std::int64_t now_ns);
  /// Back to the state after power-up.
  virtual void reset(std::int64_t now_ns) = 0;

 protected:
  [[nodiscard]] virtual ControlReply vendor_request(const UsbSetup& setup, std::span<const std::uint8_t> data_out, std::int64_t now_ns) = 0;

 private:
  [[nodiscard]] ControlReply standard_request(const UsbSetup& setup) const;
  [[nodiscard]] ControlReply descriptor(const UsbSetup& setup) const;

  UsbDescriptors descriptors_;
};

}  // namespace camloc::fakes
