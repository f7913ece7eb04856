// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A node that streams: four buffers shared with the kernel go round, each is looked at where it lies and given back.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "core/base/result.h"
#include "drivers/v4l2/v4l2_conversion.h"
#include "drivers/v4l2/v4l2_device.h"
#include "drivers/v4l2/v4l2_negotiation.h"

struct v4l2_buffer;

namespace camloc {

/// Where the stamp of a frame comes from, by the flags of its buffer.
enum class V4l2StampSource : std::uint8_t {
  kStartOfExposure,  ///< CLOCK_MONOTONIC when the exposure began: taken as it is
  kEndOfFrame,       ///< CLOCK_MONOTONIC when the last pixel had come
  kArrival,          ///< the driver names no clock, or one that cannot be: when the frame was taken from the driver
};

/// A frame in a buffer of the kernel, until it is given back.
struct V4l2Frame {
  unsigned index = 0;
  V4l2Planes planes;           ///< checked to hold the frame that was agreed on
  std::int64_t stamp_ns = 0;   ///< CLOCK_MONOTONIC at the start of exposure; later than that of the frame before
  std::uint64_t exposure = 0;  ///< counts those that were lost, too
};

/// Not thread-safe. Allocates nothing after open(). The V4l2Io outlives it.
class V4l2Stream {
 public:
  /// Asks for buffers and maps them; start() is still to be called. kCorrupt: the device contradicts itself; kUnavailable:
  /// in use, gone or out of memory.
  [[nodiscard]] static Result<std::unique_ptr<V4l2Stream>> open(V4l2Device device, const V4l2Agreement& agreement);
  ~V4l2Stream();
  V4l2Stream(const V4l2Stream&) = delete;
  V4l2Stream& operator=(const V4l2Stream&) = delete;

  /// Gives all buffers to the driver and starts. kUnavailable when that fails.
  [[nodiscard]] Status start();
  /// Takes all buffers back; what was not given back is void.
  void stop();

  /// The oldest finished frame; false: none yet. kCorrupt: the driver marked it or bytes are missing, it is given back already;
  /// kUnavailable: the camera is gone, and for good.
  [[nodiscard]] Result<bool> take(V4l2Frame* frame);
  void give_back(const V4l2Frame& frame);

  [[nodiscard]] const V4l2Device& device() const { return device_; }
  [[nodiscard]] const V4l2ImageLayout& layout() const { return agreed_.layout; }
  [[nodiscard]] double rate_hz() const { return agreed_.rate_hz; }  ///< 0: the device does not tell
  /// Of the last frame; before the first what the buffers announce.
  [[nodiscard]] V4l2StampSource stamp_source() const { return stamp_source_; }
  [[nodiscard]] std::uint64_t num_lost() const { return num_lost_; }  ///< gaps in the driver's count
  [[nodiscard]] std::uint64_t num_damaged() const { return num_damaged_; }

 private:
  struct Buffer {
    V4l2Planes planes;
    bool is_queued = false;
  };

  V4l2Stream(V4l2Device device, const V4l2Agreement& agreement) : device_(std::move(device)), agreed_(agreement) {}
  [[nodiscard]] Status map_buffers();
  [[nodiscard]] Status map_buffer(unsigned index, Buffer* buffer);
  void unmap_buffers();
  [[nodiscard]] int queue(unsigned index);
  [[nodiscard]] Status gone() const;
  [[nodiscard]] Status read_planes(const v4l2_buffer& buffer, V4l2Planes* planes) const;
  [[nodiscard]] std::int64_t stamp(const v4l2_buffer& buffer);
  void count_exposure(std::uint32_t sequence);

  V4l2Device device_;
  V4l2Agreement agreed_;
  std::vector<Buffer> buffers_;
  int error_ = 0;  ///< negative errno of the call after which nothing works any more
  V4l2StampSource stamp_source_ = V4l2StampSource::kArrival;
  std::int64_t last_stamp_ns_ = 0;
  std::optional<std::uint32_t> last_sequence_;
  std::uint64_t exposure_ = 0;
  std::uint64_t num_lost_ = 0;
  std::uint64_t num_damaged_ = 0;
};

}  // namespace camloc
