// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// See fake_v4l2.h.
#include "tests/drivers/fake_v4l2.h"

#include <linux/usbdevice_fs.h>
#include <sys/ioctl.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>

#include "drivers/v4l2/v4l2_pixel_format.h"

namespace camloc::testing {

namespace {

constexpr std::int64_t kNsPerSecond = 1'000'000'000;
constexpr std::uint32_t kJpegRoom = 1 << 20;
constexpr std::uint32_t kPlaneOffset = 0x1000;  // of plane p of buffer i: (2 i + p) times that

template <typename T, std::size_t N>
void copy_text(const std::string& text, T (&field)[N]) {
  std::memcpy(field, text.data(), std::min(text.size(), N - 1));
}

v4l2_fract interval_of(double rate_hz) { return {1000, static_cast<std::uint32_t>(std::lround(rate_hz * 1000))}; }

const FakeFormat* find_format(const FakeNode& node, std::uint32_t fourcc) {
  const auto found = std::find_if(node.formats.begin(), node.formats.end(), [&](const FakeFormat& f) { return f.fourcc == fourcc; });
  return found == node.formats.end() ? nullptr : &*found;
}

/// Bytes a row and a plane as an honest driver computes them.
std::pair<std::uint32_t, std::uint32_t> honest_bytes(const FakeNode& node, std::uint32_t fourcc, int width, int height, unsigned plane) {
  const V4l2PixelFormat* format = find_v4l2_pixel_format(fourcc);
  if (format == nullptr || format->layout == PixelLayout::kJpeg) return {0, kJpegRoom};
  const auto stride = static_cast<std::uint32_t>(min_row_bytes(*format, width)) + node.padding_bytes;
  const int rows = format->layout != PixelLayout::kNv12 ? height
                   : format->num_planes == 1            ? height + (height + 1) / 2
                   : plane == 0                         ? height
                                                        : (height + 1) / 2;
  return {stride, stride * static_cast<std::uint32_t>(rows)};
}

unsigned num_planes(std::uint32_t fourcc) {
  const V4l2PixelFormat* format = find_v4l2_pixel_format(fourcc);
  return format == nullptr ? 1 : format->num_planes;
}

std::uint32_t plane_size(const FakeNode& node, bool is_multiplanar, unsigned plane) {
  if (node.faults.buffer_length) return *node.faults.buffer_length;
  return is_multiplanar ? node.format.fmt.pix_mp.plane_fmt[plane].sizeimage : node.format.fmt.pix.sizeimage;
}

}  // namespace

int FakeV4l2::open(const std::string& path) {
  const auto found = nodes_.find(path);
  if (found == nodes_.end()) return -ENOENT;
  if (found->second.node.faults.is_gone) return -ENODEV;
  open_[next_fd_] = &found->second;
  return next_fd_++;
}

void FakeV4l2::close(int fd) { open_.erase(fd); }

int FakeV4l2::ioctl(int fd, unsigned long request, void* argument) {
  if (!open_.contains(fd)) return -EBADF;
  State& state = *open_.at(fd);
  if (state.node.faults.is_gone) return -ENODEV;
  switch (request) {
    case VIDIOC_QUERYCAP: {
      auto* capability = static_cast<v4l2_capability*>(argument);
      copy_text(state.node.card, capability->card);
      copy_text(state.node.driver, capability->driver);
      copy_text("fake-bus-1", capability->bus_info);
      capability->device_caps = state.node.capabilities;
      capability->capabilities = state.node.capabilities | V4L2_CAP_DEVICE_CAPS | V4L2_CAP_META_CAPTURE;
      return 0;
    }
    case VIDIOC_ENUM_FMT: return list_format(state, static_cast<v4l2_fmtdesc*>(argument));
    case VIDIOC_ENUM_FRAMESIZES: return list_size(state, static_cast<v4l2_frmsizeenum*>(argument));
    case VIDIOC_ENUM_FRAMEINTERVALS: return list_rate(state, static_cast<v4l2_frmivalenum*>(argument));
    case VIDIOC_S_FMT: return set_format(state, static_cast<v4l2_format*>(argument));
    case VIDIOC_S_PARM: return set_rate(state, static_cast<v4l2_streamparm*>(argument));
    case VIDIOC_QUERY_EXT_CTRL: return list_control(state, static_cast<v4l2_query_ext_ctrl*>(argument));
    case VIDIOC_QUERYMENU: return list_menu(state, static_cast<v4l2_querymenu*>(argument));
    case VIDIOC_S_EXT_CTRLS: return set_controls(state, *static_cast<const v4l2_ext_controls*>(argument));
    case VIDIOC_REQBUFS: return request_buffers(state, static_cast<v4l2_requestbuffers*>(argument));
    case VIDIOC_QUERYBUF: return query_buffer(state, static_cast<v4l2_buffer*>(argument));
    case VIDIOC_QBUF: return queue_buffer(state, *static_cast<const v4l2_buffer*>(argument));
    case VIDIOC_DQBUF: return fetch_buffer(state, static_cast<v4l2_buffer*>(argument));
    case VIDIOC_STREAMON: return start(state);
    case VIDIOC_STREAMOFF: return stop(state);
    case USBDEVFS_RESET: ++state.node.num_resets; return 0;
    default: return -ENOTTY;
  }
}

int FakeV4l2::list_format(State& state, v4l2_fmtdesc* format) {
  const FakeNode& node = state.node;
  if (node.formats.empty()) return -EINVAL;
  if (format->index >= node.formats.size() && !node.faults.never_stops_listing) return -EINVAL;
  format->pixelformat = node.formats[format->index % node.formats.size()].fourcc;
  return 0;
}

int FakeV4l2::list_size(State& state, v4l2_frmsizeenum* size) {
  const FakeFormat* format = find_format(state.node, size->pixel_format);
  if (state.node.faults.leaves_out_sizes) return -ENOTTY;
  if (format == nullptr || format->sizes.empty()) return -EINVAL;
  if (size->index >= format->sizes.size() && !state.node.faults.never_stops_listing) return -EINVAL;
  const FakeSize& s = format->sizes[size->index % format->sizes.size()];
  const auto width = static_cast<std::uint32_t>(s.width), height = static_cast<std::uint32_t>(s.height),
             step = static_cast<std::uint32_t>(s.step);
  size->type = s.step == 0 ? V4L2_FRMSIZE_TYPE_DISCRETE : V4L2_FRMSIZE_TYPE_STEPWISE;
  if (s.step == 0) {
    size->discrete = {width, height};
  } else {
    size->stepwise = {static_cast<std::uint32_t>(s.min_width), width, step, static_cast<std::uint32_t>(s.min_height), height, step};
  }
  return 0;
}

int FakeV4l2::list_rate(State& state, v4l2_frmivalenum* interval) {
  const FakeFormat* format = find_format(state.node, interval->pixel_format);
  if (format == nullptr) return -EINVAL;
  for (const FakeSize& size : format->sizes) {
    const auto is_in = [&](std::uint32_t side, int low, int high) {
      return static_cast<int>(side) >= (size.step != 0 ? low : high) && static_cast<int>(side) <= high;
    };
    if (!is_in(interval->width, size.min_width, size.width) || !is_in(interval->height, size.min_height, size.height)) continue;
    if (size.rates_hz.empty()) return -EINVAL;
    if (interval->index >= size.rates_hz.size() && !state.node.faults.never_stops_listing) return -EINVAL;
    interval->type = V4L2_FRMIVAL_TYPE_DISCRETE;
    interval->discrete = interval_of(size.rates_hz[interval->index % size.rates_hz.size()]);
    return 0;
  }
  return -EINVAL;
}

int FakeV4l2::set_format(State& state, v4l2_format* format) {
  FakeNode& node = state.node;
  if (node.faults.is_busy) return -EBUSY;
  const bool is_planes = is_multiplanar(state);
  if (format->type != (is_planes ? V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE : V4L2_BUF_TYPE_VIDEO_CAPTURE)) return -EINVAL;
  const std::uint32_t fourcc = is_planes ? format->fmt.pix_mp.pixelformat : format->fmt.pix.pixelformat;
  const auto width = static_cast<int>(is_planes ? format->fmt.pix_mp.width : format->fmt.pix.width);
  const auto height = static_cast<int>(is_planes ? format->fmt.pix_mp.height : format->fmt.pix.height);
  if (is_planes) {
    v4l2_pix_format_mplane& p = format->fmt.pix_mp;
    p.num_planes = static_cast<std::uint8_t>(node.faults.num_planes_set.value_or(num_planes(fourcc)));
    for (unsigned plane = 0; plane < num_planes(fourcc); ++plane) {
      const auto [stride, bytes] = honest_bytes(node, fourcc, width, height, plane);
      p.plane_fmt[plane].bytesperline = node.faults.bytesperline.value_or(stride);
      p.plane_fmt[plane].sizeimage = node.faults.sizeimage.value_or(bytes);
    }
  } else {
    v4l2_pix_format& p = format->fmt.pix;
    const auto [stride, bytes] = honest_bytes(node, fourcc, width, height, 0);
    p.bytesperline = node.faults.bytesperline.value_or(stride);
    p.sizeimage = node.faults.sizeimage.value_or(bytes);
    p.colorspace = node.colorspace;
    p.quantization = node.quantization;
    p.pixelformat = node.faults.fourcc_set.value_or(fourcc);
    p.width = node.faults.width_set.value_or(p.width);
    p.field = node.faults.field_set.value_or(V4L2_FIELD_NONE);
  }
  node.format = *format;
  return 0;
}

int FakeV4l2::set_rate(State& state, v4l2_streamparm* parameters) {
  if (state.node.faults.leaves_out_rates) return -ENOTTY;
  v4l2_captureparm& capture = parameters->parm.capture;
  state.node.rate_hz = static_cast<double>(capture.timeperframe.denominator) / capture.timeperframe.numerator;
  capture.capability = V4L2_CAP_TIMEPERFRAME;
  return 0;
}

int FakeV4l2::request_buffers(State& state, v4l2_requestbuffers* request) {
  if (state.is_streaming || request->memory != V4L2_MEMORY_MMAP) return -EBUSY;
  if (state.node.faults.num_buffers > 0) request->count = static_cast<std::uint32_t>(state.node.faults.num_buffers);
  const unsigned planes = is_multiplanar(state) ? num_planes(state.node.format.fmt.pix_mp.pixelformat) : 1;
  state.buffers.assign(request->count, {});
  for (Buffer& buffer : state.buffers) {
    for (unsigned plane = 0; plane < planes; ++plane)
      buffer.planes.emplace_back(std::min(plane_size(state.node, is_multiplanar(state), plane), 1U << 24));
    buffer.bytesused.resize(planes);
  }
  return 0;
}

int FakeV4l2::query_buffer(State& state, v4l2_buffer* buffer) {
  if (buffer->index >= state.buffers.size()) return -EINVAL;
  buffer->flags = state.node.stamp_flags;
  if (is_multiplanar(state)) {
    for (unsigned plane = 0; plane < state.buffers[buffer->index].planes.size(); ++plane) {
      buffer->m.planes[plane].length = plane_size(state.node, true, plane);
      buffer->m.planes[plane].m.mem_offset = (2 * buffer->index + plane) * kPlaneOffset;
    }
  } else {
    buffer->length = plane_size(state.node, false, 0);
    buffer->m.offset = 2 * buffer->index * kPlaneOffset;
  }
  return 0;
}

int FakeV4l2::queue_buffer(State& state, const v4l2_buffer& buffer) {
  const bool is_known = buffer.index < state.buffers.size();
  const bool is_in =
      std::count(state.queued.begin(), state.queued.end(), buffer.index) + std::count(state.done.begin(), state.done.end(), buffer.index) >
      0;
  if (!is_known || is_in) return -EINVAL;
  state.queued.push_back(buffer.index);
  return 0;
}

int FakeV4l2::fetch_buffer(State& state, v4l2_buffer* buffer) {
  if (!state.is_streaming) return -EINVAL;
  if (state.done.empty()) return -EAGAIN;
  const unsigned index = state.done.front();
  state.done.erase(state.done.begin());
  const Buffer& done = state.buffers[index];
  buffer->index = state.node.faults.index.value_or(index);
  buffer->flags = done.flags;
  buffer->sequence = done.sequence;
  buffer->timestamp = done.stamp;
  if (is_multiplanar(state)) {
    for (unsigned plane = 0; plane < done.planes.size(); ++plane) buffer->m.planes[plane].bytesused = done.bytesused[plane];
  } else {
    buffer->bytesused = done.bytesused[0];
  }
  return 0;
}

int FakeV4l2::list_control(State& state, v4l2_query_ext_ctrl* query) {
  const std::uint32_t after = query->id & ~static_cast<std::uint32_t>(V4L2_CTRL_FLAG_NEXT_CTRL | V4L2_CTRL_FLAG_NEXT_COMPOUND);
  if (state.node.faults.never_stops_listing) {
    *query = {};
    query->id = after + 1;
    query->type = V4L2_CTRL_TYPE_INTEGER;
    return 0;
  }
  for (const FakeControl& control : state.node.controls) {
    if (control.id <= after) continue;
    *query = {};
    query->id = control.id;
    query->type = control.type;
    query->flags = control.flags;
    query->minimum = control.minimum;
    query->maximum = control.maximum;
    copy_text(control.name, query->name);
    return 0;
  }
  return -EINVAL;
}

int FakeV4l2::list_menu(State& state, v4l2_querymenu* entry) {
  for (const FakeControl& control : state.node.controls) {
    if (control.id != entry->id || entry->index >= control.menu.size() || control.menu[entry->index].empty()) continue;
    std::memcpy(entry->name, control.menu[entry->index].c_str(), control.menu[entry->index].size() + 1);
    return 0;
  }
  return -EINVAL;
}

int FakeV4l2::set_controls(State& state, const v4l2_ext_controls& controls) {
  for (const FakeControl& control : state.node.controls) {
    if (control.id != controls.controls[0].id) continue;
    state.node.controls_set.emplace_back(control.name, int{controls.controls[0].value});
    return 0;
  }
  return -EINVAL;
}

int FakeV4l2::start(State& state) {
  if (state.buffers.empty()) return -EINVAL;
  state.is_streaming = true;
  state.sequence = 0;
  state.next_exposure_ns = now_ns_ + state.node.phase_ns;
  ++state.node.num_starts;
  return 0;
}

int FakeV4l2::stop(State& state) {
  if (state.is_streaming) ++state.node.num_stops;
  state.is_streaming = false;
  state.queued.clear();
  state.done.clear();
  return 0;
}

/// One exposure into the next free buffer, or lost for want of one.
void FakeV4l2::expose(State& state) {
  const FakeFaults& faults = state.node.faults;
  const std::uint64_t number = state.exposure++;
  const std::uint32_t sequence = state.sequence++ + faults.sequence_jump;
  state.sequence += std::exchange(state.node.faults.sequence_jump, 0);
  const std::int64_t at_ns = state.next_exposure_ns;
  state.next_exposure_ns += std::llround(1e9 / (state.node.rate_hz > 0 ? state.node.rate_hz : 30));
  if (faults.is_stalled || state.queued.empty()) return;
  const unsigned index = state.queued.front();
  state.queued.erase(state.queued.begin());
  Buffer& buffer = state.buffers[index];
  for (unsigned plane = 0; plane < buffer.planes.size(); ++plane) {
    std::vector<std::uint8_t>& bytes = buffer.planes[plane];
    std::size_t used = bytes.size();
    if (state.node.paint) {
      used = state.node.paint(number, plane, bytes);
    } else {
      std::fill(bytes.begin(), bytes.end(), static_cast<std::uint8_t>(number));
    }
    buffer.bytesused[plane] = faults.bytesused.value_or(static_cast<std::uint32_t>(used));
  }
  buffer.sequence = sequence;
  buffer.flags = state.node.stamp_flags | faults.buffer_flags;
  buffer.stamp = faults.stamp.value_or(timeval{at_ns / kNsPerSecond, at_ns % kNsPerSecond / 1000});
  state.done.push_back(index);
}

const std::uint8_t* FakeV4l2::map(int fd, std::size_t length, std::int64_t offset) {
  if (!open_.contains(fd)) return nullptr;
  State& state = *open_.at(fd);
  const auto slot = static_cast<std::size_t>(offset / kPlaneOffset);
  if (slot / 2 >= state.buffers.size() || slot % 2 >= state.buffers[slot / 2].planes.size()) return nullptr;
  const std::vector<std::uint8_t>& plane = state.buffers[slot / 2].planes[slot % 2];
  if (length > plane.size()) return nullptr;
  ++num_mapped_;
  return plane.data();
}

void FakeV4l2::unmap(const std::uint8_t* /*bytes*/, std::size_t /*length*/) { --num_mapped_; }

std::int64_t FakeV4l2::next_event_ns(std::int64_t limit_ns) const {
  std::int64_t next_ns = limit_ns;
  for (const auto& [path, state] : nodes_) {
    if (state.is_streaming) next_ns = std::min(next_ns, state.next_exposure_ns);
  }
  return next_ns;
}

void FakeV4l2::advance_ns(std::int64_t ns) {
  const std::int64_t end_ns = now_ns_ + ns;
  while (true) {
    now_ns_ = std::max(now_ns_, next_event_ns(end_ns));
    for (auto& [path, state] : nodes_) {
      while (state.is_streaming && state.next_exposure_ns <= now_ns_) expose(state);
    }
    if (now_ns_ >= end_ns) return;
  }
}

int FakeV4l2::poll(pollfd* fds, std::size_t count, int timeout_ms) {
  const std::int64_t end_ns = now_ns_ + std::int64_t{timeout_ms} * 1'000'000;
  while (true) {
    int ready = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const State& state = *open_.at(fds[i].fd);
      fds[i].revents = 0;
      if (state.node.faults.is_gone || state.node.faults.has_poll_error || !state.is_streaming) fds[i].revents = POLLERR | POLLHUP;
      if (!state.done.empty() && !state.node.faults.is_gone) fds[i].revents = static_cast<short>(fds[i].revents | POLLIN);
      ready += fds[i].revents != 0;
    }
    if (ready > 0 || now_ns_ >= end_ns) return ready;
    advance_ns(std::max<std::int64_t>(next_event_ns(end_ns) - now_ns_, 1));
  }
}

}  // namespace camloc::testing
