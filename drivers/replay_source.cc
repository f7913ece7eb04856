// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/replay_source.h"

#include <filesystem>
#include <system_error>
#include <utility>

#include "core/io/camera_file.h"
#include "core/io/image_file.h"
#include "core/io/sequence.h"
#include "drivers/playback.h"
#include "drivers/raw_pixels.h"

namespace camloc {

namespace {

/// Frames of a recording that were chosen, and what the whole recording measures.
struct Recording {
  std::string folder;
  std::vector<SequenceFrame> frames;
  std::uint64_t num_recorded = 0;  ///< before any selection
  std::int64_t length_ns = 0;      ///< first exposure to one mean interval after the last
  std::vector<std::string> notes;
};

class ReplaySource final : public Playback {
 public:
  ReplaySource(Recording recording, const PlaybackOptions& options, FrameSourceInfo info)
      : Playback(std::move(info), options, recording.folder + ": "), recording_(std::move(recording)) {}

 private:
  [[nodiscard]] Status load(std::size_t position, std::uint64_t round) override {
    const SequenceFrame& source = recording_.frames[position];
    loaded_.sequence = source.index + round * recording_.num_recorded;
    loaded_.stamp_ns = source.stamp_ns + static_cast<std::int64_t>(round) * recording_.length_ns;
    Status status = reader_.read_gray(source.color_path, &loaded_.gray);
    if (status)
      status = check_size(loaded_.gray.width, loaded_.gray.height, info_.color_width, info_.color_height).with_context(source.color_path);
    if (status && options_.wants_color) status = load_color(source.color_path);
    if (source.depth_path.empty()) {
      loaded_.depth.resize(0, 0);
    } else {
      if (status) status = reader_.read_depth(source.depth_path, &loaded_.depth);
      if (status)
        status =
            check_size(loaded_.depth.width, loaded_.depth.height, info_.depth_width, info_.depth_height).with_context(source.depth_path);
    }
    if (status) return status;
    std::error_code ignored;
    if (!std::filesystem::is_directory(recording_.folder, ignored)) {
      return {ErrorCode::kUnavailable, recording_.folder + ": the folder is gone"};
    }
    return {ErrorCode::kCorrupt, "frame " + std::to_string(source.index) + ": " + status.message()};
  }

  Status load_color(const std::string& path) {
    const Result<ColorImage> image = reader_.read_color(path);
    if (!image) return image.status();
    loaded_.color.resize(image->width, image->height);
    rgb_to_bgr(image->pixels, &loaded_.color);
    return Status::ok();
  }

  Recording recording_;
  ImageReader reader_;
};

Result<Recording> select_recording(const SourceUrl& url, const SequenceOptions& options) {
  Result<Sequence> sequence = read_sequence(url.path, options);
  if (!sequence) return sequence.status();
  const std::vector<SequenceFrame>& all = sequence->frames;
  const Result<std::vector<std::size_t>> chosen = chosen_frames(url, all.size());
  if (!chosen) return chosen.status();
  Recording recording{url.path, {}, all.size(), 0, sequence->notes};
  for (const std::size_t index : *chosen) recording.frames.push_back(all[index]);
  const std::int64_t span_ns = all.back().stamp_ns - all.front().stamp_ns;
  recording.length_ns = playback_length_ns(span_ns, all.size(), static_cast<std::int64_t>(1e9 / options.frame_rate_hz));
  return recording;
}

/// Size of the first image that can be read: a recording may begin with a broken one.
Result<ImageSize> first_image_size(const std::vector<SequenceFrame>& frames, std::string SequenceFrame::*path) {
  ImageReader reader;
  Status first_error;
  for (const SequenceFrame& frame : frames) {
    if ((frame.*path).empty()) continue;
    Result<ImageSize> size = reader.read_size(frame.*path);
    if (size) return size;
    if (first_error) first_error = size.status();
  }
  if (first_error) return ImageSize{};
  return first_error;
}

Result<FrameSourceInfo> describe(const Recording& recording) {
  Result<ImageSize> color = first_image_size(recording.frames, &SequenceFrame::color_path);
  if (!color) return color.status();
  FrameSourceInfo info;
  info.color_width = color->width;
  info.color_height = color->height;
  // Depth images that are all broken fail frame by frame, with their names.
  if (Result<ImageSize> depth = first_image_size(recording.frames, &SequenceFrame::depth_path); depth) {
    info.depth_width = depth->width;
    info.depth_height = depth->height;
  }
  info.notes = recording.notes;
  info.num_frames = recording.frames.size();
  info.description = "recording " + recording.folder + ", " + std::to_string(recording.frames.size()) + " of " +
                     std::to_string(recording.num_recorded) + " frames, " + std::to_string(color->width) + "x" +
                     std::to_string(color->height);
  const std::string camera_path = (std::filesystem::path(recording.folder) / "camera.toml").string();
  std::error_code ignored;
  if (std::filesystem::is_regular_file(camera_path, ignored)) {
    Result<RgbdCamera> camera = read_camera_file(camera_path);
    if (!camera) return camera.status();
    info.camera = *camera;
  }
  return info;
}

}  // namespace

Result<std::unique_ptr<FrameSource>> open_replay_source(const SourceUrl& url, const FrameSourceOptions& options) {
  if (Status status = url.check_options({"speed", "loop", "frames", "exclude", "rate_hz", "pair_ms"}); !status) return status;
  if (url.path.empty()) return Status(ErrorCode::kInvalid, url.text + ": no folder; expected replay://DIR");
  OptionReader reader(url);
  const double speed = reader.number("speed", 0, 0, 1000), rate_hz = reader.number("rate_hz", 30, 0.01, 10000);
  const double pair_ms = reader.number("pair_ms", SequenceOptions{}.pair_ms, 0, 1000);
  const PlaybackOptions playback{speed, reader.flag("loop"), options.wants_color};
  if (!reader.status()) return reader.status();
  Result<Recording> recording = select_recording(url, {rate_hz, pair_ms});
  if (!recording) return recording.status();
  Result<FrameSourceInfo> info = describe(*recording);
  if (!info) return info.status();
  return std::unique_ptr<FrameSource>(std::make_unique<ReplaySource>(std::move(recording).value(), playback, std::move(info).value()));
}

}  // namespace camloc
