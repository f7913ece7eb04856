// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/common/frame_reading.h"

#include <algorithm>
#include <chrono>

#include "drivers/source_url.h"

namespace camloc::tools {

Result<FrameCounts> read_frames(FrameSource& source, const FrameVisitor& on_frame, const WorkObserver& observer) {
  FrameCounts counts;
  FrameBuffer buffer;
  while (!observer.should_stop()) {
    const Status status = source.next(&buffer, std::chrono::milliseconds(1000));
    if (status.code() == ErrorCode::kEnd) break;
    if (status.code() == ErrorCode::kTimeout) continue;
    if (!status && status.code() != ErrorCode::kCorrupt) return status;
    ++counts.num_frames;
    if (!status) {
      if (counts.num_corrupt++ == 0) counts.first_corrupt = status.message();
      continue;
    }
    if (Status seen = on_frame(buffer); !seen) return seen;
  }
  return counts;
}

Status all_frames_corrupt(const FrameCounts& counts) {
  return {ErrorCode::kCorrupt,
          "none of " + std::to_string(counts.num_frames) + " frames could be read, the first because of " + counts.first_corrupt};
}

std::string with_selection(const std::string& url, const std::string& frames, const std::string& exclude) {
  std::string out = as_source_url(url);
  const auto add = [&out](const std::string& key, const std::string& value) {
    if (value.empty()) return;
    out += (out.find('?') == std::string::npos ? "?" : "&") + key + "=" + value;
  };
  add("frames", frames);
  add("exclude", exclude);
  return out;
}

std::string selection_of(const std::set<std::uint64_t>& frames, std::uint64_t num_before) {
  std::string text;
  for (const std::uint64_t frame : frames)
    text += (text.empty() ? "" : ",") + std::to_string(frame - std::min(frame, num_before)) + ":" + std::to_string(frame + 1);
  return text;
}

}  // namespace camloc::tools
