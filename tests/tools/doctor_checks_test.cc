// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Every cause that `camloc doctor` knows, present and absent, on machines that the test makes up.
#include "tools/doctor/doctor_checks.h"

#include <unistd.h>

#include <filesystem>

#include "tests/drivers/fake_usb.h"
#include "tests/tools/command_runner.h"

namespace camloc::tools {
namespace {

const FakeUsbDevice kKinect{0x045e, 0x02ae, 5};
const FakeUsbDevice kMotor{0x045e, 0x02b0, 4};

void expect(const Check& check, Level level, const std::string& detail, const std::string& advice = "") {
  EXPECT_EQ(check.level, level) << check.name << ": " << check.detail;
  EXPECT_NE(check.detail.find(detail), std::string::npos) << check.name << ": " << check.detail;
  EXPECT_NE(check.advice.find(advice), std::string::npos) << check.name << ": " << check.advice;
  EXPECT_EQ(check.advice.empty(), level == Level::kOk) << check.name << ": " << check.advice;
  EXPECT_EQ((check.detail + check.advice).find('\n'), std::string::npos);
}

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

TEST(DoctorSystemTest, ServiceStates) {
  const std::string loaded = "LoadState=loaded\nUnitFileState=enabled\n";
  expect(check_service(loaded + "ActiveState=active\nSubState=running\nResult=success\nNRestarts=0\n"), Level::kOk, "active");
  expect(check_service(loaded + "ActiveState=active\nSubState=running\nNRestarts=3\n"), Level::kWarning, "3 restarts",
         "journalctl -u camlocd");
  expect(check_service(loaded + "ActiveState=failed\nSubState=failed\nResult=watchdog\n"), Level::kFailure, "watchdog", "journalctl");
  expect(check_service(loaded + "ActiveState=activating\nSubState=auto-restart\nResult=exit-code\n"), Level::kFailure, "exit-code",
         "journalctl");
  expect(check_service(loaded + "ActiveState=activating\nSubState=start\n"), Level::kWarning, "starting", "journalctl");
  expect(check_service(loaded + "ActiveState=inactive\nSubState=dead\n"), Level::kWarning, "inactive", "sudo systemctl start camlocd");
  expect(check_service("LoadState=loaded\nUnitFileState=disabled\nActiveState=inactive\n"), Level::kWarning, "not enabled", "enable --now");
  expect(check_service("LoadState=not-found\nActiveState=inactive\n"), Level::kWarning, "not installed", "apt install");
  expect(check_service("LoadState=masked\nActiveState=inactive\n"), Level::kWarning, "masked", "unmask");
  expect(check_service("Failed to connect to bus\n"), Level::kWarning, "systemctl", "systemd");
}

TEST(DoctorSystemTest, Clock) {
  expect(check_clock({1'800'000'000, true}), Level::kOk, "2027-01-15 08:00:00 UTC, synchronized");
  expect(check_clock({1'800'000'000, false}), Level::kWarning, "not synchronized", "timedatectl set-ntp true");
  expect(check_clock({1000, false}), Level::kFailure, "1970-01-01", "timedatectl");
  EXPECT_GT(read_clock().epoch_s, 1'600'000'000);
}

TEST(DoctorSystemTest, MemoryAndLcm) {
  FakeUsb machine;
  machine.write("/proc/meminfo", "MemTotal: 2000000 kB\nMemAvailable: 900000 kB\n");
  expect(check_memory(machine.folders()), Level::kOk, "878 MiB");
  machine.write("/proc/meminfo", "MemAvailable: 20000 kB\n");
  expect(check_memory(machine.folders()), Level::kWarning, "19 MiB", "32 MiB");
  expect(check_lcm("file://x"), Level::kOk, "no network");
  expect(check_lcm("nonsense"), Level::kFailure, "nonsense", "publish.lcm_url");
}

TEST(DoctorSetupTest, CalibrationOfAnotherImageSize) {
  const TemporaryFolder folder;
  const std::string path = folder.write(
      "c.toml",
      "[color]\nwidth = 64\nheight = 48\nfx = 50.0\nfy = 50.0\ncx = 32.0\ncy = 24.0\nlens = \"pinhole\"\n[depth]\nregistered = true\n");
  expect(check_calibration(path, std::nullopt, FrameSize{64, 48}), Level::kOk, path);
  expect(check_calibration(path, std::nullopt, std::nullopt), Level::kOk, path);
  expect(check_calibration(path, std::nullopt, FrameSize{640, 480}), Level::kFailure, "is for 64x48 pixels, the camera gives 640x480",
         "camloc camera calibrate");
  expect(check_calibration(folder / "none.toml", std::nullopt, std::nullopt), Level::kFailure, "none.toml", "set another");
  const nlohmann::ordered_json answer{{"is_calibration_suspect", true}, {"focal_scale", 1.17}};
  expect(check_calibration(path, answer, std::nullopt), Level::kWarning, "1.170 times", "calibrate");
}

TEST(DoctorSetupTest, SchemeOfTheSource) {
  Settings settings;
  EXPECT_EQ(settings.scheme(), "");
  settings.source_url = "kinect://A00366A";
  EXPECT_EQ(settings.scheme(), "kinect");
  settings.source_url = "/data/walk";
  EXPECT_EQ(settings.scheme(), "replay");
}

}  // namespace
}  // namespace camloc::tools
