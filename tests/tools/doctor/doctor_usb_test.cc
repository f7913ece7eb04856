// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What can be wrong with a camera on USB, present and absent, on machines that the test makes up.
#include <unistd.h>

#include <filesystem>

#include "tests/drivers/fake_usb.h"
#include "tests/tools/expect_check.h"
#include "tools/doctor/doctor_checks.h"

namespace camloc::tools {
namespace {

const FakeUsbDevice kKinect{0x045e, 0x02ae, 5};
const FakeUsbDevice kMotor{0x045e, 0x02b0, 4};

/// What doctor says of a kind of camera on that machine.
Check presence(const FakeUsb& usb, const std::string& scheme, bool is_wanted) {
  const SourceEntry& source = **find_source(scheme + "://");
  return check_presence(source, source.list(usb.folders()), is_wanted);
}

TEST(DoctorUsbTest, PresenceAndPower) {
  FakeUsb usb;
  expect(presence(usb, "kinect", true), Level::kFailure, "no kinect:// camera is there; looked at: 0 USB devices", "lsusb");
  usb.add("1-1.1", kMotor);
  expect(presence(usb, "kinect", true), Level::kFailure, "its camera is not", "12 V power supply");
  expect(presence(usb, "kinect", false), Level::kWarning, "its camera is not", "12 V power supply");
  usb.add("1-1.2", kKinect);
  expect(presence(usb, "kinect", true), Level::kOk, "kinect://0 (USB 1-1.2)");
  expect(presence(usb, "v4l2", true), Level::kFailure, "no v4l2:// camera is there", "/dev/v4l/by-id");
}

TEST(DoctorUsbTest, WhatASourceSaysOfItselfIsShown) {
  const SourceEntry& source = **find_source("openni2://");
  CameraListing listing{{}, "", "libOpenNI2.so.0 is not installed", "sudo apt install libopenni2-0"};
  expect(check_presence(source, listing, true), Level::kFailure, "not installed", "apt install libopenni2-0");
  expect(check_presence(source, listing, false), Level::kWarning, "not installed", "apt");
  listing = {{}, "OpenNI2 2.2, 1 drivers in /usr/lib", "", "a Kinect V1 is kinect://"};
  expect(check_presence(source, listing, true), Level::kFailure, "1 drivers in /usr/lib", "kinect://");
  listing.cameras = {{"openni2://1d27/0601@1/4", "Xtion", "USB id 1d27:0601", ""}};
  expect(check_presence(source, listing, true), Level::kOk, "1d27/0601@1/4");
  listing.cameras[0].problem = "no permission";
  expect(check_presence(source, listing, true), Level::kFailure, "no permission", "kinect://");
}

TEST(DoctorUsbTest, RightsAreThoseOfTheServiceNotOfWhoeverAsks) {
  FakeUsb usb;
  usb.add("1-2", kKinect);
  const auto devices = list_usb_devices(usb.folders());
  const std::string node = usb.folders().path(devices[0].node());
  const auto set_mode = [&node](unsigned mode) { std::filesystem::permissions(node, static_cast<std::filesystem::perms>(mode)); };
  set_mode(0660);
  expect(check_usb_rights(devices, usb.folders(), ::getgid()), Level::kOk, "/dev/bus/usb/001/005 may be opened");
  expect(check_usb_rights(devices, usb.folders(), ::getgid() + 1), Level::kFailure, "mode 0660", "install the package camloc");
  set_mode(0644);
  expect(check_usb_rights(devices, usb.folders(), ::getgid()), Level::kFailure, "mode 0644", "install the package camloc");
  usb.write("/lib/udev/rules.d/60-camloc.rules", "");
  expect(check_usb_rights(devices, usb.folders(), ::getgid()), Level::kFailure, "mode 0644", "sudo udevadm trigger");
  set_mode(0666);
  expect(check_usb_rights(devices, usb.folders(), ::getgid() + 1), Level::kOk, "may be opened");
  std::filesystem::remove(node);
  expect(check_usb_rights(devices, usb.folders(), ::getgid()), Level::kFailure, "does not exist", "udevadm");
}

TEST(DoctorUsbTest, DriversInTheWay) {
  for (const auto& [driver, level] : {std::pair{"gspca_kinect", Level::kWarning}, {"usbfs", Level::kFailure}, {"", Level::kOk}}) {
    FakeUsb usb;
    FakeUsbDevice device = kKinect;
    device.driver = driver;
    usb.add("1-2", device);
    const auto devices = list_usb_devices(usb.folders());
    const char* detail = level == Level::kWarning ? "gspca_kinect has it" : level == Level::kFailure ? "another program" : "in the way";
    const char* advice = level == Level::kWarning   ? "modprobe -r gspca_kinect"
                         : level == Level::kFailure ? "fuser -v /dev/bus/usb/001/005"
                                                    : "";
    expect(check_usb_driver(devices, "kinect", false), level, detail, advice);
    if (level == Level::kWarning) expect(check_usb_driver(devices, "v4l2", false), Level::kOk, "");
    if (level == Level::kFailure) expect(check_usb_driver(devices, "kinect", true), Level::kOk, "camlocd");
  }
}

TEST(DoctorUsbTest, Bandwidth) {
  FakeUsb usb;
  usb.add("1-2", kKinect);
  usb.write("/sys/module/usbcore/parameters/usbfs_memory_mb", "16\n");
  expect(check_usb_bandwidth(list_usb_devices(usb.folders()), usb.folders()), Level::kOk, "high speed");
  usb.write("/sys/module/usbcore/parameters/usbfs_memory_mb", "4\n");
  expect(check_usb_bandwidth(list_usb_devices(usb.folders()), usb.folders()), Level::kWarning, "4 MB", "usbfs_memory_mb");
  FakeUsbDevice webcam{0x046d, 0x0825, 9};
  webcam.driver = "uvcvideo";
  usb.add("1-3", webcam);
  expect(check_usb_bandwidth(list_usb_devices(usb.folders()), usb.folders()), Level::kWarning, "2 cameras share USB bus 1", "lsusb -t");
  FakeUsbDevice slow = kKinect;
  slow.speed = "12";
  usb.add("1-2", slow);
  std::filesystem::remove_all(usb.folders().path("/sys/bus/usb/devices/1-3"));
  expect(check_usb_bandwidth(list_usb_devices(usb.folders()), usb.folders()), Level::kFailure, "12 Mbit/s", "USB 2 port");
}

}  // namespace
}  // namespace camloc::tools
