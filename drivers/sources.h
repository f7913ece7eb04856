// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The table of frame sources: all that a program must know of a camera or a kind of recording. Opening by URL, `camloc camera
// list` and `doctor`, camlocd's checks, manual pages and completion follow from it; 60-camloc.rules and docs/cameras.md are
// compared with it by a test.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "core/base/result.h"
#include "drivers/frame_source.h"
#include "drivers/source_url.h"
#include "drivers/usb_devices.h"

namespace camloc {

/// How a device gets into a program's hands.
struct DeviceAccess {
  const char* group = "";             ///< that its node belongs to; camlocd.service is in it
  std::span<const UsbId> usb_ids;     ///< opened over USB
  const char* kernel_nodes = "";      ///< "SUBSYSTEM/NAME*" of the nodes that a driver of the kernel makes for it
  const char* competing_driver = "";  ///< of the kernel: takes the device as it is plugged in
};

struct SourceEntry {
  const char* scheme;
  Result<std::unique_ptr<FrameSource>> (*open)(const SourceUrl& url, const FrameSourceOptions& options);
  CameraListing (*list)(const SystemFolders& folders);  ///< nullptr for recordings
  bool is_recording;                                    ///< opening it disturbs nobody and waits for nothing
  DeviceAccess access;
  const char* help;  ///< URL with its options, two blanks, what it is
};
using SourceTable = std::span<const SourceEntry>;

/// All of this build.
[[nodiscard]] SourceTable frame_sources();

/// By the scheme of `url`; a bare path is replay://path. kInvalid: no URL; kUnsupported: no such scheme, with those there are.
[[nodiscard]] Result<const SourceEntry*> find_source(const std::string& url, SourceTable sources = frame_sources());
[[nodiscard]] Result<std::unique_ptr<FrameSource>> open_frame_source(const std::string& url, const FrameSourceOptions& options = {},
                                                                     SourceTable sources = frame_sources());

/// The source that opens this device, or a camera beside it, over USB; nullptr where none does.
[[nodiscard]] const SourceEntry* find_usb_source(const UsbDevice& device, SourceTable sources = frame_sources());
[[nodiscard]] bool is_usb_camera(const UsbDevice& device, SourceTable sources = frame_sources());

}  // namespace camloc
