// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The service in this process, step by step: capture thread, localizer, publisher and control socket together.
#include "daemon/service.h"

#include <gtest/gtest.h>

#include <deque>
#include <thread>

#include "drivers/sample_source.h"
#include "drivers/sources.h"
#include "tests/coarse/sample_model.h"
#include "tests/daemon/private_network.h"
#include "tests/daemon/process_allocations.h"
#include "tests/daemon/sample_map.h"
#include "tests/daemon/test_folder.h"

namespace camloc {
namespace {

using testing::SampleMapOptions;
using testing::TestFolder;

/// Frames of another size than they were announced with.
class LyingSource : public FrameSource {
 public:
  LyingSource() { info_.camera = sample_camera(320, 240); }
  [[nodiscard]] const FrameSourceInfo& info() const override { return info_; }
  [[nodiscard]] Status next(FrameBuffer* frame, std::chrono::milliseconds) override {
    frame->gray.resize(64, 48);
    return Status::ok();
  }

 private:
  FrameSourceInfo info_;
};

class ServiceTest : public ::testing::Test {
 protected:
  ServiceTest() {
    inputs_.config.control_socket = folder_.file("control.sock");
    inputs_.config.map_path = folder_.file("map.cmap");
    inputs_.config.publish_lcm_url = "file://" + folder_.file("lcm.log") + "?mode=w";
    inputs_.config.source_url = testing::sample_url(SampleMapOptions{}, "rate_hz=0");
    inputs_.config.source_lossless = true;
    inputs_.config.log_level = "error";
    inputs_.open_source = [](const std::string& url) { return open_frame_source(url); };
    inputs_.reload_config = [this] { return Result<Config>(inputs_.config); };
  }
  static void step_until_processed(Service& service, std::int64_t num_frames) {
    for (int i = 0; i < 100000 && service.status().frames_localized < num_frames && !service.exit_code(); ++i) service.step(100);
  }
  void make_map() {
    SampleMapOptions options;
    options.num_frames = 240;
    ASSERT_TRUE(testing::write_sample_map(options, inputs_.config.map_path));
  }

  TestFolder folder_;
  ServiceInputs inputs_;
};

TEST_F(ServiceTest, LocalizesWhatTheSourceShows) {
  make_map();
  inputs_.config.source_url = testing::sample_url(SampleMapOptions{}, "rate_hz=0&frames=20");
  inputs_.config.source_exit_at_end = true;
  Service service(inputs_);
  ASSERT_TRUE(service.start());
  EXPECT_EQ(service.run(), 0);
  EXPECT_TRUE(service.stop());
  EXPECT_GE(service.status().frames_localized, 18);
  EXPECT_EQ(service.status().state_text, "recording over");
}

TEST_F(ServiceTest, SecondServiceIsRefused) {
  Service first(inputs_);
  ASSERT_TRUE(first.start());
  Service second(inputs_);
  EXPECT_EQ(second.start().code(), ErrorCode::kUnavailable);
  EXPECT_TRUE(first.stop());
}

TEST_F(ServiceTest, MissingCalibrationEndsItAsAConfigurationError) {
  inputs_.open_source = [](const std::string&) -> Result<std::unique_ptr<FrameSource>> {
    struct Bare : LyingSource {
      [[nodiscard]] const FrameSourceInfo& info() const override { return bare_; }
      FrameSourceInfo bare_;
    };
    return std::unique_ptr<FrameSource>(std::make_unique<Bare>());
  };
  Service service(inputs_);
  ASSERT_TRUE(service.start());
  EXPECT_EQ(service.run(), 2);
  EXPECT_TRUE(service.stop());
}

TEST_F(ServiceTest, FirstFrameOfAnotherSizeEndsItAsAConfigurationError) {
  inputs_.open_source = [](const std::string&) -> Result<std::unique_ptr<FrameSource>> {
    return std::unique_ptr<FrameSource>(std::make_unique<LyingSource>());
  };
  Service service(inputs_);
  ASSERT_TRUE(service.start());
  EXPECT_EQ(service.run(), 2);
  EXPECT_TRUE(service.stop());
}

// A coarse model of another map is said once, and the poses come all the same.
TEST_F(ServiceTest, ACoarseModelOfAnotherMapIsDoneWithout) {
  make_map();
  inputs_.config.coarse_cnn = folder_.file("coarse.onnx");
  ASSERT_TRUE(write_onnx(inputs_.config.coarse_cnn, sample_onnx()));
  Service service(inputs_);
  ASSERT_TRUE(service.start());
  step_until_processed(service, 20);
  EXPECT_GE(service.status().frames_localized, 20);
  for (int i = 0; i < 100 && std::string_view(service.status().coarse_state) != "failed"; ++i) service.step(50);
  EXPECT_STREQ(service.status().coarse_state, "failed");
  EXPECT_EQ(service.status().coarse_answers, 0);
  EXPECT_EQ(service.status().fixes_by_retrieval, 1);
  EXPECT_TRUE(service.stop());
}

TEST_F(ServiceTest, FramesAllocateNothing) {
  if (!testing::can_count_process_allocations()) GTEST_SKIP() << "a sanitizer owns the allocator";
  make_map();
  inputs_.config.publish_lcm_url = "udpm://239.255.76.67:7667?ttl=0";
  std::uint64_t allocations = 0;
  std::int64_t localized = 0;
  bool has_network = false;
  // The namespace is the thread's own; the other tests keep theirs.
  std::thread([&] {
    has_network = testing::enter_private_network();
    if (!has_network) return;
    Service service(inputs_);
    if (!service.start()) return;
    step_until_processed(service, 50);
    const std::uint64_t before = testing::num_process_allocations();
    step_until_processed(service, 150);
    allocations = testing::num_process_allocations() - before;
    localized = service.status().frames_localized;
    EXPECT_GE(service.status().poses_published, 150) << "published for real";
    EXPECT_TRUE(service.stop());
  }).join();
  if (!has_network) GTEST_SKIP() << "needs a network namespace of its own";
  EXPECT_GE(localized, 150);
  EXPECT_EQ(allocations, 0U);
}

}  // namespace
}  // namespace camloc
