// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/source_url.h"

#include <gtest/gtest.h>

#include "tests/drivers/test_folder.h"

namespace camloc {
namespace {

SourceUrl parse(const std::string& text) {
  auto url = parse_source_url(text);
  EXPECT_TRUE(url.is_ok()) << url.status().message();
  return url ? *url : SourceUrl{};
}

TEST(SourceUrl, PartsOfAUrl) {
  const SourceUrl url = parse("Replay:///data/kitchen?speed=1&frames=0:300:2,-1");
  EXPECT_EQ(url.scheme, "replay");
  EXPECT_EQ(url.path, "/data/kitchen");
  EXPECT_EQ(url.text_option("frames", ""), "0:300:2,-1");
  EXPECT_EQ(url.text_option("exclude", "none"), "none");
}

TEST(SourceUrl, RelativeAndEscapedPaths) {
  EXPECT_EQ(parse("replay://data/x").path, "data/x");
  EXPECT_EQ(parse("replay://my%20data/a b?loop=1").path, "my data/a b");
  EXPECT_EQ(parse("replay://100%/%zz/%4").path, "100%/%zz/%4");
  EXPECT_EQ(parse("replay://what%3f").path, "what?");
  EXPECT_EQ(parse("replay://x%00y").path, "x%00y") << "a zero byte would cut the path";
}

TEST(SourceUrl, PlainPathsAreNoUrls) {
  const TestFolder folder;
  for (const char* name : {"walk%203", "what?", "a?frames=1", "50%", "caf\xC3\xA9 #2", "x%41"}) {
    folder.write(std::string(name) + "/file", "x");
    const std::string path = folder / name;
    EXPECT_EQ(parse(path).path, path) << "a bare path is taken to the letter";
    EXPECT_EQ(parse(replay_url(path)).path, path);
    const SourceUrl url = parse(as_source_url(path) + "?speed=2");
    EXPECT_EQ(url.path, path);
    EXPECT_EQ(url.text_option("speed", ""), "2");
  }
  EXPECT_EQ(as_source_url("replay://a%20b"), "replay://a%20b");
  EXPECT_EQ(parse(as_source_url("no%20such?speed=2")).path, "no%20such");
}

TEST(SourceUrl, RelativePathsGetAFolder) {
  EXPECT_EQ(parse(source_url_from("/etc/50% off", "walk?loop=1")).path, "/etc/50% off/walk");
  EXPECT_EQ(parse(source_url_from("/etc/50% off", "replay://my%20walk?loop=1")).path, "/etc/50% off/my walk");
  EXPECT_EQ(source_url_from("/etc", "oni://a.oni"), "oni:///etc/a.oni");
  for (const char* text : {"", "/walk", "replay:///walk", "sample://", "v4l2://dev", "kinect://"})
    EXPECT_EQ(source_url_from("/etc", text), text);
  EXPECT_EQ(source_url_from("", "walk"), "walk");
}

TEST(SourceUrl, BarePathMeansReplay) {
  const SourceUrl url = parse("../data/100%20?speed=2");
  EXPECT_EQ(url.scheme, "replay");
  EXPECT_EQ(url.path, "../data/100%20");
  EXPECT_EQ(url.text_option("speed", ""), "2");
  EXPECT_EQ(parse("sample://").path, "");
  EXPECT_EQ(parse("./odd dir/a://b").scheme, "replay");
}

TEST(SourceUrl, BadOptions) {
  EXPECT_NE(parse_source_url("sample://?frames").status().message().find("'frames'"), std::string::npos);
  EXPECT_FALSE(parse_source_url("sample://?=3").is_ok());
  EXPECT_FALSE(parse_source_url("sample://?a=1&a=2").is_ok());
}

TEST(SourceUrl, NumbersHaveARange) {
  const SourceUrl url = parse("sample://?a=2.5&b=x&c=11&d=nan&e=");
  EXPECT_EQ(*url.number_option("a", 1, 0, 10), 2.5);
  EXPECT_EQ(*url.number_option("none", 1, 0, 10), 1.0);
  for (const char* key : {"b", "c", "d", "e"}) {
    const auto value = url.number_option(key, 1, 0, 10);
    ASSERT_FALSE(value.is_ok()) << key;
    EXPECT_NE(value.status().message().find("from 0 to 10"), std::string::npos);
  }
}

TEST(SourceUrl, UnknownOptionsListTheKnown) {
  const Status status = parse("sample://?sped=1").check_options({"speed", "loop"});
  ASSERT_FALSE(status.is_ok());
  EXPECT_NE(status.message().find("'sped'"), std::string::npos);
  EXPECT_NE(status.message().find("speed, loop"), std::string::npos);
  EXPECT_TRUE(parse("sample://?speed=1").check_options({"speed", "loop"}).is_ok());
}

}  // namespace
}  // namespace camloc
