// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/camloc-map/frame_localization.h"

#include <algorithm>
#include <chrono>
#include <optional>
#include <set>

#include "core/localize/localizer.h"
#include "drivers/frame_source.h"

namespace camloc::map_tool {
namespace {

constexpr std::uint64_t kRunUpFrames = 10;

using Frames = std::map<std::uint64_t, LocalizedFrame>;

/// "start:stop" of every frame with its run-up.
std::string selection_of(const Frames& frames) {
  std::string text;
  for (const auto& [index, frame] : frames) {
    if (!text.empty()) text += ",";
    text += std::to_string(index - std::min(index, kRunUpFrames)) + ":" + std::to_string(index + 1);
  }
  return text;
}

Status check_size(const FrameSourceInfo& info, const RgbdCamera& camera, const std::string& sequence_url) {
  if (info.color_width == camera.color.width && info.color_height == camera.color.height) return Status::ok();
  return {ErrorCode::kInvalid, sequence_url + ": images of " + std::to_string(info.color_width) + "x" + std::to_string(info.color_height) +
                                   ", but --camera is for " + std::to_string(camera.color.width) + "x" + std::to_string(camera.color.height)};
}

Result<PoseWithCovariance> pose_of(const Localization& localization) {
  if (localization.state == State::kLocalized) return PoseWithCovariance{localization.T_map_camera, localization.covariance};
  return {ErrorCode::kNotFound, std::string("the frame is not localized in the map: ") + to_string(localization.reason)};
}

}  // namespace

Result<Frames> localize_frames(const MapView& map, const RgbdCamera& camera, const std::string& sequence_url,
                               const std::vector<ControlObservation>& observations, const std::function<bool()>& should_stop) {
  Frames frames;
  for (const ControlObservation& observation : observations) {
    if (observation.kind == ObservationKind::kPixel) frames[observation.frame];
  }
  if (frames.empty()) return frames;
  const std::string separator = sequence_url.find('?') == std::string::npos ? "?" : "&";
  auto source = open_frame_source(sequence_url + separator + "frames=" + selection_of(frames));
  if (!source) return source.status();
  if (const Status status = check_size(source.value()->info(), camera, sequence_url); !status) return status;

  Localizer localizer(map, camera, LocalizerOptions{});
  const DepthLookup lookup(camera);
  FrameBuffer buffer;
  std::optional<std::uint64_t> previous;
  while (!should_stop()) {
    const Status status = source.value()->next(&buffer, std::chrono::milliseconds(1000));
    if (status.code() == ErrorCode::kEnd) return frames;
    if (status.code() == ErrorCode::kTimeout) continue;
    if (status.code() == ErrorCode::kCorrupt) {
      const auto found = frames.find(buffer.sequence);
      if (found != frames.end()) found->second.T_map_camera = status;
      continue;
    }
    if (!status) return status;
    if (previous && buffer.sequence != *previous + 1) localizer.reset();
    previous = buffer.sequence;
    const Localization& localization = localizer.process(buffer.view());
    const auto found = frames.find(buffer.sequence);
    if (found == frames.end()) continue;
    found->second.T_map_camera = pose_of(localization);
    measure_pixels(observations, camera, lookup, buffer.view(), &found->second.measurements);
  }
  return Status(ErrorCode::kIo, "interrupted; nothing was written");
}

}  // namespace camloc::map_tool
