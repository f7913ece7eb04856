// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// openni2_recorder FILE LOSSY: records all streams of the first device with OpenNI2's own recorder, until a quiet second.
// A program of its own because the recorder now and then hangs when it is closed (seen once in some twenty runs).
#include <OniCAPI.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <vector>

namespace {

int fail(const char* what) {
  std::fprintf(stderr, "openni2_recorder: %s: %s\n", what, oniGetExtendedError());
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  ::alarm(60);
  OniDeviceInfo* list = nullptr;
  int count = 0;
  OniDeviceHandle device = nullptr;
  if (oniInitialize(ONI_API_VERSION) != ONI_STATUS_OK || oniGetDeviceList(&list, &count) != ONI_STATUS_OK || count == 0)
    return fail("no device");
  if (oniDeviceOpen(list[0].uri, &device) != ONI_STATUS_OK) return fail("cannot open");
  OniRecorderHandle recorder = nullptr;
  if (oniCreateRecorder(argv[1], &recorder) != ONI_STATUS_OK) return fail("cannot record");
  std::vector<OniStreamHandle> streams;
  for (const OniSensorType sensor : {ONI_SENSOR_COLOR, ONI_SENSOR_DEPTH, ONI_SENSOR_IR}) {
    OniStreamHandle stream = nullptr;
    if (oniDeviceGetSensorInfo(device, sensor) == nullptr || oniDeviceCreateStream(device, sensor, &stream) != ONI_STATUS_OK) continue;
    streams.push_back(stream);
    if (oniRecorderAttachStream(recorder, stream, std::strcmp(argv[2], "1") == 0 ? TRUE : FALSE) != ONI_STATUS_OK)
      return fail("cannot attach");
  }
  if (oniRecorderStart(recorder) != ONI_STATUS_OK) return fail("cannot start");
  ::usleep(300'000);  // its thread starts later than it says
  for (OniStreamHandle stream : streams) oniStreamStart(stream);
  int index = 0;
  OniFrame* frame = nullptr;
  while (oniWaitForAnyStream(streams.data(), static_cast<int>(streams.size()), &index, 1000) == ONI_STATUS_OK) {
    if (oniStreamReadFrame(streams[static_cast<std::size_t>(index)], &frame) == ONI_STATUS_OK) oniFrameRelease(frame);
  }
  for (OniStreamHandle stream : streams) oniStreamStop(stream);
  oniRecorderStop(recorder);
  oniRecorderDestroy(&recorder);
  for (OniStreamHandle stream : streams) oniStreamDestroy(stream);
  oniDeviceClose(device);
  oniReleaseDeviceList(list);
  oniShutdown();
  return 0;
}
