// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "core/io/image_file.h"
#include "core/map/map_view.h"
#include "tests/map/room_map.h"
#include "tests/tools/command_runner.h"
#include "tools/camloc-map/commands.h"

namespace camloc::mapping {
namespace {

using testing::make_room_map;

class ViewCommand : public ::testing::Test {
 protected:
  MapView open(const MapData& data) {
    EXPECT_TRUE(write_map(data, folder_.file("m.cmap")).is_ok());
    return MapView::open(folder_.file("m.cmap")).value();
  }
  testing::TemporaryFolder folder_;
};

TEST_F(ViewCommand, WritesAPictureOrSaysWhyNot) {
  open(make_room_map());
  const std::string map = folder_.file("m.cmap"), png = folder_.file("m.png"), tum = folder_.file("m.tum"),
                    nowhere = folder_.file("no/x.png");
  const auto run = [](const std::vector<std::string>& arguments) { return tools::run_command(add_view_command, arguments).exit_code; };
  testing::write_bytes(tum, std::as_bytes(std::span(std::string_view("1 0 0 1 0 0 0 1\n2 0.1 0 1 0 0 0 1\n"))));
  EXPECT_EQ(run({"view", map, "--png", png, "--trajectory", tum, "--width", "700"}), 0);
  ImageReader reader;
  const auto size = reader.read_size(png);
  ASSERT_TRUE(size.is_ok());
  EXPECT_EQ(size->width, 700);
  EXPECT_EQ(run({"view", map, "--png", nowhere}), 2);
  EXPECT_EQ(run({"view", map, "--png", png, "--width", "30"}), 2);
  EXPECT_EQ(run({"view", nowhere, "--png", png}), 1);
  EXPECT_EQ(run({"view", map, "--png", png, "--trajectory", nowhere}), 1);
}

}  // namespace
}  // namespace camloc::mapping
