// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The frames of a walk, made side by side and written.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <mutex>
#include <thread>
#include <vector>

#include "core/io/file_bytes.h"
#include "core/io/image_writer.h"
#include "core/io/sequence.h"
#include "tools/camloc-sim/dataset.h"
#include "tools/camloc-sim/noise.h"
#include "tools/camloc-sim/sensors.h"

namespace camloc::sim {
namespace {

std::string stamp_text(std::int64_t stamp_ns) {
  char text[40];
  std::snprintf(text, sizeof text, "%lld.%06lld", static_cast<long long>(stamp_ns / 1000000000),
                static_cast<long long>(stamp_ns % 1000000000 / 1000));
  return text;
}

/// A sixteenth of the pixels in each direction is plenty for a mean.
Intrinsics meter_intrinsics(const Intrinsics& full) {
  constexpr int kReduction = 10;
  return {full.width / kReduction, full.height / kReduction,           full.fx / kReduction,
          full.fy / kReduction,    (full.cx + 0.5) / kReduction - 0.5, (full.cy + 0.5) / kReduction - 0.5};
}

/// One camera on one walk through one scene: the frame at any time, alone, independent of the frames before it.
/// Not thread-safe: one per thread. The world must outlive it.
class FrameMaker {
 public:
  FrameMaker(const World& world, bool is_perfect)
      : world_(world),
        is_perfect_(is_perfect),
        renderer_(world.scene, simulated_camera().color),
        meter_(world.scene, meter_intrinsics(simulated_camera().color)),
        color_sensor_(simulated_camera().color),
        depth_sensor_(simulated_camera().color, is_perfect) {}

  /// Mean tone a light meter sees at that time.
  [[nodiscard]] float meter(double time_s) {
    const std::vector<Surface> people = people_at(world_, time_s);
    const Rendering& small = meter_.render(world_.trajectory.pose(time_s), people);
    double sum = 0;
    for (const float radiance : small.radiance.pixels) sum += std::min(1.0F, std::sqrt(radiance));
    return static_cast<float>(sum / static_cast<double>(small.radiance.pixels.size())) * std::sqrt(light_drift(time_s));
  }
  /// The frame exposed around `time_s`; `index` seeds its noise. Fills gray and depth only.
  void make(double time_s, std::uint32_t index, Exposure exposure, FrameBuffer* frame) {
    const std::vector<Surface> people = people_at(world_, time_s);
    const Rendering& rendering = renderer_.render(world_.trajectory.pose(time_s), people);
    const std::uint32_t seed = hash32(world_.options.seed, world_.options.day * 1000000U + index, 5000);
    exposure.gain *= light_drift(time_s);
    color_sensor_.expose(rendering, world_.trajectory.twist(time_s), exposure, seed, is_perfect_, &frame->gray);
    depth_sensor_.measure(rendering, renderer_, seed, &frame->depth);
  }

 private:
  [[nodiscard]] float light_drift(double time_s) const {
    const auto seed = hash32(world_.options.seed, world_.options.day, 4000);
    const float t = static_cast<float>(time_s);
    return 1.0F + 0.15F * value_noise(t / 9.0F, 0.5F, seed) + 0.04F * value_noise(t / 1.5F, 0.5F, seed + 1);
  }

  const World& world_;
  bool is_perfect_;
  Renderer renderer_, meter_;
  ColorSensor color_sensor_;
  DepthSensor depth_sensor_;
};

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
    truth += format_tum_line(times.stamp_ns(i), world.trajectory.pose(times.time_s(i))) + "\n";
  }
  if (Status status = replace_file(folder + "/rgb.txt", rgb); !status) return status;
  if (Status status = replace_file(folder + "/depth.txt", depth); !status) return status;
  return replace_file(folder + "/groundtruth.txt", truth);
}

}  // namespace

Result<int> record(const World& world, const RecordingOptions& options, const std::string& folder, const Progress& progress) {
  std::error_code error;
  for (const char* part : {"/rgb", "/depth"}) {
    std::filesystem::create_directories(folder + part, error);
    if (error) return {ErrorCode::kIo, folder + part + ": cannot create: " + error.message()};
  }
  const Timeline times = timeline(world, options);
  const auto count = static_cast<std::size_t>(times.num_frames);
  std::vector<float> tones(count);
  Status status = parallel_for(options.num_jobs, times.num_frames, [&] {
    return [&, maker = FrameMaker(world, options.is_perfect)](int i) mutable {
      tones[static_cast<std::size_t>(i)] = maker.meter(times.time_s(i));
      return Status::ok();
    };
  });
  const std::vector<Exposure> exposures = auto_expose(tones, 1e-9 * static_cast<double>(times.interval_ns));
  int num_done = 0;
  std::mutex progress_mutex;
  status = parallel_for(options.num_jobs, times.num_frames, [&] {
    return [&, maker = FrameMaker(world, options.is_perfect), frame = FrameBuffer()](int i) mutable {
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
