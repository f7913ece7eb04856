// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The table of frame sources. A new device adds its line here and nothing else.
#include "drivers/frame_source.h"

#include "drivers/kinect/kinect_source.h"
#include "drivers/openni2/oni_source.h"
#include "drivers/openni2/openni2_source.h"
#include "drivers/replay_source.h"
#include "drivers/sample_source.h"
#include "drivers/source_url.h"
#include "drivers/v4l2/v4l2_source.h"

namespace camloc {

namespace {

struct Scheme {
  const char* name;
  Result<std::unique_ptr<FrameSource>> (*open)(const SourceUrl&, const FrameSourceOptions&);
  const char* help;
};

constexpr Scheme kSchemes[] = {
    {"kinect", open_kinect_source,
     "kinect://[SERIAL|INDEX]?depth=registered|raw|off&exposure_us=8000&led=status&tilt_deg=0  a Kinect V1 on USB; more: "
     "auto_exposure=0|1, "
     "gain=1..16, white_balance=auto|manual"},
    {"replay", open_replay_source,
     "replay://DIR?speed=1&loop=0&frames=0:100:2&exclude=::50&rate_hz=30  a recorded TUM RGB-D or 7-Scenes folder; speed=0 (default) is as "
     "fast as possible"},
    {"openni2", open_openni2_source,
     "openni2://URI_SERIAL_OR_INDEX?width=640&height=480&rate_hz=30  a depth camera with an OpenNI2 driver; openni2:// is the first one"},
    {"oni", open_oni_source, "oni://FILE?speed=1&loop=0&frames=0:100:2&exclude=::50&registered=1  a recording of OpenNI or OpenNI2"},
    {"sample", open_sample_source,
     "sample://?rate_hz=30&frames=300&width=640&height=480  generated images of a room, for trying things without a camera"},
    {"v4l2", open_v4l2_source,
     "v4l2:///dev/video0?depth=/dev/video2&width=640&height=480&rate_hz=30&format=YUYV&depth_format=Z16&control.gain=10  cameras of the "
     "kernel; NODE or serial:XXXX"},
};

}  // namespace

Result<std::unique_ptr<FrameSource>> open_frame_source(const std::string& url, const FrameSourceOptions& options) {
  const Result<SourceUrl> parsed = parse_source_url(url);
  if (!parsed) return parsed.status();
  std::string known;
  for (const Scheme& scheme : kSchemes) {
    if (parsed->scheme == scheme.name) return scheme.open(*parsed, options);
    known += std::string(known.empty() ? "" : ", ") + scheme.name + "://";
  }
  return Status(ErrorCode::kUnsupported, url + ": no frame source for " + parsed->scheme + "://; this build knows " + known);
}

std::vector<FrameSourceScheme> frame_source_schemes() {
  std::vector<FrameSourceScheme> result;
  for (const Scheme& scheme : kSchemes) result.push_back({scheme.name, scheme.help});
  return result;
}

}  // namespace camloc
