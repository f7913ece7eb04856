// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What goes over the wire between a Kinect V1 and its host: numbers and byte layouts, no transfer. Words are little-endian.
//
// Sources, all public:
//  [OK]    OpenKinect wiki, "Protocol Documentation" and "USB Devices" (openkinect.org)
//  [FN]    libfreenect 0.5, the public headers libfreenect.h and libfreenect_registration.h, and its use of the device
//  [GSPCA] Linux, drivers/media/usb/gspca/kinect.c
//  [PS]    OpenNI2, driver PS1080 (the same chip): status words of replies
//  [1473]  published USB captures of exposure control of model 1473 (command 0x96)
//
// CONTROL  vendor requests on endpoint 0: OUT (0x40, request 0) carries "GM" | words of body | command | tag | body; IN (0xc0,
// request 0) is polled until it carries "RB" | words of body | command | tag | body with the request's tag [OK, GSPCA].
// STREAMS  isochronous packets: a header of 12 bytes, "RB" | 0 | flag | 0 | sequence | 0 | 0 | stamp (32 bit), then payload. The
// flag is the stream's base + 1 in the first packet of a frame, + 2 in those between, + 5 in the last; the sequence number counts
// the packets of a stream, modulo 256 [OK]. The stamp counts 60 MHz [FN].
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace camloc::kinect {

// ---- USB identities [OK, "USB Devices"; FN for K4W and 1473]
inline constexpr std::uint16_t kVendorMicrosoft = 0x045e;
inline constexpr std::uint16_t kProductCamera = 0x02ae;     ///< Xbox 360 models 1414 and 1473
inline constexpr std::uint16_t kProductCameraK4w = 0x02bf;  ///< Kinect for Windows V1
inline constexpr std::uint16_t kProductMotor = 0x02b0;
inline constexpr std::array<std::uint16_t, 4> kProductsAudio{0x02ad, 0x02bb, 0x02be, 0x02c3};
/// bcdDevice of model 1414's camera; 1473 has the same product number and another release [FN].
inline constexpr std::uint16_t kReleaseOf1414 = 0x010b;

// ---- streams [OK]
inline constexpr int kCameraInterface = 0;
inline constexpr std::uint8_t kColorEndpoint = 0x81, kDepthEndpoint = 0x82;
inline constexpr int kWidth = 640, kHeight = 480, kFrameRateHz = 30;
inline constexpr std::size_t kPacketHeaderBytes = 12;
inline constexpr std::size_t kColorFrameBytes = 640 * 480;                          ///< Bayer GRBG, 8 bits
inline constexpr std::size_t kDepthFrameBytes = 640 * 480 * 11 / 8;                 ///< 11 bits a pixel, first pixel in the highest bits
inline constexpr std::size_t kColorPayloadBytes = 1908, kDepthPayloadBytes = 1748;  ///< of every packet but a frame's last
inline constexpr std::uint8_t kColorFlagBase = 0x80, kDepthFlagBase = 0x70;
inline constexpr std::uint8_t kFlagStart = 1, kFlagMiddle = 2, kFlagEnd = 5;
inline constexpr std::uint16_t kNoDisparity = 2047;  ///< raw depth of a pixel without measurement
inline constexpr double kDeviceClockHz = 60e6;

// ---- control [OK, GSPCA; FN for the calibration]
inline constexpr std::uint8_t kVendorOut = 0x40, kVendorIn = 0xc0;  ///< bmRequestType, also of the motor
enum class Command : std::uint16_t {
  kReadRegister = 0x02,     ///< body: register
  kWriteRegister = 0x03,    ///< body: register, value
  kFixedParameters = 0x04,  ///< body: five zeros; the reply holds the zero plane at byte 94
  kAlgorithm = 0x16,        ///< body: AlgorithmParameter, 0, resolution, frames a second, 0
  kSensorRegister = 0x95,   ///< body: 1, register (| 0x8000 to write), value; the third word of the reply is the value
  kCameraControl = 0x96,    ///< model 1473 and K4W [1473]
};
enum class Register : std::uint16_t {
  kColorStream = 0x05,      ///< 0 off, 1 on
  kDepthStream = 0x06,      ///< 0 off, 2 on
  kColorFormat = 0x0c,      ///< 0 Bayer
  kColorResolution = 0x0d,  ///< 1 = 640x480
  kColorRate = 0x0e,        ///< Hz
  kDepthFormat = 0x12,      ///< 3 = 11 bits packed
  kDepthResolution = 0x13,  ///< 1 = 640x480
  kDepthRate = 0x14,        ///< Hz
  kDepthMirror = 0x17,      ///< 0: as seen, not as in a mirror
  kColorMirror = 0x47,
  kProjectorCycle = 0x105,  ///< 0: the projector stays on
};
enum class AlgorithmParameter : std::uint16_t { kConstShift = 0x00, kRegistration = 0x40, kRegistrationPadding = 0x41 };

/// Registers of the colour sensor, an Aptina MT9M112 [FN: freenect_set_flag and freenect_set_exposure].
inline constexpr std::uint16_t kSensorShutterRows = 0x0009;  ///< exposure in rows
inline constexpr std::uint16_t kSensorMode = 0x0106;
inline constexpr std::uint16_t kSensorModeAutoExposure = 1U << 14, kSensorModeAutoWhiteBalance = 1U << 1;
/// Time of a row at 30 frames a second: 1/30 s over the 615 rows that the sensor counts in this mode.
inline constexpr double kSensorRowUs = 54.21;

/// Camera controls of command 0x96 [1473].
inline constexpr std::uint16_t kControlExposureMode = 0xcc00;                                ///< 1 manual, 2 automatic
inline constexpr std::uint16_t kControlExposureHigh = 0xcc04, kControlExposureLow = 0xcc06;  ///< in 100 us
inline constexpr std::uint16_t kControlGain = 0xcc0e;                                        ///< times 32
inline constexpr std::uint16_t kControlWriteByte = 0xff80, kControlByteValue = 0xff81, kControlReadWord = 0xff82, kControlReadByte = 0xff83;

inline constexpr std::size_t kControlHeaderBytes = 8;
inline constexpr std::size_t kMaxControlBytes = 512;
inline constexpr std::size_t kMaxRequestWords = 16;

[[nodiscard]] inline std::uint16_t word_at(std::span<const std::uint8_t> bytes, std::size_t offset) {
  return static_cast<std::uint16_t>(bytes[offset] | bytes[offset + 1] << 8);
}
[[nodiscard]] inline std::uint32_t double_word_at(std::span<const std::uint8_t> bytes, std::size_t offset) {
  return static_cast<std::uint32_t>(word_at(bytes, offset)) | static_cast<std::uint32_t>(word_at(bytes, offset + 2)) << 16;
}

// ---- motor [OK]: vendor requests to a device of its own
inline constexpr std::uint8_t kMotorSetLed = 0x06, kMotorSetTilt = 0x31, kMotorGetState = 0x32;
inline constexpr std::size_t kMotorStateBytes = 10;     ///< big-endian acceleration x, y, z at byte 2, tilt in half degrees at byte 8
inline constexpr double kAccelerationCountsPerG = 819;  ///< Kionix KXSD9
inline constexpr int kMaxTiltDeg = 31;
enum class Led : std::uint8_t { kOff = 0, kGreen = 1, kRed = 2, kYellow = 3, kBlinkGreen = 4, kBlinkRedYellow = 6 };

}  // namespace camloc::kinect
