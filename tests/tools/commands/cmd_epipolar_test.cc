// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// `camloc epipolar` as a command: what it says of trajectories that do not belong to the recording.
#include "tests/tools/command_runner.h"
#include "tools/camloc/commands.h"

namespace camloc::tools {
namespace {

constexpr const char* kCamera = R"(
[color]
width = 640
height = 480
fx = 525.0
fy = 525.0
cx = 319.5
cy = 239.5
lens = "pinhole"
[depth]
registered = true
unit_m = 0.001
)";

TEST(EpipolarCommandTest, NeedsACameraAndARecording) {
  EXPECT_EQ(run_command(add_epipolar_command, {"epipolar", "--estimate", "e"}).exit_code, 2);
  const TemporaryFolder folder;
  const CommandOutput output = run_command(add_epipolar_command, {"epipolar", "--estimate", folder.write("e.tum", "1 0 0 0 0 0 0 1\n"),
                                                                  "--sequence", folder / "missing", "--camera", folder / "missing.toml"});
  EXPECT_EQ(output.exit_code, 1);
  EXPECT_NE(output.err.find("missing.toml"), std::string::npos) << output.err;
}

TEST(EpipolarCommandTest, AnotherRecordingIsAnError) {
  const TemporaryFolder folder;
  for (const char* image : {"rgb.png", "depth.png"}) (void)folder.write(image, "");
  (void)folder.write("rgb.txt", "5.0 rgb.png\n");
  (void)folder.write("depth.txt", "5.0 depth.png\n");
  const CommandOutput output =
      run_command(add_epipolar_command, {"epipolar", "--estimate", folder.write("e.tum", "1 0 0 0 0 0 0 1\n2 0 0 0 0 0 0 1\n"),
                                         "--sequence", folder.path(), "--camera", folder.write("camera.toml", kCamera)});
  EXPECT_EQ(output.exit_code, 2);
  EXPECT_NE(output.err.find("is it the recording"), std::string::npos) << output.err;
}

// Before a single image is read: there is none here.
TEST(EpipolarCommandTest, OnePoseHasNoPartner) {
  const TemporaryFolder folder;
  const CommandOutput output =
      run_command(add_epipolar_command, {"epipolar", "--estimate", folder.write("e.tum", "1 0 0 0 0 0 0 1\n"), "--sequence",
                                         folder / "missing", "--camera", folder.write("camera.toml", kCamera)});
  EXPECT_EQ(output.exit_code, 1);
  EXPECT_NE(output.err.find("no two images of these poses see the same things"), std::string::npos) << output.err;
}

}  // namespace
}  // namespace camloc::tools
