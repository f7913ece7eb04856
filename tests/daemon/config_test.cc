// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The table of settings, and every way a configuration can be wrong.
#include "daemon/config.h"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <set>

#include "tests/daemon/test_folder.h"

namespace camloc {
namespace {

using testing::TestFolder;

std::string error_of(const std::string& toml) {
  Config config;
  return parse_config(toml, "test.toml", &config).message();
}

std::string set_error_of(const std::string& argument) {
  Config config;
  return assign_argument(argument, &config).message();
}

TEST(ConfigTest, TableIsSound) {
  std::set<std::string> names;
  for (const Setting& setting : settings()) {
    EXPECT_TRUE(names.insert(setting.name()).second) << setting.name() << " twice";
    EXPECT_EQ(setting.field.index(), setting.default_value.index()) << setting.name();
    EXPECT_GT(std::string(setting.doc).size(), 10U) << setting.name();
    Config config;
    EXPECT_TRUE(assign(setting, setting.default_value, &config)) << setting.name() << ": default is not allowed";
    EXPECT_EQ(value_of(setting, Config()), setting.default_value) << setting.name();
    if (std::holds_alternative<std::int64_t Config::*>(setting.field)) { EXPECT_LT(setting.min, setting.max) << setting.name(); }
  }
}

TEST(ConfigTest, ShippedFileIsTheTable) {
  const std::filesystem::path source = std::filesystem::path(__FILE__).parent_path().parent_path().parent_path();
  std::ifstream file(source / "config" / "camlocd.toml");
  if (!file) GTEST_SKIP() << "the source tree is not here";
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  EXPECT_EQ(text, format_config(Config())) << "write it anew: camlocd --config /dev/null --print-config > config/camlocd.toml";
}

TEST(ConfigTest, NoFileIsWrittenAsDevNull) {
  const auto config = load_config("/dev/null", {});
  ASSERT_TRUE(config.is_ok()) << config.status().message();
  EXPECT_EQ(format_config(*config), format_config(Config()));
}

TEST(ConfigTest, PrintedConfigParsesBack) {
  Config config;
  config.source_url = "replay:///a\"b\\c?speed=1";
  config.source_lossless = true;
  config.localize_features = 333;
  config.publish_frame = "wcs";
  Config again;
  ASSERT_TRUE(parse_config(format_config(config), "printed", &again));
  for (const Setting& setting : settings()) EXPECT_EQ(value_of(setting, again), value_of(setting, config)) << setting.name();
}

TEST(ConfigTest, ErrorsNameFileLineAndReason) {
  EXPECT_EQ(error_of("[localize]\nfeatures = 99"), "test.toml:2: localize.features: 99 is out of range, 100 to 4000");
  EXPECT_EQ(error_of("[source]\n\nstall_ms = 1"), "test.toml:3: source.stall_ms: 1 is out of range, 50 to 60000 ms");
  EXPECT_EQ(error_of("[localize]\ntracking = 1"), "test.toml:2: localize.tracking: wants true or false");
  EXPECT_EQ(error_of("[localize]\nfeatures = \"many\""), "test.toml:2: localize.features: wants a whole number");
  EXPECT_EQ(error_of("[map]\npath = ''"), "test.toml:2: map.path: must not be empty");
  EXPECT_EQ(error_of("[publish]\nframe = 'world'"), "test.toml:2: publish.frame: 'world' is not one of map|wcs");
  EXPECT_EQ(error_of("[map]\npath = \"a\\nb\""), "test.toml:2: map.path: holds a control character");
  EXPECT_EQ(error_of("[log]\n\n\nlevle = 'info'"), "test.toml:4: log.levle: unknown key; [log] has level");
  EXPECT_NE(error_of("[locale]\n").find("test.toml:1: [locale]: unknown section"), std::string::npos);
  EXPECT_NE(error_of("url = 'x'").find("test.toml:1: [url]: unknown section"), std::string::npos);
  EXPECT_NE(error_of("[map]\npath = 1.5").find("test.toml:2: map.path: wrong type"), std::string::npos);
  EXPECT_NE(error_of("[map]\npath = [1]").find("test.toml:2: map.path: wrong type"), std::string::npos);
  EXPECT_EQ(error_of("[map]\npath = 'a'\npath = 'b'").substr(0, 12), "test.toml:3:");
  EXPECT_EQ(error_of("[map\n").substr(0, 10), "test.toml:");
  EXPECT_EQ(error_of(std::string("[control]\nsocket = '/") + std::string(200, 'x') + "'"),
            "test.toml:2: control.socket: longer than 107 bytes");
}

TEST(ConfigTest, WrongTextChangesNothing) {
  Config config;
  EXPECT_FALSE(parse_config("[map]\npath = 'good'\n[log]\nlevel = 'bad'\n", "test.toml", &config));
  EXPECT_EQ(config.map_path, Config().map_path);
}

TEST(ConfigTest, ArgumentsNeedNoQuotes) {
  Config config;
  EXPECT_TRUE(assign_argument("source.url=replay:///x?frames=1:2&a=b", &config));
  EXPECT_EQ(config.source_url, "replay:///x?frames=1:2&a=b");
  EXPECT_TRUE(assign_argument("localize.tracking=false", &config));
  EXPECT_FALSE(config.localize_tracking);
  EXPECT_TRUE(assign_argument("localize.features=200", &config));
  EXPECT_EQ(config.localize_features, 200);
  EXPECT_TRUE(assign_argument("publish.bot_core_channel=", &config));
  EXPECT_EQ(config.publish_bot_core_channel, "");
}

TEST(ConfigTest, WrongArgumentsAreRefused) {
  EXPECT_EQ(set_error_of("x"), "'x' is not section.key=value");
  EXPECT_EQ(set_error_of("a=b.c"), "'a=b.c' is not section.key=value");
  EXPECT_EQ(set_error_of("map.pth=1"), "map.pth: unknown key; camlocd --print-config lists them");
  EXPECT_EQ(set_error_of("localize.features=12x"), "localize.features: '12x' is not a whole number");
  EXPECT_EQ(set_error_of("localize.features=99999999999999999999"), "localize.features: '99999999999999999999' is not a whole number");
  EXPECT_EQ(set_error_of("localize.features=9"), "localize.features: 9 is out of range, 100 to 4000");
  EXPECT_EQ(set_error_of("localize.depth=yes"), "localize.depth: 'yes' is not true or false");
}

TEST(ConfigTest, DropInsComeAfterTheFileAndArgumentsLast) {
  const TestFolder folder;
  const std::string path = folder.write("c.toml", "[map]\npath = 'a'\n[localize]\nfeatures = 200\nmax_coast_ms = 1\n");
  folder.write("c.toml.d/20-b.toml", "[localize]\nfeatures = 400\n");
  folder.write("c.toml.d/10-a.toml", "[map]\npath = 'b'\n[localize]\nfeatures = 300\n");
  folder.write("c.toml.d/ignored.txt", "nonsense");
  const Result<Config> config = load_config(path, {"localize.max_coast_ms=7"});
  ASSERT_TRUE(config) << config.status().message();
  EXPECT_EQ(config.value().map_path, folder.file("b")) << "meant from the folder of the configuration, in a drop-in, too";
  EXPECT_EQ(config.value().localize_features, 400);
  EXPECT_EQ(config.value().localize_max_coast_ms, 7);
}

TEST(ConfigTest, RelativePathsAreMeantFromTheFolderOfTheFile) {
  const TestFolder folder;
  const std::string path = folder.write("site/c.toml",
                                        "[source]\nurl = 'walk?speed=1'\ncamera = 'camera.toml'\n[map]\npath = '/maps/a.cmap'\n"
                                        "[control]\nsocket = ''\n");
  const Result<Config> config = load_config(path, {});
  ASSERT_TRUE(config) << config.status().message();
  EXPECT_EQ(config->source_url, folder.file("site/walk?speed=1"));
  EXPECT_EQ(config->source_camera, folder.file("site/camera.toml"));
  EXPECT_EQ(config->map_path, "/maps/a.cmap");
  EXPECT_EQ(config->control_socket, "") << "empty is off";
  const Result<Config> argued = load_config(path, {"source.camera=other.toml"});
  EXPECT_EQ(argued->source_camera, "other.toml") << "an argument is meant from where the daemon is started";
}

TEST(ConfigTest, MissingFileFolderAndHugeFileAreErrors) {
  const TestFolder folder;
  EXPECT_EQ(load_config(folder.file("none.toml"), {}).status().code(), ErrorCode::kNotFound);
  EXPECT_EQ(load_config(folder.file(""), {}).status().code(), ErrorCode::kIo);
  const std::string huge = folder.write("huge.toml", std::string(2 << 20, '\n'));
  EXPECT_EQ(load_config(huge, {}).status().code(), ErrorCode::kInvalid);
  const std::string path = folder.write("c.toml", "");
  folder.write("c.toml.d/x.toml", "[x]");
  EXPECT_NE(load_config(path, {}).status().message().find("x.toml:1:"), std::string::npos);
}

}  // namespace
}  // namespace camloc
