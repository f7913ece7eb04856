// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A camera of the test, and all frames of a source.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <ctime>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "drivers/sources.h"
#include "tools/recording/recording_folder.h"

namespace camloc::tools {

inline std::vector<FrameBuffer> all_frames(const std::string& url, bool wants_color = false) {
  std::vector<FrameBuffer> frames;
  const auto source = open_frame_source(url, {wants_color});
  EXPECT_TRUE(source.is_ok()) << source.status().message();
  FrameBuffer frame;
  while (source && (*source)->next(&frame, std::chrono::milliseconds(1000))) frames.push_back(frame);
  return frames;
}

/// A camera whose frames come when the test says so.
class LiveSource final : public FrameSource {
 public:
  explicit LiveSource(int num_frames) : num_frames_(num_frames) {
    info_.description = "a camera of the test";
    info_.stamp_clock = StampClock::kMonotonic;
  }
  [[nodiscard]] const FrameSourceInfo& info() const override { return info_; }
  [[nodiscard]] FrameSourceHealth health() const override {
    FrameSourceHealth health;
    health.acceleration = Eigen::Vector3d(0.1, -9.8, 0.2);  // level: up is -y of a camera
    health.frames_incomplete = 3;
    return health;
  }
  [[nodiscard]] Status next(FrameBuffer* frame, std::chrono::milliseconds timeout) override {
    if (index_ == num_frames_) {
      if (end_.code() == ErrorCode::kTimeout) std::this_thread::sleep_for(timeout);
      return end_;
    }
    ++index_;
    frame->sequence = static_cast<std::uint64_t>(index_ + (index_ > skip_after_ ? 5 : 0));
    timespec now{};
    ::clock_gettime(CLOCK_MONOTONIC, &now);
    frame->stamp_ns = std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec;
    frame->gray.resize(size_, size_);
    frame->depth.resize(size_, size_);
    for (std::size_t i = 0; i < frame->depth.pixels.size(); ++i)
      frame->depth.pixels[i] = static_cast<std::uint16_t>(i * 7919 + static_cast<std::size_t>(index_));
    return Status::ok();
  }

  FrameSourceInfo info_;
  int num_frames_, index_ = 0, skip_after_ = 1 << 20, size_ = 32;
  Status end_{ErrorCode::kEnd, "over"};
};

inline RecordingFolder make_folder(const std::string& path) {
  auto folder = RecordingFolder::create(path, {}, false);
  EXPECT_TRUE(folder.is_ok()) << folder.status().message();
  return std::move(folder).value();
}

}  // namespace camloc::tools
