// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Arbitrary bytes as an .oni recording: it opens and plays to its end with whole images, or an error says why in one line.
#include <sys/mman.h>
#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "drivers/sources.h"

namespace {

void require(bool condition) {
  if (!condition) std::abort();
}

template <typename T>
bool is_whole(const camloc::Image<T>& image) {
  return image.pixels.size() == static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
}

void play(camloc::FrameSource* source) {
  const camloc::FrameSourceInfo& info = source->info();
  // Damage may announce huge images; they take memory and time, and show nothing new.
  if (info.color_width * info.color_height > 1 << 20 || info.depth_width * info.depth_height > 1 << 20) return;
  require(info.num_frames.has_value());
  camloc::FrameBuffer frame;
  for (std::uint64_t i = 0; i < *info.num_frames; ++i) {
    const camloc::Status status = source->next(&frame, std::chrono::milliseconds(0));
    require(status || status.code() == camloc::ErrorCode::kCorrupt);
    if (!status) continue;
    require(frame.gray.width == info.color_width && frame.gray.height == info.color_height);
    require(is_whole(frame.gray) && is_whole(frame.depth) && is_whole(frame.color));
  }
  require(source->next(&frame, std::chrono::milliseconds(0)).code() == camloc::ErrorCode::kEnd);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const int file = ::memfd_create("oni", MFD_CLOEXEC);
  require(file >= 0 && ::ftruncate(file, 0) == 0 && ::pwrite(file, data, size, 0) == static_cast<ssize_t>(size));
  const std::string url = "oni:///proc/self/fd/" + std::to_string(file);
  for (const bool wants_color : {false, true}) {
    auto source = camloc::open_frame_source(url + "?registered=1", {wants_color});
    if (source) play(source->get());
    if (!source) require(source.status().message().find('\n') == std::string::npos);
  }
  return 0;
}
