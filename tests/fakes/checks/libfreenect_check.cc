// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Streams from a Kinect with libfreenect, a program that knows nothing of our fake, and checks every frame bit for bit against the
// fake's log of what it sent. Reports rate, CPU time and allocations, the yardstick for our own driver.
//
//   umockdev-wrapper fake-kinect --log LOG -- fake_kinect_check --log LOG [--seconds 5] [--streams depth,video]
//
// Exit codes: 0 all frames right and at least --min-hz of each stream, 1 not, 2 usage.
#include <libfreenect.h>
#include <libfreenect_registration.h>
#include <sys/time.h>
#include <xxhash.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

#include "tests/fakes/checks/stream_check.h"
#include "tests/fakes/kinect_frames.h"

namespace {

using namespace camloc::fakes;

struct Recorder {
  std::vector<ReceivedFrame> video, depth;
  std::vector<std::uint8_t> packed;  // scratch
};

Recorder& recorder_of(freenect_device* device) { return *static_cast<Recorder*>(freenect_get_user(device)); }

void on_video(freenect_device* device, void* bytes, std::uint32_t stamp) {
  recorder_of(device).video.push_back({stamp, XXH3_64bits(bytes, kColorBytes)});
}

/// libfreenect unpacks 11 bits into 16; packing them again must give the bytes that were sent.
void on_depth(freenect_device* device, void* bytes, std::uint32_t stamp) {
  Recorder& recorder = recorder_of(device);
  const auto* const values = static_cast<const std::uint16_t*>(bytes);
  std::size_t at = 0;
  std::uint32_t pending = 0;
  int num_pending = 0;
  for (std::size_t i = 0; i < kColorBytes; ++i) {
    pending = pending << 11 | values[i];
    for (num_pending += 11; num_pending >= 8; num_pending -= 8)
      recorder.packed[at++] = static_cast<std::uint8_t>(pending >> (num_pending - 8));
  }
  recorder.depth.push_back({stamp, XXH3_64bits(recorder.packed.data(), recorder.packed.size())});
}

/// The depth-to-colour table that libfreenect makes of the device's registration block, against the two pinhole cameras it was made of.
bool check_registration(freenect_device* device) {
  const KinectCalibration truth;
  freenect_registration table = freenect_copy_registration(device);
  constexpr double kScale = 256, kToNearest = 0.5;
  constexpr double kBaselineMm = 24;  // libfreenect takes 2.4 cm, whatever the device says
  double worst_px = 0;
  for (const double z_mm : {700.0, 1200.0, 3000.0}) {
    for (int y = 60; y < kKinectHeight; y += 60) {
      for (int x = 80; x < kKinectWidth; x += 80) {
        const double slope = truth.color_focal_px / truth.depth_focal_px;
        const double at_infinity_px = 10 * static_cast<double>(truth.color_cm) / (20 * static_cast<double>(truth.pixel_cm));
        const double added_px =
            kBaselineMm / (20 * static_cast<double>(truth.pixel_cm)) * (1 - 10 * static_cast<double>(truth.reference_cm) / z_mm);
        const double expected_x = (x - 320) * slope + 320 - at_infinity_px + added_px, expected_y = (y - 240) * slope + 240;
        const std::int32_t* const entry = table.registration_table[y * kKinectWidth + x];
        const double got_x = (entry[0] + table.depth_to_rgb_shift[static_cast<int>(z_mm)]) / kScale - kToNearest;
        if (expected_x < 1 || expected_x > 638 || expected_y < 1 || expected_y > 478) continue;
        worst_px = std::max({worst_px, std::abs(got_x - expected_x), std::abs(entry[1] - expected_y)});
      }
    }
  }
  double worst_mm = 0;
  for (int raw = 400; raw < 1000; ++raw) worst_mm = std::max(worst_mm, std::abs(table.raw_to_mm_shift[raw] - disparity_to_mm(truth, raw)));
  freenect_destroy_registration(&table);
  std::printf("registration: libfreenect is at most %.2f px from the two pinhole cameras, and %.2f mm from our depth\n", worst_px,
              worst_mm);
  return worst_px < 0.6 && worst_mm <= 1;  // rows are whole pixels there, millimetres too
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Streams from a Kinect with libfreenect and checks every frame.", "fake_kinect_check");
  std::string log_file, streams = "depth,video";
  double seconds = 5, min_hz = 1;
  bool wants_registration = false;
  app.add_option("--log", log_file, "The fake's log")->required();
  app.add_option("--seconds", seconds, "How long")->capture_default_str();
  app.add_option("--streams", streams, "depth, video or depth,video")->capture_default_str();
  app.add_option("--min-hz", min_hz, "Fail below this rate")->capture_default_str();
  app.add_flag("--registration", wants_registration, "Also check depth and registration tables (default geometry)");
  CLI11_PARSE(app, argc, argv);
  const bool wants_depth = streams.find("depth") != std::string::npos, wants_video = streams.find("video") != std::string::npos;

  freenect_context* context = nullptr;
  freenect_device* device = nullptr;
  if (freenect_init(&context, nullptr) < 0) return 1;
  freenect_set_log_level(context, FREENECT_LOG_WARNING);
  freenect_select_subdevices(context, FREENECT_DEVICE_CAMERA);
  if (freenect_open_device(context, &device, 0) < 0) {
    std::fprintf(stderr, "fake_kinect_check: libfreenect opens no Kinect\n");
    return 1;
  }
  Recorder recorder;
  recorder.packed.resize(kDepthBytes);
  for (auto* const frames : {&recorder.video, &recorder.depth}) frames->reserve(static_cast<std::size_t>(seconds * 40) + 100);
  freenect_set_user(device, &recorder);
  freenect_set_video_callback(device, on_video);
  freenect_set_depth_callback(device, on_depth);
  freenect_set_video_mode(device, freenect_find_video_mode(FREENECT_RESOLUTION_MEDIUM, FREENECT_VIDEO_BAYER));
  freenect_set_depth_mode(device, freenect_find_depth_mode(FREENECT_RESOLUTION_MEDIUM, FREENECT_DEPTH_11BIT));
  const bool is_registered = !wants_registration || check_registration(device);

  if (wants_depth && freenect_start_depth(device) < 0) return 1;
  if (wants_video && freenect_start_video(device) < 0) return 1;
  StreamCost cost(seconds);
  while (cost.goes_on()) {
    timeval timeout{0, 100'000};
    if (freenect_process_events_timeout(context, &timeout) < 0) break;
  }
  cost.print("libfreenect");
  if (wants_depth) freenect_stop_depth(device);
  if (wants_video) freenect_stop_video(device);
  freenect_close_device(device);
  freenect_shutdown(context);

  const bool depth_ok = !wants_depth || report_stream("depth", recorder.depth, log_file, cost.streamed_s(), min_hz);
  const bool video_ok = !wants_video || report_stream("video", recorder.video, log_file, cost.streamed_s(), min_hz);
  return depth_ok && video_ok && is_registered ? 0 : 1;
}
