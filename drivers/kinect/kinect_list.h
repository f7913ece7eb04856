// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Which Kinects are plugged in, by what the kernel says: nothing is opened.
#pragma once

#include "drivers/frame_source.h"
#include "drivers/kinect/kinect_protocol.h"
#include "drivers/usb_devices.h"

namespace camloc {

/// The cameras, then what else is in their housings. The hub of a Kinect for Windows is left to the kernel.
inline constexpr UsbId kKinectUsbIds[] = {
    {kinect::kVendorMicrosoft, kinect::kProductCamera},           {kinect::kVendorMicrosoft, kinect::kProductCameraK4w},
    {kinect::kVendorMicrosoft, kinect::kProductMotor, false},     {kinect::kVendorMicrosoft, kinect::kProductsAudio[0], false},
    {kinect::kVendorMicrosoft, kinect::kProductsAudio[1], false}, {kinect::kVendorMicrosoft, kinect::kProductsAudio[2], false},
    {kinect::kVendorMicrosoft, kinect::kProductsAudio[3], false},
};

/// By serial number: the camera's own or, of a model 1473, that of the audio device in the same housing; else by index.
[[nodiscard]] CameraListing list_kinects(const SystemFolders& folders = {});

}  // namespace camloc
