// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The table of sources, what must agree with it (udev rules, the service's groups, docs/cameras.md), and that a source is added by
// its own code and one line.
#include "drivers/sources.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <sstream>

#include "drivers/sample_source.h"
#include "tests/drivers/fake_usb.h"

namespace camloc {
namespace {

std::string project_text(const std::string& path) {
  const std::filesystem::path project = std::filesystem::path(__FILE__).parent_path().parent_path().parent_path();
  std::ifstream file(project / path);
  EXPECT_TRUE(file) << path;
  return {std::istreambuf_iterator<char>(file), {}};
}

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, separator);) parts.push_back(part);
  return parts;
}

std::string text_of_hex(unsigned number) {
  char text[8];
  std::snprintf(text, sizeof(text), "%04x", number);
  return text;
}

/// What a rule is about: "vendor:product" or "vendor:*", whether it is a camera, the group of its node.
using UsbRule = std::tuple<std::string, bool, std::string>;

std::set<UsbRule> rules_of(SourceTable sources) {
  std::set<UsbRule> rules;
  for (const SourceEntry& source : sources) {
    for (const UsbId& id : source.access.usb_ids)
      rules.emplace(text_of_hex(id.vendor) + ":" + (id.product == 0 ? "*" : text_of_hex(id.product)), id.is_camera, source.access.group);
  }
  return rules;
}

/// The lines of 60-camloc.rules that name a vendor. What jumps to camloc_usb_camera gets its group there.
std::set<UsbRule> rules_of_udev(const std::string& text) {
  const std::regex line(R"re(ATTR\{idVendor\}=="([^"]*)"(?:, ATTR\{idProduct\}=="([^"]*)")?, (.*))re"), group(R"re(GROUP="(\w+)")re");
  std::smatch found, in_group;
  const std::string camera_block = text.substr(text.find("LABEL=\"camloc_usb_camera\""));
  std::set<UsbRule> rules;
  for (const std::string& rule : split(text, '\n')) {
    if (!std::regex_match(rule, found, line)) continue;
    const std::string action = found[3];
    const bool is_camera = action.find("GOTO=\"camloc_usb_camera\"") != std::string::npos;
    const bool has_group = std::regex_search(is_camera ? camera_block : action, in_group, group);
    for (const std::string& vendor : split(found[1], '|')) {
      for (const std::string& product : split(found[2].matched ? found[2].str() : "*", '|'))
        rules.emplace(vendor + ":" + product, is_camera, has_group ? in_group[1].str() : "none");
    }
  }
  return rules;
}

TEST(Sources, UnknownSchemeListsTheKnown) {
  const auto source = open_frame_source("nosuch://0");
  ASSERT_FALSE(source.is_ok());
  EXPECT_EQ(source.status().code(), ErrorCode::kUnsupported);
  for (const SourceEntry& known : frame_sources())
    EXPECT_NE(source.status().message().find(std::string(known.scheme) + "://"), std::string::npos) << source.status().message();
  EXPECT_EQ(find_source("replay://x?nonsense").status().code(), ErrorCode::kInvalid);
}

TEST(Sources, EveryEntryIsComplete) {
  ASSERT_GE(frame_sources().size(), 2U);
  for (const SourceEntry& source : frame_sources()) {
    EXPECT_TRUE(std::string(source.help).starts_with(std::string(source.scheme) + "://")) << source.scheme;
    EXPECT_NE(std::string(source.help).find("  "), std::string::npos) << source.scheme << ": what it is comes after two blanks";
    EXPECT_EQ(source.is_recording, source.list == nullptr) << source.scheme;
    EXPECT_EQ(source.is_recording, source.access.group[0] == '\0') << source.scheme;
    EXPECT_EQ(*find_source(std::string(source.scheme) + "://"), &source);
  }
  EXPECT_STREQ((*find_source("/a/folder"))->scheme, "replay");
  for (const char* recording : {"oni://x", "replay://x", "sample://"}) EXPECT_TRUE((*find_source(recording))->is_recording) << recording;
}

TEST(Sources, UdevRulesAreThoseOfTheTable) {
  const std::string rules = project_text("systemd/60-camloc.rules");
  EXPECT_EQ(rules_of_udev(rules), rules_of(frame_sources()));
  const std::string service = project_text("systemd/camlocd.service.in");
  const std::string groups = service.substr(service.find("SupplementaryGroups=") + 20);
  for (const SourceEntry& source : frame_sources()) {
    const DeviceAccess& access = source.access;
    EXPECT_NE((" " + groups.substr(0, groups.find('\n')) + " ").find(access.group), std::string::npos) << access.group;
    if (access.kernel_nodes[0] == '\0') continue;
    const std::vector<std::string> node = split(access.kernel_nodes, '/');
    EXPECT_NE(rules.find("SUBSYSTEM==\"" + node[0] + "\", KERNEL==\"" + node[1] + "\", GOTO=\"camloc_camera\""), std::string::npos);
  }
}

TEST(Sources, DocumentsNameEverySource) {
  const std::string text = project_text("docs/cameras.md");
  std::set<std::string> documented, known;
  const std::regex row(R"(^\| `(\w+)://)");
  std::smatch found;
  for (const std::string& line : split(text, '\n')) {
    if (std::regex_search(line, found, row)) documented.insert(found[1]);
  }
  for (const SourceEntry& source : frame_sources()) known.insert(source.scheme);
  EXPECT_EQ(documented, known) << "the first table of docs/cameras.md";
}

TEST(Sources, UsbDevicesBelongToTheSourceThatOpensThem) {
  const UsbDevice kinect = bare_usb_device(0x045e, 0x02ae), motor = bare_usb_device(0x045e, 0x02b0);
  const UsbDevice xtion = bare_usb_device(0x1d27, 0x0601), mouse = bare_usb_device(0x046d, 0xc077);
  EXPECT_STREQ(find_usb_source(kinect)->scheme, "kinect");
  EXPECT_STREQ(find_usb_source(motor)->scheme, "kinect");
  EXPECT_STREQ(find_usb_source(xtion)->scheme, "openni2");
  EXPECT_EQ(find_usb_source(mouse), nullptr);
  EXPECT_TRUE(is_usb_camera(kinect));
  EXPECT_TRUE(is_usb_camera(xtion));
  EXPECT_FALSE(is_usb_camera(motor));
  EXPECT_FALSE(is_usb_camera(mouse));
}

// ---- A source of this test's own: this much code, and one line in a table.

Result<std::unique_ptr<FrameSource>> open_toy(const SourceUrl& url, const FrameSourceOptions& options) {
  if (Status status = url.check_options({"width"}); !status) return status;
  return open_sample_source(*parse_source_url("sample://?width=64&height=48&rate_hz=0"), options);
}

constexpr UsbId kToyUsbIds[] = {{0x1209, 0x0001}};

CameraListing list_toys(const SystemFolders& folders) {
  CameraListing listing;
  for (const UsbDevice& device : list_usb_devices(folders)) {
    if (kToyUsbIds[0].matches(device)) listing.cameras.push_back({"toy://" + device.serial, "Toy", "USB " + device.name, ""});
  }
  return listing;
}

TEST(SourcesSeam, ASourceIsOneFileAndOneLine) {
  std::vector<SourceEntry> table(frame_sources().begin(), frame_sources().end());
  table.push_back({"toy", open_toy, list_toys, false, {"plugdev", kToyUsbIds, "", ""}, "toy://SERIAL?width=64  a toy"});

  auto source = open_frame_source("toy://7?width=64", {}, table);
  ASSERT_TRUE(source.is_ok()) << source.status().message();
  FrameBuffer frame;
  ASSERT_TRUE((*source)->next(&frame, std::chrono::milliseconds(0)));
  EXPECT_EQ(frame.gray.width, 64);
  EXPECT_EQ(open_frame_source("toy://7?nonsense=1", {}, table).status().code(), ErrorCode::kInvalid);
  EXPECT_NE(open_frame_source("nosuch://", {}, table).status().message().find("toy://"), std::string::npos);
  EXPECT_EQ(open_frame_source("toy://7").status().code(), ErrorCode::kUnsupported) << "the build's own table is what it was";

  const FakeUsb usb;
  usb.add("1-1", {0x1209, 0x0001, 5, "7"});
  const CameraListing listing = table.back().list(usb.folders());
  ASSERT_EQ(listing.cameras.size(), 1U);
  EXPECT_EQ(listing.cameras[0].url, "toy://7");
  EXPECT_STREQ(find_usb_source(list_usb_devices(usb.folders())[0], table)->scheme, "toy");

  const std::string rules = project_text("systemd/60-camloc.rules");
  EXPECT_NE(rules_of_udev(rules), rules_of(table)) << "a camera without its udev rule is noticed";
  EXPECT_EQ(rules_of_udev(R"(ATTR{idVendor}=="1209", ATTR{idProduct}=="0001", GOTO="camloc_usb_camera")"
                          "\n" +
                          rules),
            rules_of(table));
}

}  // namespace
}  // namespace camloc
