// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// `camloc camera list`, `show` and `import`.
#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/io/camera_file.h"
#include "drivers/sources.h"
#include "tests/tools/command_runner.h"
#include "tools/camloc/commands.h"

namespace camloc::tools {
namespace {

constexpr const char* kKalibr =
    "cam0:\n  camera_model: pinhole\n  intrinsics: [458.654, 457.296, 367.215, 248.375]\n  distortion_model: equidistant\n"
    "  distortion_coeffs: [-0.01, 0.02, -0.003, 0.001]\n  resolution: [752, 480]\n";

CommandOutput camera(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "camera");
  return run_command(add_camera_command, arguments);
}

TEST(CameraCommandTest, ImportsWhatOthersWrite) {
  const TemporaryFolder folder;
  const std::string yaml = folder.write("camchain.yaml", kKalibr);
  const CommandOutput output = camera({"import", yaml, "--out", folder / "camera.toml", "--name", "left", "--depth-unit", "0.0002"});
  ASSERT_EQ(output.exit_code, 0) << output.err;
  const auto read = read_camera_file(folder / "camera.toml");
  ASSERT_TRUE(read.is_ok()) << read.status().message();
  EXPECT_EQ(read->name, "left");
  EXPECT_EQ(read->color.fx, 458.654);
  EXPECT_EQ(read->color.lens, LensModel::kEquidistant);
  EXPECT_EQ(read->depth_unit_m, 0.0002);
  EXPECT_EQ(camera({"import", folder / "none.yaml", "--out", folder / "x.toml"}).exit_code, 1);
  EXPECT_EQ(camera({"import", yaml, "--out", folder / "no/such/x.toml"}).exit_code, 2);
  EXPECT_EQ(camera({"import", yaml}).exit_code, 2);
}

TEST(CameraCommandTest, ShowsFieldOfViewAndDepth) {
  const TemporaryFolder folder;
  const std::string path = folder.write(
      "c.toml",
      "name = \"c\"\n[color]\nwidth = 640\nheight = 480\nfx = 320.0\nfy = 320.0\ncx = 319.5\ncy = 239.5\nlens = \"pinhole\"\n"
      "[depth]\nregistered = false\nwidth = 320\nheight = 240\nfx = 285.0\nfy = 285.0\ncx = 160.0\ncy = 120.0\nlens = \"pinhole\"\n"
      "[extrinsics]\ntranslation_m = [-0.025, 0.0, 0.0]\nrotation_wxyz = [1.0, 0.0, 0.0, 0.0]\n");
  const CommandOutput output = camera({"show", path});
  ASSERT_EQ(output.exit_code, 0) << output.err;
  EXPECT_NE(output.out.find("field of view 90.0 x 73.7 deg"), std::string::npos) << output.out;
  EXPECT_NE(output.out.find("at -25.0 0.0 0.0 mm"), std::string::npos) << output.out;
  EXPECT_NE(output.out.find("noise 7.0 mm at 1 m, 25.0 mm at 2 m"), std::string::npos) << output.out;
}

TEST(CameraCommandTest, ListsEveryKindOfCamera) {
  const CommandOutput output = camera({"list", "--json"});
  const auto document = nlohmann::json::parse(output.out);
  EXPECT_TRUE(document["cameras"].is_array());
  for (const SourceEntry& source : frame_sources())
    EXPECT_EQ(document.contains(std::string(source.scheme) + "_problem"), source.list != nullptr) << source.scheme;
  EXPECT_EQ(output.exit_code, document["cameras"].empty() ? 1 : 0) << "no camera is a failure";
}

}  // namespace
}  // namespace camloc::tools
