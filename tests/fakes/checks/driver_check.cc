// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Streams from a Kinect with our own driver, the layer below kinect://, and checks every raw frame bit for bit against the fake's log
// of what it sent. Does what libfreenect_check.cc does, so that the two stand side by side.
//
//   umockdev-wrapper fake-kinect --log LOG -- kinect_driver_check --log LOG [--seconds 5] [--min-hz 1]
//
// Exit codes: 0 all frames right and at least --min-hz of each stream, 1 not, 2 usage.
#include <xxhash.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <string>
#include <vector>

#include "drivers/kinect/kinect_control.h"
#include "drivers/kinect/kinect_device.h"
#include "drivers/kinect/kinect_receiver.h"
#include "tests/fakes/checks/stream_check.h"

namespace {

using namespace camloc;
using namespace camloc::fakes;
using kinect::KinectReceiver;
using kinect::RawFrame;
using kinect::Stream;

int fail(const Status& status) {
  std::fprintf(stderr, "kinect_driver_check: %s\n", status.message().c_str());
  return 1;
}

void take_all(KinectReceiver* receiver, Stream stream, std::vector<ReceivedFrame>* frames) {
  while (RawFrame* const frame = receiver->take(stream)) {
    frames->push_back({frame->device_stamp, XXH3_64bits(frame->bytes.data(), frame->bytes.size())});
    receiver->release(stream, frame);
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Streams from a Kinect with camloc's driver and checks every frame.", "kinect_driver_check");
  std::string log_file;
  double seconds = 5, min_hz = 1;
  app.add_option("--log", log_file, "The fake's log")->required();
  app.add_option("--seconds", seconds, "How long")->capture_default_str();
  app.add_option("--min-hz", min_hz, "Fail below this rate")->capture_default_str();
  CLI11_PARSE(app, argc, argv);

  KinectReceiver receiver;
  auto device = kinect::KinectDevice::open("", &receiver);
  if (!device) return fail(device.status());
  kinect::KinectControl control(device->get());
  if (const Status status = (*device)->start_transfers(true); !status) return fail(status);
  if (const Status status = control.start_depth(); !status) return fail(status);
  if (const Status status = control.start_color(); !status) return fail(status);

  std::vector<ReceivedFrame> video, depth;
  for (auto* const frames : {&video, &depth}) frames->reserve(static_cast<std::size_t>(seconds * 40) + 100);
  StreamCost cost(seconds);
  while (cost.goes_on()) {
    receiver.wait_until(std::chrono::steady_clock::now() + std::chrono::milliseconds(100));
    take_all(&receiver, Stream::kColor, &video);
    take_all(&receiver, Stream::kDepth, &depth);
  }
  cost.print("camloc");
  const bool is_stopped = control.stop_color().is_ok() && control.stop_depth().is_ok();
  (*device)->stop_transfers();

  const bool depth_ok = report_stream("depth", depth, log_file, cost.streamed_s(), min_hz);
  const bool video_ok = report_stream("video", video, log_file, cost.streamed_s(), min_hz);
  return is_stopped && depth_ok && video_ok ? 0 : 1;
}
