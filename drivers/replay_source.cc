// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// See replay_source.h. A frame is decoded before its time has come and then released on time, so that decoding does not
// delay it.
#include "drivers/replay_source.h"

#include <filesystem>
#include <system_error>
#include <utility>

#include "core/io/camera_file.h"
#include "core/io/image_file.h"
#include "core/io/sequence.h"
#include "drivers/pacer.h"

namespace camloc {

namespace {

struct ReplayOptions {
  double speed = 0;  ///< times the recorded rate; 0 = as fast as possible
  bool loop = false;
  bool wants_color = false;
};

/// Frames of a recording that were chosen, and what the whole recording measures.
struct Recording {
  std::string folder;
  std::vector<SequenceFrame> frames;
  std::uint64_t num_recorded = 0;  ///< before any selection
  std::int64_t length_ns = 0;      ///< first exposure to one mean interval after the last
};

class ReplaySource final : public FrameSource {
 public:
  ReplaySource(Recording recording, ReplayOptions options, FrameSourceInfo info)
      : recording_(std::move(recording)), options_(options), info_(std::move(info)), pacer_(options.speed) {}

  [[nodiscard]] const FrameSourceInfo& info() const override { return info_; }

  [[nodiscard]] Status next(FrameBuffer* frame, std::chrono::milliseconds timeout) override {
    if (position_ == recording_.frames.size()) {
      if (!options_.loop) return {ErrorCode::kEnd, recording_.folder + ": the recording is over"};
      position_ = 0;
      ++round_;
    }
    if (!is_loaded_) {
      load_status_ = load(recording_.frames[position_]);
      if (load_status_.code() == ErrorCode::kUnavailable) return load_status_;
      is_loaded_ = true;
    }
    if (!pacer_.wait_for(loaded_.stamp_ns, timeout)) return {ErrorCode::kTimeout, recording_.folder + ": the next frame is not due yet"};
    is_loaded_ = false;
    ++position_;
    if (load_status_) std::swap(*frame, loaded_);
    return load_status_;
  }

 private:
  Status load(const SequenceFrame& source) {
    loaded_.sequence = source.index + round_ * recording_.num_recorded;
    loaded_.stamp_ns = source.stamp_ns + static_cast<std::int64_t>(round_) * recording_.length_ns;
    Status status = reader_.read_gray(source.color_path, &loaded_.gray);
    if (status) status = check_size(source.color_path, loaded_.gray.width, loaded_.gray.height, info_.color_width, info_.color_height);
    if (status && options_.wants_color) status = load_color(source.color_path);
    if (source.depth_path.empty()) {
      loaded_.depth.resize(0, 0);
    } else {
      if (status) status = reader_.read_depth(source.depth_path, &loaded_.depth);
      if (status) status = check_size(source.depth_path, loaded_.depth.width, loaded_.depth.height, info_.depth_width, info_.depth_height);
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
    const std::uint8_t* rgb = image->pixels.data();
    for (Bgr& pixel : loaded_.color.pixels) {
      pixel = {rgb[2], rgb[1], rgb[0]};
      rgb += 3;
    }
    return Status::ok();
  }

  static Status check_size(const std::string& path, int width, int height, int expected_width, int expected_height) {
    if (width == expected_width && height == expected_height) return Status::ok();
    return {ErrorCode::kCorrupt, path + ": " + std::to_string(width) + "x" + std::to_string(height) + " pixels, the recording has " +
                                     std::to_string(expected_width) + "x" + std::to_string(expected_height)};
  }

  Recording recording_;
  ReplayOptions options_;
  FrameSourceInfo info_;
  Pacer pacer_;
  ImageReader reader_;
  FrameBuffer loaded_;  // decoded, waiting for its time
  Status load_status_;
  bool is_loaded_ = false;
  std::size_t position_ = 0;
  std::uint64_t round_ = 0;
};

Result<Recording> select_recording(const SourceUrl& url, double rate_hz) {
  Result<Sequence> sequence = read_sequence(url.path, rate_hz);
  if (!sequence) return sequence.status();
  const std::vector<SequenceFrame>& all = sequence->frames;
  Result<std::vector<std::size_t>> chosen = select_frames(url.text_option("frames", ""), url.text_option("exclude", ""), all.size());
  if (!chosen) return chosen.status().with_context(url.path);
  if (chosen->empty()) {
    return Status(ErrorCode::kInvalid, url.text + ": the selection leaves none of " + std::to_string(all.size()) + " frames");
  }
  Recording recording{url.path, {}, all.size(), 0};
  for (const std::size_t index : *chosen) recording.frames.push_back(all[index]);
  const std::int64_t span_ns = all.back().stamp_ns - all.front().stamp_ns;
  const auto num_gaps = static_cast<std::int64_t>(all.size()) - 1;
  recording.length_ns = num_gaps > 0 ? span_ns + span_ns / num_gaps : static_cast<std::int64_t>(1e9 / rate_hz);
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
  if (Status status = url.check_options({"speed", "loop", "frames", "exclude", "rate_hz"}); !status) return status;
  if (url.path.empty()) return Status(ErrorCode::kInvalid, url.text + ": no folder; expected replay://DIR");
  const Result<double> speed = url.number_option("speed", 0, 0, 1000);
  if (!speed) return speed.status();
  const Result<double> rate_hz = url.number_option("rate_hz", 30, 0.01, 10000);
  if (!rate_hz) return rate_hz.status();
  const std::string loop = url.text_option("loop", "0");
  if (loop != "0" && loop != "1") return Status(ErrorCode::kInvalid, url.text + ": option loop=" + loop + ": expected 0 or 1");
  Result<Recording> recording = select_recording(url, *rate_hz);
  if (!recording) return recording.status();
  Result<FrameSourceInfo> info = describe(*recording);
  if (!info) return info.status();
  return std::unique_ptr<FrameSource>(std::make_unique<ReplaySource>(
      std::move(recording).value(), ReplayOptions{*speed, loop == "1", options.wants_color}, std::move(info).value()));
}

}  // namespace camloc
