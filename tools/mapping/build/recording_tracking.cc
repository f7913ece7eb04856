// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The first pass, frame by frame: features and thumbnail, SLAM, log. A resumed pass replays its log through the same SLAM first,
// so that its state is that of a pass which was never interrupted.
#include "tools/mapping/build/recording_tracking.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <algorithm>
#include <filesystem>

#include "core/io/camera_file.h"
#include "drivers/sources.h"
#include "tools/mapping/build/frame_log.h"

namespace camloc::mapping {
namespace {

std::string note_of(const SlamCounts& counts) {
  std::string note = std::to_string(counts.num_keyframes) + " keyframes, " + std::to_string(counts.num_landmarks) + " landmarks";
  if (counts.num_loops > 0) note += ", " + std::to_string(counts.num_loops) + " loops";
  if (counts.num_segments > counts.num_joined + 1) note += ", " + std::to_string(counts.num_segments - counts.num_joined) + " segments";
  if (counts.num_lost > 0) note += ", " + std::to_string(counts.num_lost) + " lost";
  return note;
}

/// A recording on its way through extraction, tracking and the log.
class Pass {
 public:
  Pass(const TrackingRequest& request, Slam* slam, RecordingCheck* check, WorkObserver& observer)
      : request_(request),
        slam_(slam),
        check_(check),
        observer_(observer),
        extractor_(request.camera, request.orb),
        thumbnails_(request.camera) {}

  /// Processes what an earlier pass has seen; says where its log ends.
  Result<std::uint64_t> replay() {
    auto reader = FrameLogReader::open(request_.log_path, recording_identity(request_));
    if (!reader.is_ok()) return reader.status();
    LoggedFrame logged;
    while (!observer_.should_stop() && reader->next(&logged).is_ok()) {
      check_->see_view(logged.frame, logged.view.stamp_ns, logged.view.size(), num_with_depth(logged.view));
      track(logged);
      last_frame_ = logged.frame;
      ++end_.num_resumed;
    }
    end_.is_interrupted = observer_.should_stop();
    return reader->size_bytes();
  }

  Status run(FrameLogWriter log) {
    auto source = open_frame_source(request_.url);
    if (!source.is_ok()) return source.status();
    auto counts = tools::read_frames(
        *source.value(),
        [&](FrameBuffer& frame) {
          const bool is_known = end_.num_resumed > 0 && frame.sequence <= last_frame_;
          return is_known ? Status::ok() : process(frame.view(), &log);
        },
        observer_);
    if (!counts.is_ok()) return counts.status();
    end_.reading = std::move(counts).value();
    end_.is_interrupted = observer_.should_stop();
    return log.flush();
  }

  [[nodiscard]] bool is_interrupted() const { return end_.is_interrupted; }
  [[nodiscard]] RecordingEnd end() { return std::move(end_); }

 private:
  static std::size_t num_with_depth(const FrameFeatures& view) {
    return static_cast<std::size_t>(std::count_if(view.depth_m.begin(), view.depth_m.end(), [](float z) { return z > 0; }));
  }

  Status process(const Frame& frame, FrameLogWriter* log) {
    if (frame.depth.empty()) {
      ++num_done_;
      ++end_.num_without_depth;
      return Status::ok();
    }
    if (const Status checked = extractor_.check(frame); !checked.is_ok()) return checked;
    LoggedFrame logged{frame.sequence, extractor_.extract_with_patches(frame), thumbnails_.make(frame),
                       sample_surface(request_.camera, frame.depth)};
    check_->see_frame(frame, logged.view.size(), num_with_depth(logged.view));
    if (const Status usable = check_->early_verdict(); !usable.is_ok()) return usable;
    if (!track(logged)) logged.view.patches.clear();  // only those of keyframes are asked for again
    return log->add(logged);
  }

  /// Whether the frame has become a keyframe.
  bool track(const LoggedFrame& logged) {
    const FrameReport report = slam_->add_view(logged.frame, logged.view, logged.thumbnail);
    check_->see_report(report);
    if (report.is_keyframe) end_.surfaces.push_back({logged.frame, logged.surface_m});
    observer_.show("frame", ++num_done_, request_.num_frames, note_of(slam_->counts()));
    return report.is_keyframe;
  }

  const TrackingRequest& request_;
  Slam* slam_;
  RecordingCheck* check_;
  WorkObserver& observer_;
  FrameExtractor extractor_;
  ThumbnailMaker thumbnails_;
  RecordingEnd end_;
  std::uint64_t num_done_ = 0, last_frame_ = 0;
};

}  // namespace

std::vector<Eigen::Vector3f> sample_surface(const RgbdCamera& camera, ImageView<std::uint16_t> depth) {
  constexpr int kColumns = 20, kRows = 15;
  std::vector<Eigen::Vector3f> points;
  for (int row = 0; row < kRows; ++row) {
    for (int column = 0; column < kColumns; ++column) {
      const int x = (2 * column + 1) * depth.width / (2 * kColumns), y = (2 * row + 1) * depth.height / (2 * kRows);
      const double z = camera.depth_m(depth.at(x, y));
      if (z <= 0) continue;
      const Eigen::Vector2d ray = camera.depth.undistort({x, y});
      points.push_back((camera.T_color_depth * Eigen::Vector3d(z * ray.x(), z * ray.y(), z)).cast<float>());
    }
  }
  return points;
}

std::uint64_t recording_identity(const TrackingRequest& request) {
  const std::string text = request.url + "\n" + format_camera_toml(request.camera) + "\n" + std::to_string(request.orb.num_features);
  return XXH3_64bits(text.data(), text.size());
}

Result<RecordingEnd> track_recording(const TrackingRequest& request, Slam* slam, RecordingCheck* check, WorkObserver& observer) {
  Pass pass(request, slam, check, observer);
  const Result<std::uint64_t> log_bytes = request.is_resumed ? pass.replay() : 0;
  if (!log_bytes.is_ok()) return log_bytes.status();
  if (pass.is_interrupted()) return pass.end();  // the rest of the log is for the next time
  auto log = request.is_resumed ? FrameLogWriter::append(request.log_path, *log_bytes)
                                : FrameLogWriter::create(request.log_path, recording_identity(request));
  if (!log.is_ok()) return log.status();
  if (const Status done = pass.run(std::move(log).value()); !done.is_ok()) {
    // What is wrong with the recording stays wrong; a full disk does not.
    if (done.code() == ErrorCode::kInvalid || slam->counts().num_views == 0) std::filesystem::remove(request.log_path);
    return done;
  }
  return pass.end();
}

}  // namespace camloc::mapping
