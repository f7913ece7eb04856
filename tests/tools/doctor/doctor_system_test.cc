// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What can be wrong with service, clock, memory and network.
#include <gtest/gtest.h>

#include "tests/drivers/fake_usb.h"
#include "tests/tools/expect_check.h"

namespace camloc::tools {
namespace {

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

}  // namespace
}  // namespace camloc::tools
