// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Video nodes in process, behind the seam of drivers/v4l2/v4l2_io.h: they answer the ioctls as the kernel's videobuf2 does, with
// a clock of their own that only poll() moves, and with faults at the test's choice.
#pragma once

#include <linux/videodev2.h>

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "drivers/v4l2/v4l2_io.h"

namespace camloc::testing {

struct FakeSize {
  int width = 0, height = 0;
  std::vector<double> rates_hz;
  int min_width = 0, min_height = 0, step = 0;  ///< with a step: all sizes from min to width x height
};

struct FakeFormat {
  std::uint32_t fourcc = 0;
  std::vector<FakeSize> sizes;
};

struct FakeControl {
  std::uint32_t id = 0, type = V4L2_CTRL_TYPE_INTEGER, flags = 0;
  std::string name;
  int minimum = 0, maximum = 255;
  std::vector<std::string> menu;  ///< "" is a gap
};

/// What goes wrong; may be changed while the node streams.
struct FakeFaults {
  bool is_gone = false;     ///< unplugged: ENODEV from now on
  bool is_busy = false;     ///< another program has the format: EBUSY
  bool is_stalled = false;  ///< exposes nothing any more
  bool never_stops_listing = false;
  bool has_poll_error = false;    ///< POLLERR, but no frame and no error from the call that fetches one
  bool leaves_out_rates = false;  ///< VIDIOC_S_PARM is not implemented
  bool leaves_out_sizes = false;  ///< VIDIOC_ENUM_FRAMESIZES is not implemented
  int num_buffers = 0;            ///< gives so many buffers; 0: as many as asked for
  std::optional<std::uint32_t> bytesperline, sizeimage, buffer_length, fourcc_set, width_set, field_set, num_planes_set;
  std::optional<std::uint32_t> index;      ///< of the buffer handed out
  std::optional<std::uint32_t> bytesused;  ///< of the frames from now on
  std::uint32_t buffer_flags = 0;          ///< put on the frames from now on
  std::optional<timeval> stamp;            ///< instead of the time of exposure
  std::uint32_t sequence_jump = 0;         ///< added once
};

struct FakeNode {
  std::string card = "Fake Camera", driver = "fake";
  std::uint32_t capabilities = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
  std::vector<FakeFormat> formats;
  std::vector<FakeControl> controls;
  std::uint32_t stamp_flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | V4L2_BUF_FLAG_TSTAMP_SRC_SOE;
  std::uint32_t padding_bytes = 0;  ///< at the end of every row
  std::uint32_t colorspace = V4L2_COLORSPACE_SRGB, quantization = V4L2_QUANTIZATION_DEFAULT;
  std::int64_t phase_ns = 0;  ///< first exposure after the stream starts
  /// Fills a plane of exposure `number`; returns the bytes used. Without one the bytes are the number of the exposure.
  std::function<std::size_t(std::uint64_t number, unsigned plane, std::span<std::uint8_t> bytes)> paint;
  FakeFaults faults;

  // What the source under test did.
  std::vector<std::pair<std::string, int>> controls_set;
  int num_starts = 0, num_stops = 0, num_resets = 0;
  v4l2_format format{};
  double rate_hz = 0;
};

class FakeV4l2 final : public V4l2Io {
 public:
  /// A node; one without formats can stand for the USB device that is to be reset. The reference stays valid.
  FakeNode& add(const std::string& path) { return nodes_[path].node; }
  [[nodiscard]] FakeNode& node(const std::string& path) { return nodes_.at(path).node; }
  [[nodiscard]] int num_open() const { return static_cast<int>(open_.size()); }
  [[nodiscard]] std::size_t num_mapped() const { return num_mapped_; }
  void advance_ns(std::int64_t ns);

  [[nodiscard]] int open(const std::string& path) override;
  void close(int fd) override;
  [[nodiscard]] int ioctl(int fd, unsigned long request, void* argument) override;
  [[nodiscard]] const std::uint8_t* map(int fd, std::size_t length, std::int64_t offset) override;
  void unmap(const std::uint8_t* bytes, std::size_t length) override;
  [[nodiscard]] int poll(pollfd* fds, std::size_t count, int timeout_ms) override;
  [[nodiscard]] std::int64_t monotonic_ns() override { return now_ns_; }

 private:
  struct Buffer {
    std::vector<std::vector<std::uint8_t>> planes;
    std::vector<std::uint32_t> bytesused;
    std::uint32_t sequence = 0, flags = 0;
    timeval stamp{};
  };
  struct State {
    FakeNode node;
    std::vector<Buffer> buffers;
    std::vector<unsigned> queued, done;  // vectors, so that nothing is allocated per frame
    bool is_streaming = false;
    std::int64_t next_exposure_ns = 0;
    std::uint64_t exposure = 0;
    std::uint32_t sequence = 0;
  };

  [[nodiscard]] static bool is_multiplanar(const State& state) { return (state.node.capabilities & V4L2_CAP_VIDEO_CAPTURE_MPLANE) != 0; }
  static int list_format(State& state, v4l2_fmtdesc* format);
  static int list_size(State& state, v4l2_frmsizeenum* size);
  static int list_rate(State& state, v4l2_frmivalenum* interval);
  static int set_format(State& state, v4l2_format* format);
  static int set_rate(State& state, v4l2_streamparm* parameters);
  static int request_buffers(State& state, v4l2_requestbuffers* request);
  static int query_buffer(State& state, v4l2_buffer* buffer);
  static int queue_buffer(State& state, const v4l2_buffer& buffer);
  static int fetch_buffer(State& state, v4l2_buffer* buffer);
  static int list_control(State& state, v4l2_query_ext_ctrl* query);
  static int list_menu(State& state, v4l2_querymenu* entry);
  static int set_controls(State& state, const v4l2_ext_controls& controls);
  int start(State& state);
  static int stop(State& state);
  static void expose(State& state);
  [[nodiscard]] std::int64_t next_event_ns(std::int64_t limit_ns) const;

  std::map<std::string, State> nodes_;
  std::map<int, State*> open_;
  int next_fd_ = 100;
  std::size_t num_mapped_ = 0;
  std::int64_t now_ns_ = 50'000'000'000;
};

}  // namespace camloc::testing
