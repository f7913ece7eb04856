// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What a fake /sys says about devices on USB.
#include "drivers/usb_devices.h"

#include <gtest/gtest.h>

#include "tests/drivers/fake_usb.h"

namespace camloc {
namespace {

TEST(UsbDevices, ReadsWhatTheKernelSays) {
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
  EXPECT_EQ(kinect.node(), "/dev/bus/usb/001/005");
  EXPECT_EQ(kinect.hub(), "1-1");
  EXPECT_EQ(kinect.speed_mbps, 480);
  EXPECT_EQ(kinect.drivers, (std::vector<std::string>{"gspca_kinect"}));
  EXPECT_TRUE(list_usb_devices(SystemFolders{"/no/such/root"}).empty());
}

TEST(UsbDevices, IdsMatchAProductOrAllOfAVendor) {
  const UsbDevice device = bare_usb_device(0x1d27, 0x0601);
  EXPECT_TRUE((UsbId{0x1d27, 0x0601}.matches(device)));
  EXPECT_TRUE((UsbId{0x1d27}.matches(device)));
  EXPECT_FALSE((UsbId{0x1d27, 0x0600}.matches(device)));
  EXPECT_FALSE((UsbId{0x2bc5}.matches(device)));
}

}  // namespace
}  // namespace camloc
