// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A tree of /sys and /dev as the kernel and udev make it for a depth camera with three nodes and a webcam without a serial.
#include "drivers/v4l2/v4l2_list.h"

#include <gtest/gtest.h>

#include "tests/drivers/fake_v4l2.h"
#include "tests/drivers/test_folder.h"

namespace camloc {
namespace {

namespace fs = std::filesystem;
using testing::FakeNode;
using testing::FakeV4l2;

class V4l2List : public ::testing::Test {
 protected:
  V4l2List() {
    add_usb("usb1/1-2", "7", "ABC123\n");
    add_usb("usb1/1-3", "12", "");
    add_node("video0", "usb1/1-2/1-2:1.0").formats = {{V4L2_PIX_FMT_Z16, {{640, 480, {30}}}}};
    add_node("video1", "usb1/1-2/1-2:1.0").capabilities = V4L2_CAP_META_CAPTURE;
    add_node("video2", "usb1/1-2/1-2:1.0").formats = {{V4L2_PIX_FMT_GREY, {{640, 480, {30}}}}, {V4L2_PIX_FMT_Y16, {{640, 480, {30}}}}};
    add_node("video10", "usb1/1-2/1-2:1.3").formats = {{V4L2_PIX_FMT_YUYV, {{640, 480, {30}}}}};
    add_node("video4", "usb1/1-3/1-3:1.0").card = "Web\ncam";
    fs::create_directories(folder_ / "dev/v4l/by-id");
    fs::create_symlink("../../video10", folder_ / "dev/v4l/by-id/usb-Depth_ABC123-video-index0");
  }
  void add_usb(const std::string& device, const std::string& number, const std::string& serial) {
    folder_.write("sys/devices/" + device + "/idVendor", "8086\n");
    folder_.write("sys/devices/" + device + "/idProduct", "0ad2\n");
    folder_.write("sys/devices/" + device + "/busnum", "1\n");
    folder_.write("sys/devices/" + device + "/devnum", number + "\n");
    if (!serial.empty()) folder_.write("sys/devices/" + device + "/serial", serial);
  }
  FakeNode& add_node(const std::string& name, const std::string& interface) {
    const std::string device = folder_ / "sys/devices/" + interface;
    fs::create_directories(device);
    const std::string folder = folder_ / "sys/class/video4linux/" + name;
    fs::create_directories(folder);
    fs::create_symlink(device, folder + "/device");
    folder_.write("dev/" + name, "");
    return io_.add(node(name));
  }
  [[nodiscard]] std::string node(const std::string& name) const { return fs::canonical(folder_.path()).string() + "/dev/" + name; }

  TestFolder folder_;
  FakeV4l2 io_;
  SystemFolders folders_{folder_.path()};
};

TEST_F(V4l2List, NodesWithSerialsInTheOrderOfTheirNumbers) {
  const std::vector<V4l2DeviceInfo> nodes = list_v4l2_devices(io_, folders_);
  ASSERT_EQ(nodes.size(), 4U) << "metadata is left out";
  EXPECT_EQ(nodes[0].path, node("video0"));
  EXPECT_EQ(nodes[0].serial, "ABC123");
  EXPECT_EQ(nodes[0].usb_node, folders_.path("/dev") + "/bus/usb/001/007");
  EXPECT_EQ(offers_line(nodes[0].formats), "Z16 640x480 (30 Hz)");
  EXPECT_EQ(nodes[2].path, node("video4"));
  EXPECT_EQ(nodes[2].name, "Web?cam");
  EXPECT_EQ(nodes[2].serial, "");
  EXPECT_EQ(nodes[3].path, node("video10"));
  EXPECT_EQ(io_.num_open(), 0);
}

TEST_F(V4l2List, NodesThatCannotBeOpenedSayWhy) {
  io_.node(node("video4")).faults.is_gone = true;
  const std::vector<V4l2DeviceInfo> nodes = list_v4l2_devices(io_, folders_);
  ASSERT_EQ(nodes.size(), 4U);
  EXPECT_NE(nodes[2].problem.find("No such device"), std::string::npos) << nodes[2].problem;
}

TEST_F(V4l2List, NothingThere) { EXPECT_TRUE(list_v4l2_devices(io_, {folder_ / "none"}).empty()); }

TEST_F(V4l2List, CamerasForPeople) {
  io_.node(node("video4")).faults.is_gone = true;
  const CameraListing listing = list_v4l2_cameras(io_, folders_);
  ASSERT_EQ(listing.cameras.size(), 4U);
  EXPECT_EQ(listing.cameras[0].url, "v4l2://serial:ABC123");
  EXPECT_EQ(listing.cameras[0].where.rfind(node("video0"), 0), 0U) << listing.cameras[0].where;
  EXPECT_EQ(listing.cameras[0].problem, "");
  EXPECT_EQ(listing.cameras[2].url, "v4l2://" + node("video4")) << "no serial";
  EXPECT_NE(listing.cameras[2].problem.find("No such device"), std::string::npos);
  EXPECT_TRUE(list_v4l2_cameras(SystemFolders{"/no/such/root"}).cameras.empty());
}

TEST_F(V4l2List, SerialAndRoleFindANode) {
  EXPECT_EQ(*find_v4l2_node(io_, folders_, "ABC123", V4l2Role::kImage), node("video10")) << "colour before infrared";
  EXPECT_EQ(*find_v4l2_node(io_, folders_, "ABC123", V4l2Role::kDepth), node("video0")) << "Z16 before Y16";
  io_.node(node("video10")).formats.clear();
  EXPECT_EQ(*find_v4l2_node(io_, folders_, "ABC123", V4l2Role::kImage), node("video2"));
  const Status missing = find_v4l2_node(io_, folders_, "XYZ", V4l2Role::kImage).status();
  EXPECT_EQ(missing.code(), ErrorCode::kUnavailable);
  EXPECT_EQ(missing.message(), "no camera with serial 'XYZ' is plugged in; there is ABC123");
  io_.node(node("video0")).formats.clear();
  io_.node(node("video2")).formats.clear();
  EXPECT_EQ(find_v4l2_node(io_, folders_, "ABC123", V4l2Role::kDepth).status().code(), ErrorCode::kUnsupported);
}

TEST_F(V4l2List, LinksAreFollowed) {
  const V4l2DeviceInfo info = describe_v4l2_node(folders_.path("/dev") + "/v4l/by-id/usb-Depth_ABC123-video-index0", folders_);
  EXPECT_EQ(info.path, node("video10"));
  EXPECT_EQ(info.serial, "ABC123");
  EXPECT_EQ(describe_v4l2_node("/dev/nosuch", folders_).path, "/dev/nosuch");
}

TEST_F(V4l2List, NonsenseInSys) {
  folder_.write("sys/devices/usb1/1-2/busnum", "-1\n");
  folder_.write("sys/devices/usb1/1-3/serial", std::string(5000, 'x') + "\n");
  EXPECT_EQ(describe_v4l2_node(node("video0"), folders_).usb_node, "");
  EXPECT_EQ(describe_v4l2_node(node("video4"), folders_).serial.substr(0, 2), "xx");
  EXPECT_LT(describe_v4l2_node(node("video4"), folders_).serial.size(), 300U);
}

}  // namespace
}  // namespace camloc
