// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A new device adds its line here and nothing else.
#include "drivers/sources.h"

#include <algorithm>

#include "core/io/text.h"
#include "drivers/kinect/kinect_list.h"
#include "drivers/kinect/kinect_source.h"
#include "drivers/openni2/installation.h"
#include "drivers/openni2/oni_source.h"
#include "drivers/openni2/openni2_source.h"
#include "drivers/replay_source.h"
#include "drivers/sample_source.h"
#include "drivers/v4l2/v4l2_list.h"
#include "drivers/v4l2/v4l2_source.h"

namespace camloc {

namespace {

// scheme, open, list, is_recording, access, help
constexpr SourceEntry kSources[] = {
    {"kinect",
     open_kinect_source,
     list_kinects,
     false,
     {"plugdev", kKinectUsbIds, "", "gspca_kinect"},
     "kinect://[SERIAL|INDEX]?depth=registered|raw|off&exposure_us=8000&led=status&tilt_deg=0  a Kinect V1 on USB; more: "
     "auto_exposure=0|1, "
     "gain=1..16, white_balance=auto|manual"},
    {"v4l2",
     open_v4l2_source,
     list_v4l2_cameras,
     false,
     {"video", {}, "video4linux/video*", ""},
     "v4l2:///dev/video0?depth=/dev/video2&width=640&height=480&rate_hz=30&format=YUYV&depth_format=Z16&control.gain=10  cameras of the "
     "kernel; NODE or serial:XXXX"},
    {"openni2",
     open_openni2_source,
     list_openni2_cameras,
     false,
     {"plugdev", kOpenni2UsbIds, "", ""},
     "openni2://URI_SERIAL_OR_INDEX?width=640&height=480&rate_hz=30  a depth camera with an OpenNI2 driver; openni2:// is the first one"},
    {"oni",
     open_oni_source,
     nullptr,
     true,
     {},
     "oni://FILE?speed=1&loop=0&frames=0:100:2&exclude=::50&registered=1  a recording of OpenNI or OpenNI2"},
    {"replay",
     open_replay_source,
     nullptr,
     true,
     {},
     "replay://DIR?speed=1&loop=0&frames=0:100:2&exclude=::50&rate_hz=30&pair_ms=20  a recorded TUM RGB-D or 7-Scenes folder; speed=0 "
     "(default) is as "
     "fast as possible"},
    {"sample",
     open_sample_source,
     nullptr,
     true,
     {},
     "sample://?rate_hz=30&frames=300&width=640&height=480  generated images of a room, for trying things without a camera"},
};

Result<const SourceEntry*> find_scheme(const SourceUrl& url, SourceTable sources) {
  std::string known;
  for (const SourceEntry& source : sources) {
    if (url.scheme == source.scheme) return &source;
    known += std::string(known.empty() ? "" : ", ") + source.scheme + "://";
  }
  return Status(ErrorCode::kUnsupported, "this build knows no " + in_quotes(url.scheme) + " source; it knows " + known);
}

}  // namespace

SourceTable frame_sources() { return kSources; }

Result<const SourceEntry*> find_source(const std::string& url, SourceTable sources) {
  const Result<SourceUrl> parsed = parse_source_url(url);
  return parsed ? find_scheme(*parsed, sources) : Result<const SourceEntry*>(parsed.status());
}

Result<std::unique_ptr<FrameSource>> open_frame_source(const std::string& url, const FrameSourceOptions& options, SourceTable sources) {
  const Result<SourceUrl> parsed = parse_source_url(url);
  if (!parsed) return parsed.status();
  const Result<const SourceEntry*> source = find_scheme(*parsed, sources);
  if (!source) return source.status().with_context(url);
  return (*source)->open(*parsed, options);
}

const SourceEntry* find_usb_source(const UsbDevice& device, SourceTable sources) {
  const auto opens = [&device](const SourceEntry& source) {
    return std::any_of(source.access.usb_ids.begin(), source.access.usb_ids.end(), [&](const UsbId& id) { return id.matches(device); });
  };
  const auto found = std::find_if(sources.begin(), sources.end(), opens);
  return found == sources.end() ? nullptr : &*found;
}

bool is_usb_camera(const UsbDevice& device, SourceTable sources) {
  const SourceEntry* source = find_usb_source(device, sources);
  return source != nullptr && std::any_of(source->access.usb_ids.begin(), source->access.usb_ids.end(),
                                          [&](const UsbId& id) { return id.is_camera && id.matches(device); });
}

}  // namespace camloc
