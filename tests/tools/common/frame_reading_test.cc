// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/common/frame_reading.h"

#include <gtest/gtest.h>

#include <chrono>
#include <utility>
#include <vector>

namespace camloc::tools {
namespace {

/// Says what it was told to say, then that it is over.
class ScriptedSource final : public FrameSource {
 public:
  explicit ScriptedSource(std::vector<Status> script) : script_(std::move(script)) {}
  const FrameSourceInfo& info() const override { return info_; }
  Status next(FrameBuffer* frame, std::chrono::milliseconds) override {
    if (place_ == script_.size()) return {ErrorCode::kEnd, "over"};
    frame->sequence = place_;
    return script_[place_++];
  }

 private:
  FrameSourceInfo info_;
  std::vector<Status> script_;
  std::size_t place_ = 0;
};

Status broken(const std::string& what) { return {ErrorCode::kCorrupt, what}; }

/// Stops the reading after so many frames.
struct Stopper final : WorkObserver {
  Stopper(const std::vector<std::uint64_t>* seen, std::size_t max) : frames(seen), max_frames(max) {}
  bool should_stop() const override { return frames->size() >= max_frames; }
  const std::vector<std::uint64_t>* frames;
  std::size_t max_frames;
};

struct Read {
  Result<FrameCounts> counts;
  std::vector<std::uint64_t> frames;
};

Read read(std::vector<Status> script, std::size_t max_frames = 100) {
  ScriptedSource source(std::move(script));
  std::vector<std::uint64_t> frames;
  auto counts = read_frames(
      source,
      [&](FrameBuffer& frame) {
        frames.push_back(frame.sequence);
        return Status::ok();
      },
      Stopper(&frames, max_frames));
  return {std::move(counts), frames};
}

TEST(FrameReading, BrokenFramesAreCountedAndLeftOut) {
  const Read seen = read({Status::ok(), broken("first"), {ErrorCode::kTimeout, "wait"}, broken("second"), Status::ok()});
  ASSERT_TRUE(seen.counts.is_ok());
  EXPECT_EQ(seen.frames, (std::vector<std::uint64_t>{0, 4}));
  EXPECT_EQ(seen.counts->num_frames, 4U);
  EXPECT_EQ(seen.counts->num_corrupt, 2U);
  EXPECT_EQ(seen.counts->first_corrupt, "first");
  EXPECT_FALSE(seen.counts->are_all_corrupt());
}

TEST(FrameReading, NothingButBrokenFramesIsTold) {
  const Read seen = read({broken("rgb/0.png: cut off"), broken("b")});
  ASSERT_TRUE(seen.counts.is_ok());
  EXPECT_TRUE(seen.counts->are_all_corrupt());
  EXPECT_NE(all_frames_corrupt(*seen.counts).message().find("none of 2 frames could be read, the first because of rgb/0.png: cut off"),
            std::string::npos);
  EXPECT_FALSE(read({}).counts->are_all_corrupt());
}

TEST(FrameReading, SourceThatFailsEndsIt) {
  const Read seen = read({Status::ok(), {ErrorCode::kUnavailable, "gone"}, Status::ok()});
  EXPECT_EQ(seen.counts.status().code(), ErrorCode::kUnavailable);
  EXPECT_EQ(seen.frames.size(), 1U);
}

TEST(FrameReading, StopsWhenAsked) {
  const Read seen = read(std::vector<Status>(10, Status::ok()), 3);
  ASSERT_TRUE(seen.counts.is_ok());
  EXPECT_EQ(seen.counts->num_frames, 3U);
}

TEST(FrameReading, VisitorsErrorIsTheResult) {
  ScriptedSource source(std::vector<Status>(10, Status::ok()));
  int num_calls = 0;
  const auto counts =
      read_frames(source, [&](FrameBuffer&) { return ++num_calls < 2 ? Status::ok() : Status(ErrorCode::kInvalid, "wrong size"); });
  EXPECT_EQ(counts.status().code(), ErrorCode::kInvalid);
  EXPECT_EQ(num_calls, 2);
}

TEST(FrameReading, SelectionsAreSlicesOfTheUrl) {
  EXPECT_EQ(selection_of({}), "");
  EXPECT_EQ(selection_of({3, 7}), "3:4,7:8");
  EXPECT_EQ(selection_of({3, 20}, 10), "0:4,10:21");
  EXPECT_EQ(with_selection("replay://walk", ""), "replay://walk");
  EXPECT_EQ(with_selection("replay://walk", "0:3"), "replay://walk?frames=0:3");
  EXPECT_EQ(with_selection("replay://walk?speed=1", "0:3", "1:2"), "replay://walk?speed=1&frames=0:3&exclude=1:2");
}

}  // namespace
}  // namespace camloc::tools
