// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The table of sinks, and that a sink is added by its own code and one line.
#include "daemon/sinks/sinks.h"

#include <gtest/gtest.h>

#include <vector>

#include "daemon/service.h"
#include "daemon/service_setup.h"
#include "drivers/sources.h"
#include "tests/daemon/sample_map.h"
#include "tests/daemon/test_folder.h"

namespace camloc {
namespace {

TEST(Sinks, SchemeChooses) {
  for (const SinkEntry& sink : pose_sinks()) {
    EXPECT_EQ(*find_sink(std::string(sink.scheme) + "://x"), &sink);
    EXPECT_TRUE(std::string(sink.help).starts_with(std::string(sink.scheme) + "://")) << sink.scheme;
  }
  const Status status = find_sink("carrier-pigeon://loft").status();
  EXPECT_EQ(status.code(), ErrorCode::kInvalid);
  EXPECT_NE(status.message().find("udpm://239.255.76.67:7667?ttl=0"), std::string::npos) << status.message();
  EXPECT_FALSE(find_sink("udpm"));
  EXPECT_FALSE(find_sink("://"));
}

// ---- A sink of this test's own: this much code, and one line in a table.

// What it was told.
std::vector<PoseReport> reports;
std::vector<DaemonStatus> states;

class DiarySink final : public PoseSink {
 public:
  [[nodiscard]] Status connect() override {
    if (num_attempts_++ == 0) return {ErrorCode::kUnavailable, "the ink is still wet"};
    return Status::ok();
  }
  [[nodiscard]] bool is_connected() const override { return num_attempts_ > 1; }
  bool publish(const PoseReport& report) override {
    if (is_connected()) reports.push_back(report);
    return is_connected();
  }
  bool publish(const DaemonStatus& status) override {
    states.push_back(status);
    return true;
  }

 private:
  int num_attempts_ = 0;
};

Result<std::unique_ptr<PoseSink>> open_diary(const SinkOptions& options) {
  if (options.url == "diary://locked") return Status(ErrorCode::kInvalid, "the diary is locked");
  return std::unique_ptr<PoseSink>(std::make_unique<DiarySink>());
}

TEST(SinksSeam, ASinkIsOneFileAndOneLine) {
  std::vector<SinkEntry> table(pose_sinks().begin(), pose_sinks().end());
  table.push_back({"diary", open_diary, "diary://  what happened"});
  const testing::TestFolder folder;
  testing::SampleMapOptions map;
  map.num_frames = 240;
  ServiceInputs inputs;
  inputs.config.control_socket = "";
  inputs.config.log_level = "error";
  inputs.config.map_path = folder.file("map.cmap");
  ASSERT_TRUE(testing::write_sample_map(map, inputs.config.map_path));
  inputs.config.source_url = testing::sample_url(map, "rate_hz=60&frames=60");
  inputs.config.source_lossless = inputs.config.source_exit_at_end = true;
  inputs.config.publish_lcm_url = "diary://";
  inputs.open_source = [](const std::string& url) { return open_frame_source(url); };
  inputs.sinks = table;

  EXPECT_FALSE(check_settings(inputs.config)) << "the build's own table is what it was";
  EXPECT_TRUE(check_settings(inputs.config, frame_sources(), table));
  Service service(inputs);
  ASSERT_TRUE(service.start());
  EXPECT_EQ(service.run(), 0);
  EXPECT_TRUE(service.stop());
  EXPECT_EQ(static_cast<std::int64_t>(reports.size()), service.status().poses_published);
  ASSERT_FALSE(reports.empty()) << "connected at the first tick";
  EXPECT_EQ(reports.back().localization.sequence, 59U);
  EXPECT_TRUE(reports.back().localization.has_pose);
  ASSERT_FALSE(states.empty());
  EXPECT_EQ(states.back().state_text, "recording over");

  inputs.config.publish_lcm_url = "diary://locked";
  Service locked(inputs);
  EXPECT_EQ(locked.start().message(), "publish.lcm_url: the diary is locked");
}

}  // namespace
}  // namespace camloc
