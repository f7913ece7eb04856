// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// One opened video node: what it says it is, and what formats, sizes and rates it says it offers.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "drivers/v4l2/v4l2_io.h"

namespace camloc {

/// Sizes from min to max in steps; one size has min == max.
struct V4l2SizeRange {
  int min_width = 0, max_width = 0, step_width = 1;
  int min_height = 0, max_height = 0, step_height = 1;
  [[nodiscard]] bool is_one() const { return min_width == max_width && min_height == max_height; }
};

/// Rates from min to max; one rate has min == max.
struct V4l2RateRange {
  double min_hz = 0, max_hz = 0;
};

struct V4l2SizeOffer {
  V4l2SizeRange size;
  std::vector<V4l2RateRange> rates;  ///< of the largest size; empty: the driver does not tell
};

struct V4l2FormatOffer {
  std::uint32_t fourcc = 0;
  std::vector<V4l2SizeOffer> sizes;  ///< empty: the driver does not tell
};

/// Not thread-safe. The V4l2Io outlives it.
class V4l2Device {
 public:
  /// kUnavailable: not there or in use; kIo: no permission; kUnsupported: no camera, or one that does not stream.
  [[nodiscard]] static Result<V4l2Device> open(V4l2Io& io, const std::string& path);

  [[nodiscard]] const std::string& path() const { return path_; }
  [[nodiscard]] const std::string& card() const { return card_; }      ///< its name for people
  [[nodiscard]] const std::string& driver() const { return driver_; }  ///< of the kernel
  [[nodiscard]] const std::string& bus() const { return bus_; }
  [[nodiscard]] bool is_multiplanar() const { return is_multiplanar_; }
  [[nodiscard]] std::uint32_t buffer_type() const;
  [[nodiscard]] int fd() const { return fd_.get(); }
  [[nodiscard]] V4l2Io& io() const { return fd_.io(); }
  [[nodiscard]] int ioctl(unsigned long request, void* argument) const { return io().ioctl(fd(), request, argument); }

  /// What the device lists, formats that are not read here included. Bounded, however long a device goes on.
  [[nodiscard]] std::vector<V4l2FormatOffer> offers() const;
  /// The rates at one size; empty: the driver does not tell.
  [[nodiscard]] std::vector<V4l2RateRange> rate_offers(std::uint32_t fourcc, int width, int height) const;

 private:
  V4l2Device(std::string path, V4l2Fd fd) : path_(std::move(path)), fd_(std::move(fd)) {}
  [[nodiscard]] std::vector<V4l2SizeOffer> size_offers(std::uint32_t fourcc) const;

  std::string path_, card_, driver_, bus_;
  V4l2Fd fd_;
  bool is_multiplanar_ = false;
};

/// "YUYV, UYVY 640x480 (30 15 Hz) 320x240 (60 Hz); Z16 640x480 (30 Hz)", cut off where it gets too long to read.
[[nodiscard]] std::string offers_line(const std::vector<V4l2FormatOffer>& offers);

}  // namespace camloc
