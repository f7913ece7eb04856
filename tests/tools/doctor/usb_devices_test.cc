// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What a fake /sys says about cameras on USB.
#include "tools/doctor/usb_devices.h"

#include <gtest/gtest.h>

#include "tests/tools/fake_usb.h"

namespace camloc::tools {
namespace {

TEST(UsbDevicesTest, ReadsWhatTheKernelSays) {
  const FakeUsb usb;
  usb.add("1-1", {0x045e, 0x02c2, 2});
  usb.add("1-1.2", {0x045e, 0x02ae, 5, "0000000000000000", "gspca_kinect"});
  usb.add("1-1.1", {0x045e, 0x02ad, 4, "A00366A04933051A"});
  usb.add("2-1", {0x1d27, 0x0601, 3});
  usb.write("/sys/bus/usb/devices/3-1/idVendor", "nonsense\n");
  const auto devices = list_usb_devices(usb.folders());
  ASSERT_EQ(devices.size(), 4U);
  const UsbDevice& kinect = devices[2];
  EXPECT_EQ(kinect.usb_id(), "045e:02ae");
  EXPECT_EQ(role_of(kinect), UsbRole::kKinectCamera);
  EXPECT_EQ(kinect.node(), "/dev/bus/usb/001/005");
  EXPECT_EQ(kinect.hub(), "1-1");
  EXPECT_EQ(kinect.speed_mbps, 480);
  EXPECT_EQ(kinect.drivers, (std::vector<std::string>{"gspca_kinect"}));
  EXPECT_EQ(kinect_serial(kinect, devices), "A00366A04933051A") << "of the audio device beside it";
  EXPECT_EQ(role_of(devices[3]), UsbRole::kOpenni2Camera);
  EXPECT_TRUE(list_usb_devices(SystemFolders{"/no/such/root"}).empty());
}

}  // namespace
}  // namespace camloc::tools
