// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A recording through the localizer: opened together, checked against each other, perturbed on the way.
#include "tools/evaluation/sequence_run.h"

#include <gtest/gtest.h>

#include "tests/base/recording_observer.h"
#include "tests/mapping/sample_recording.h"

namespace camloc::tools {
namespace {

SequenceRunOptions options_for(const mapping::SampleRecording& recording) {
  SequenceRunOptions options;
  options.map_path = testing::SampleWorld::get().map().info().path;
  options.sequence_url = recording.folder.path();
  options.camera_path = recording.camera_path;
  return options;
}

TEST(SequenceRunTest, EveryFrameIsLocalized) {
  const mapping::SampleRecording recording(8);
  SequenceRunOptions options = options_for(recording);
  options.is_single = true;
  options.exclude = "3:4";
  auto run = open_sequence_run(options);
  ASSERT_TRUE(run.is_ok()) << run.status().message();
  int num_localized = 0;
  const auto counts = read_perturbed_frames(*run, [&](const Frame& frame) {
    EXPECT_NE(frame.sequence, 3U);
    num_localized += run->localizer->process(frame).state == State::kLocalized;
  });
  ASSERT_TRUE(counts.is_ok());
  EXPECT_EQ(counts->num_frames, 7U);
  EXPECT_GE(num_localized, 5);
}

TEST(SequenceRunTest, PerturbationsChangeTheImageAndAnObserverEndsIt) {
  const mapping::SampleRecording recording(4);
  SequenceRunOptions options = options_for(recording);
  options.perturbations = {"exposure=0"};
  auto run = open_sequence_run(options);
  ASSERT_TRUE(run.is_ok());
  testing::RecordingObserver two(2);
  int num_frames = 0;
  const auto counts = read_perturbed_frames(
      *run,
      [&](const Frame& frame) {
        two.show("frame", static_cast<std::uint64_t>(++num_frames), 4, "");
        EXPECT_EQ(frame.gray.at(100, 100), 0);
      },
      two);
  ASSERT_TRUE(counts.is_ok());
  EXPECT_EQ(num_frames, 2);
}

TEST(SequenceRunTest, WhatDoesNotFitIsRefused) {
  const mapping::SampleRecording recording(2);
  const struct {
    void (*spoil)(SequenceRunOptions*);
    const char* part;
  } cases[] = {{[](SequenceRunOptions* o) { o->map_path = "/nowhere.cmap"; }, "/nowhere.cmap"},
               {[](SequenceRunOptions* o) { o->camera_path = "/nowhere.toml"; }, "/nowhere.toml"},
               {[](SequenceRunOptions* o) { o->sequence_url = "/nowhere"; }, "/nowhere"},
               {[](SequenceRunOptions* o) { o->frames = "x"; }, "--frames"},
               {[](SequenceRunOptions* o) { o->exclude = "1:2&loop=1"; }, "--exclude"},
               {[](SequenceRunOptions* o) { o->perturbations = {"rain=1"}; }, "rain"}};
  for (const auto& c : cases) {
    SequenceRunOptions options = options_for(recording);
    c.spoil(&options);
    const auto run = open_sequence_run(options);
    ASSERT_FALSE(run.is_ok()) << c.part;
    EXPECT_NE(run.status().message().find(c.part), std::string::npos) << run.status().message();
  }
}

TEST(SequenceRunTest, ACameraOfAnotherSizeIsNamed) {
  const mapping::SampleRecording recording(2);
  RgbdCamera camera = testing::SampleWorld::get().camera();
  camera.color.width = camera.depth.width = 64;
  camera.color.cx = camera.depth.cx = 31.5;
  SequenceRunOptions options = options_for(recording);
  options.camera_path = recording.folder.write("small.toml", format_camera_toml(camera));
  const auto run = open_sequence_run(options);
  ASSERT_FALSE(run.is_ok());
  EXPECT_NE(run.status().message().find("is for 64x"), std::string::npos) << run.status().message();
}

}  // namespace
}  // namespace camloc::tools
