// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The service in this process, step by step: capture thread, localizer, publisher and control socket together.
#include "daemon/service.h"

#include <gtest/gtest.h>
#include <net/if.h>
#include <net/route.h>
#include <netinet/in.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

#include <cstring>
#include <deque>
#include <thread>

#include "drivers/sample_source.h"
#include "drivers/sources.h"
#include "tests/daemon/process_allocations.h"
#include "tests/daemon/sample_map.h"
#include "tests/daemon/test_folder.h"

namespace camloc {
namespace {

using testing::SampleMapOptions;
using testing::TestFolder;

/// Multicast on a loop-back of our own, so that messages are really sent and reach nobody. False where not permitted.
bool enter_private_network() {
  if (::unshare(CLONE_NEWNET) != 0) return false;
  const UniqueFd control(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  ifreq interface {};
  std::strcpy(interface.ifr_name, "lo");
  interface.ifr_flags = IFF_UP | IFF_RUNNING;
  if (::ioctl(control.get(), SIOCSIFFLAGS, &interface) != 0) return false;
  const auto address = [](std::uint32_t value) {
    sockaddr_in ipv4{};
    ipv4.sin_family = AF_INET;
    ipv4.sin_addr.s_addr = htonl(value);
    sockaddr generic{};
    std::memcpy(&generic, &ipv4, sizeof(generic));
    return generic;
  };
  rtentry route{};
  route.rt_dst = address(0xe0000000);
  route.rt_genmask = address(0xf0000000);
  route.rt_flags = RTF_UP;
  char device[] = "lo";
  route.rt_dev = device;
  return ::ioctl(control.get(), SIOCADDRT, &route) == 0;
}

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

TEST_F(ServiceTest, FramesAllocateNothing) {
  if (!testing::can_count_process_allocations()) GTEST_SKIP() << "a sanitizer owns the allocator";
  make_map();
  inputs_.config.publish_lcm_url = "udpm://239.255.76.67:7667?ttl=0";
  std::uint64_t allocations = 0;
  std::int64_t localized = 0;
  bool has_network = false;
  // The namespace is the thread's own; the other tests keep theirs.
  std::thread([&] {
    has_network = enter_private_network();
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
