// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Kinects of a fake /sys: who they are, and what it says when only a part of one is there.
#include "drivers/kinect/kinect_list.h"

#include <gtest/gtest.h>

#include "tests/drivers/fake_usb.h"

namespace camloc {
namespace {

TEST(KinectList, CamerasBySerialOrIndex) {
  const FakeUsb usb;
  usb.add("1-1", {0x045e, 0x02c2, 2});
  usb.add("1-1.2", {0x045e, 0x02ae, 5, "0000000000000000", "gspca_kinect"});
  usb.add("1-1.1", {0x045e, 0x02ad, 4, "A00366A04933051A"});
  usb.add("1-2", {0x045e, 0x02ae, 7, "A70774V00000000A"});
  usb.add("2-1", {0x045e, 0x02bf, 3});
  usb.add("2-2", {0x1d27, 0x0601, 4});
  const CameraListing listing = list_kinects(usb.folders());
  ASSERT_EQ(listing.cameras.size(), 3U);
  EXPECT_EQ(listing.cameras[0].url, "kinect://A00366A04933051A") << "of the audio device beside it";
  EXPECT_EQ(listing.cameras[0].where, "USB 1-1.2");
  EXPECT_EQ(listing.cameras[0].name, "Kinect V1");
  EXPECT_EQ(listing.cameras[1].url, "kinect://A70774V00000000A");
  EXPECT_EQ(listing.cameras[2].url, "kinect://2");
  EXPECT_EQ(listing.cameras[2].name, "Kinect for Windows V1");
  EXPECT_EQ(listing.problem, "");
}

TEST(KinectList, PartsWithoutACameraAreAProblem) {
  const FakeUsb usb;
  usb.add("1-3", {0x046d, 0xc077, 6});
  const CameraListing none = list_kinects(usb.folders());
  EXPECT_TRUE(none.cameras.empty());
  EXPECT_EQ(none.problem, "") << "no Kinect is no problem";
  EXPECT_EQ(none.searched, "1 USB devices");
  usb.add("1-1", {0x045e, 0x02b0, 4});
  const CameraListing motor = list_kinects(usb.folders());
  EXPECT_TRUE(motor.cameras.empty());
  EXPECT_NE(motor.problem.find("its camera is not"), std::string::npos);
  EXPECT_NE(motor.advice.find("12 V power supply"), std::string::npos);
}

}  // namespace
}  // namespace camloc
