// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/kinect/kinect_list.h"

#include <algorithm>

namespace camloc {

namespace {

std::string serial_of(const UsbDevice& camera, const std::vector<UsbDevice>& devices) {
  if (!is_placeholder_serial(camera.serial)) return camera.serial;
  const auto& audio = kinect::kProductsAudio;
  for (const UsbDevice& device : devices) {
    const bool is_audio = device.vendor == kinect::kVendorMicrosoft && std::find(audio.begin(), audio.end(), device.product) != audio.end();
    if (is_audio && device.hub() == camera.hub() && !is_placeholder_serial(device.serial)) return device.serial;
  }
  return "";
}

}  // namespace

CameraListing list_kinects(const SystemFolders& folders) {
  const std::vector<UsbDevice> devices = list_usb_devices(folders);
  CameraListing listing{{}, std::to_string(devices.size()) + " USB devices", "", "plug it in and give it power, then 'lsusb -d 045e:'"};
  bool has_parts = false;
  for (const UsbDevice& device : devices) {
    const auto* id =
        std::find_if(std::begin(kKinectUsbIds), std::end(kKinectUsbIds), [&](const UsbId& known) { return known.matches(device); });
    if (id == std::end(kKinectUsbIds)) continue;
    has_parts = has_parts || !id->is_camera;
    if (!id->is_camera) continue;
    const std::string serial = serial_of(device, devices);
    const char* name = device.product == kinect::kProductCameraK4w ? "Kinect for Windows V1" : "Kinect V1";
    listing.cameras.push_back(
        {"kinect://" + (serial.empty() ? std::to_string(listing.cameras.size()) : serial), name, "USB " + device.name, ""});
  }
  if (listing.cameras.empty() && has_parts) {
    listing.problem = "the motor or microphone of a Kinect is there, its camera is not";
    listing.advice = "plug in the Kinect's 12 V power supply, then 'camloc camera list'";
  }
  return listing;
}

}  // namespace camloc
