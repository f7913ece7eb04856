// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Only the frames that somebody picked pixels in are wanted, each with a few before it: the localizer may track into them.
#include <optional>
#include <set>

#include "core/localize/localizer.h"
#include "drivers/sources.h"
#include "tools/common/frame_reading.h"
#include "tools/common/text_format.h"
#include "tools/mapping/site/control_points.h"

namespace camloc::mapping {
namespace {

constexpr std::uint64_t kRunUpFrames = 10;

using Frames = std::map<std::uint64_t, LocalizedFrame>;

Status check_size(const FrameSourceInfo& info, const RgbdCamera& camera, const std::string& sequence_url) {
  if (info.color_width == camera.color.width && info.color_height == camera.color.height) return Status::ok();
  return {ErrorCode::kInvalid, sequence_url + tools::text_of(": images of %dx%d, but --camera is for %dx%d", info.color_width,
                                                             info.color_height, camera.color.width, camera.color.height)};
}

Result<PoseWithCovariance> pose_of(const Localization& localization) {
  if (localization.state == State::kLocalized) return PoseWithCovariance{localization.T_map_camera, localization.covariance};
  return {ErrorCode::kNotFound, std::string("the frame is not localized in the map: ") + to_string(localization.reason)};
}

}  // namespace

Result<Frames> localize_frames(const MapView& map, const RgbdCamera& camera, const std::string& sequence_url,
                               const std::vector<ControlObservation>& observations, const WorkObserver& observer) {
  std::set<std::uint64_t> wanted;
  for (const ControlObservation& observation : observations) {
    if (observation.kind == ObservationKind::kPixel) wanted.insert(observation.frame);
  }
  Frames frames;
  if (wanted.empty()) return frames;
  for (const std::uint64_t frame : wanted) frames[frame];
  auto source = open_frame_source(tools::with_selection(sequence_url, tools::selection_of(wanted, kRunUpFrames)));
  if (!source) return source.status();
  if (const Status status = check_size(source.value()->info(), camera, sequence_url); !status) return status;

  Localizer localizer(map, camera, LocalizerOptions{});
  const DepthLookup lookup(camera);
  std::optional<std::uint64_t> previous;
  const auto localize = [&](FrameBuffer& buffer) {
    if (previous && buffer.sequence != *previous + 1) localizer.reset();
    previous = buffer.sequence;
    const Localization& localization = localizer.process(buffer.view());
    if (const auto found = frames.find(buffer.sequence); found != frames.end()) {
      found->second.T_map_camera = pose_of(localization);
      measure_pixels(observations, camera, lookup, buffer.view(), &found->second.measurements);
    }
    return Status::ok();
  };
  const auto counts = tools::read_frames(*source.value(), localize, observer);
  if (!counts) return counts.status();
  if (observer.should_stop()) return Status(ErrorCode::kIo, "interrupted; nothing was written");
  return frames;
}

}  // namespace camloc::mapping
