// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "core/io/sequence.h"
#include "core/map/map_view.h"
#include "tests/map/room_map.h"
#include "tests/tools/command_runner.h"
#include "tools/camloc-map/commands.h"
#include "tools/mapping/colmap/colmap_model.h"

namespace camloc::mapping {
namespace {

using testing::make_room_map;

class ExportCommand : public ::testing::Test {
 protected:
  MapView open(const MapData& data) {
    EXPECT_TRUE(write_map(data, folder_.file("m.cmap")).is_ok());
    return MapView::open(folder_.file("m.cmap")).value();
  }
  testing::TemporaryFolder folder_;
};

TEST_F(ExportCommand, WritesItsFilesOrSaysWhyNot) {
  open(make_room_map());
  const std::string map = folder_.file("m.cmap"), ply = folder_.file("m.ply"), tum = folder_.file("m.tum"), model = folder_.file("model"),
                    nowhere = folder_.file("no/x.ply");
  const auto run = [](const std::vector<std::string>& arguments) { return tools::run_command(add_export_command, arguments); };
  const tools::CommandOutput output = run({"export", map, "--ply", ply, "--tum", tum, "--colmap", model});
  EXPECT_EQ(output.exit_code, 0) << output.err;
  EXPECT_NE(output.out.find(ply + ": 360 landmarks"), std::string::npos) << output.out;
  EXPECT_TRUE(read_tum_trajectory(tum).is_ok());
  EXPECT_TRUE(read_colmap_model(model).is_ok());
  EXPECT_EQ(run({"export", map}).exit_code, 2);
  EXPECT_EQ(run({"export", map, "--ply", nowhere}).exit_code, 2);
  EXPECT_EQ(run({"export", map, "--ply", ply, "--wcs"}).exit_code, 2);
  EXPECT_EQ(run({"export", nowhere, "--ply", ply}).exit_code, 1);
}

}  // namespace
}  // namespace camloc::mapping
