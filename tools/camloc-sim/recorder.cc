// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/camloc-sim/recorder.h"

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <filesystem>
#include <mutex>
#include <thread>
#include <vector>

#include "core/io/file_bytes.h"
#include "core/io/image_writer.h"
#include "core/io/sequence.h"

namespace camloc::sim {
namespace {

std::string stamp_text(std::int64_t stamp_ns) {
  char text[40];
  std::snprintf(text, sizeof text, "%lld.%06lld", static_cast<long long>(stamp_ns / 1000000000),
                static_cast<long long>(stamp_ns % 1000000000 / 1000));
  return text;
}

/// Runs work(worker, index) for all indices below count on `num_jobs` threads; stops early when one returns an error.
template <typename MakeWorker>
Status parallel_for(int num_jobs, int count, MakeWorker make_worker) {
  std::atomic<int> next{0};
  std::mutex mutex;
  Status failure;
  const auto loop = [&] {
    auto work = make_worker();
    for (int i = next++; i < count; i = next++) {
      Status status = work(i);
      if (status) continue;
      const std::lock_guard lock(mutex);
      if (failure) failure = std::move(status);
      next = count;
    }
  };
  std::vector<std::thread> threads;
  for (int k = 1; k < std::min(num_jobs, count); ++k) threads.emplace_back(loop);
  loop();
  for (std::thread& thread : threads) thread.join();
  return failure;
}

struct Timeline {
  std::int64_t start_ns, interval_ns;
  int num_frames;
  [[nodiscard]] double time_s(int index) const { return 1e-9 * static_cast<double>(index * interval_ns); }
  [[nodiscard]] std::int64_t stamp_ns(int index) const { return start_ns + index * interval_ns; }
};

Timeline timeline(const World& world, const RecordingOptions& options) {
  // Whole microseconds, because that is what the index files hold.
  const auto interval_ns = static_cast<std::int64_t>(1e6 / options.rate_hz + 0.5) * 1000;
  const double duration_ns = 1e9 * world.trajectory.duration_s() * options.duration_scale;
  return {options.start_ns, interval_ns, 1 + static_cast<int>(duration_ns / static_cast<double>(interval_ns))};
}

Status write_frame(const FrameBuffer& frame, const RecordingOptions& options, const std::string& folder, const std::string& name) {
  Status status = options.jpeg_quality > 0 ? write_jpeg(folder + "/rgb/" + name + ".jpg", frame.gray, options.jpeg_quality)
                                           : write_png(folder + "/rgb/" + name + ".png", frame.gray);
  return status ? write_depth_png(folder + "/depth/" + name + ".png", frame.depth) : status;
}

Status write_index(const World& world, const Timeline& times, const RecordingOptions& options, const std::string& folder) {
  const std::string extension = options.jpeg_quality > 0 ? ".jpg" : ".png";
  std::string rgb = "# color images\n# timestamp filename\n", depth = "# depth maps, 5000 units per metre\n# timestamp filename\n";
  std::string truth = "# ground truth: T_world_camera of the colour camera\n# timestamp tx ty tz qx qy qz qw\n";
  for (int i = 0; i < times.num_frames; ++i) {
    const std::string stamp = stamp_text(times.stamp_ns(i));
    rgb += stamp + " rgb/" + stamp + extension + "\n";
    depth += stamp + " depth/" + stamp + ".png\n";
    std::string line = format_tum_line(times.stamp_ns(i), world.trajectory.pose(times.time_s(i)));
    if (line.empty() || line.back() != '\n') line += '\n';
    truth += line;
  }
  if (Status status = replace_file(folder + "/rgb.txt", rgb); !status) return status;
  if (Status status = replace_file(folder + "/depth.txt", depth); !status) return status;
  return replace_file(folder + "/groundtruth.txt", truth);
}

}  // namespace

Result<int> record(const World& world, const RgbdCamera& camera, const RecordingOptions& options, const std::string& folder,
                   const Progress& progress) {
  std::error_code error;
  for (const char* part : {"/rgb", "/depth"}) {
    std::filesystem::create_directories(folder + part, error);
    if (error) return {ErrorCode::kIo, folder + part + ": cannot create: " + error.message()};
  }
  const Timeline times = timeline(world, options);
  const auto count = static_cast<std::size_t>(times.num_frames);
  std::vector<float> tones(count);
  Status status = parallel_for(options.num_jobs, times.num_frames, [&] {
    return [&, maker = FrameMaker(world, camera, options.frames)](int i) mutable {
      tones[static_cast<std::size_t>(i)] = maker.meter(times.time_s(i));
      return Status::ok();
    };
  });
  const std::vector<Exposure> exposures = auto_expose(tones, 1e-9 * static_cast<double>(times.interval_ns));
  int num_done = 0;
  std::mutex progress_mutex;
  status = parallel_for(options.num_jobs, times.num_frames, [&] {
    return [&, maker = FrameMaker(world, camera, options.frames), frame = FrameBuffer()](int i) mutable {
      maker.make(times.time_s(i), static_cast<std::uint32_t>(i), exposures[static_cast<std::size_t>(i)], &frame);
      Status written = write_frame(frame, options, folder, stamp_text(times.stamp_ns(i)));
      const std::lock_guard lock(progress_mutex);
      if (written && progress) progress(++num_done, times.num_frames);
      return written;
    };
  });
  if (status) status = write_index(world, times, options, folder);
  if (!status) return status;
  return times.num_frames;
}

}  // namespace camloc::sim
