// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The pure parts of the OpenNI2 driver: pixels, compressed depth, choice of modes, what is said of an installation.
#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "drivers/openni2/field_of_view.h"
#include "drivers/openni2/installation.h"
#include "drivers/openni2/openni2_device.h"
#include "drivers/openni2/pixel_layout.h"

namespace camloc::openni2 {
namespace {

using Bytes = std::vector<std::uint8_t>;

TEST(OniDepthCodec, DecodesEveryCode) {
  // First value, two steps, padding half byte, long step, full value, twice the same three times.
  const Bytes bytes{0x10, 0x00, 0x57, 0x6D, 0xFF, 192 - 60, 0x5F, 0x01, 0x02, 0xE3, 0xFF, 0x03, 0x04};
  std::vector<std::uint16_t> depth(14);
  ASSERT_TRUE(decode_depth_codec(OniCodec::k16z, bytes, depth));
  EXPECT_EQ(depth, (std::vector<std::uint16_t>{16, 17, 16, 16, 76, 77, 0x102, 0x102, 0x102, 0x102, 0x102, 0x102, 0x102, 0x304}));
}

TEST(OniDepthCodec, LooksUpTheTable) {
  const Bytes bytes{0x02, 0x00, 0x64, 0x00, 0xC8, 0x00, 0x01, 0x00, 0x76};
  std::vector<std::uint16_t> depth(3);
  ASSERT_TRUE(decode_depth_codec(OniCodec::k16zTable, bytes, depth));
  EXPECT_EQ(depth, (std::vector<std::uint16_t>{200, 100, 100}));
}

TEST(OniDepthCodec, RefusesWhatDoesNotFit) {
  std::vector<std::uint16_t> depth(3);
  const auto code_of = [&depth](OniCodec codec, const Bytes& bytes) { return decode_depth_codec(codec, bytes, depth).code(); };
  EXPECT_EQ(code_of(OniCodec::k16z, {}), ErrorCode::kCorrupt);
  EXPECT_EQ(code_of(OniCodec::k16z, {1}), ErrorCode::kCorrupt);
  EXPECT_EQ(code_of(OniCodec::k16z, {1, 0}), ErrorCode::kCorrupt);                         // too few pixels
  EXPECT_EQ(code_of(OniCodec::k16z, {1, 0, 0xE2}), ErrorCode::kCorrupt);                   // too many
  EXPECT_EQ(code_of(OniCodec::k16z, {1, 0, 0x66, 0xFF, 1}), ErrorCode::kCorrupt);          // half a value
  EXPECT_EQ(code_of(OniCodec::k16zTable, {5, 0, 1, 0}), ErrorCode::kCorrupt);              // table beyond the end
  EXPECT_EQ(code_of(OniCodec::k16zTable, {1, 0, 9, 0, 0, 0, 0x56}), ErrorCode::kCorrupt);  // index beyond the table
  EXPECT_EQ(code_of(OniCodec::k16zTable, {0, 0, 0, 0, 0x66}), ErrorCode::kCorrupt);
}

TEST(OniDepthCodec, SurvivesRandomBytes) {
  std::mt19937 random(3);
  std::vector<std::uint16_t> depth(64);
  for (int i = 0; i < 20000; ++i) {
    Bytes bytes(random() % 60);
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
    if (bytes.size() > 2) bytes[1] = 0;
    (void)decode_depth_codec(i % 2 == 0 ? OniCodec::k16z : OniCodec::k16zTable, bytes, depth);
  }
}

TEST(OniPixels, YuvAndRgbGiveTheSameGreyAndColour) {
  // A colour of limited range BT.601 by the standard's own formula.
  for (const auto& [y, u, v] : {std::tuple{16, 128, 128}, {235, 128, 128}, {81, 90, 240}, {145, 54, 34}, {41, 240, 110}}) {
    const double r = 1.164 * (y - 16) + 1.596 * (v - 128), g = 1.164 * (y - 16) - 0.392 * (u - 128) - 0.813 * (v - 128),
                 b = 1.164 * (y - 16) + 2.017 * (u - 128);
    const auto byte = [](int value) { return static_cast<std::uint8_t>(value); };
    const Bytes uyvy{byte(u), byte(y), byte(v), byte(y)}, yuyv{byte(y), byte(u), byte(y), byte(v)};
    for (const RawImage& image : {RawImage{uyvy, 2, 1, 4, PixelLayout::kUyvy, false}, RawImage{yuyv, 2, 1, 4, PixelLayout::kYuyv, false}}) {
      Image<Bgr> color;
      Image<std::uint8_t> gray;
      ASSERT_TRUE(to_bgr(image, &color));
      ASSERT_TRUE(to_gray(image, &gray));
      for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_NEAR(color.pixels[i].r, std::clamp(r, 0.0, 255.0), 2);
        EXPECT_NEAR(color.pixels[i].g, std::clamp(g, 0.0, 255.0), 2);
        EXPECT_NEAR(color.pixels[i].b, std::clamp(b, 0.0, 255.0), 2);
        EXPECT_NEAR(gray.pixels[i], 1.164 * (y - 16), 1);
      }
    }
  }
}

TEST(OniPixels, TakesRowsWithGapsAndUndoesMirrors) {
  const Bytes bytes{1, 2, 3, 99, 4, 5, 6};
  Image<std::uint8_t> gray;
  ASSERT_TRUE(to_gray({bytes, 3, 2, 4, PixelLayout::kGray8, false}, &gray));
  EXPECT_EQ(gray.pixels, (Bytes{1, 2, 3, 4, 5, 6}));
  ASSERT_TRUE(to_gray({bytes, 3, 2, 4, PixelLayout::kGray8, true}, &gray));
  EXPECT_EQ(gray.pixels, (Bytes{3, 2, 1, 6, 5, 4}));
}

TEST(OniPixels, InfraredKeepsItsEightHighestBits) {
  const Bytes bytes{0xFF, 0x03, 0x04, 0x00, 0xFF, 0xFF};
  Image<std::uint8_t> gray;
  ASSERT_TRUE(to_gray({bytes, 3, 1, 6, PixelLayout::kGray16, false}, &gray));
  EXPECT_EQ(gray.pixels, (Bytes{255, 1, 255}));
}

TEST(OniPixels, NeverReadsBeyondTheData) {
  const Bytes bytes(100);
  Image<std::uint8_t> gray;
  for (const auto& [width, height, stride] : {std::tuple{10, 11, std::size_t{10}},
                                              {10, 10, std::size_t{11}},
                                              {10, 10, std::size_t{9}},
                                              {0, 1, std::size_t{1}},
                                              {1, 0, std::size_t{1}},
                                              {-1, 10, std::size_t{10}},
                                              {10, 2, ~std::size_t{0}},
                                              {10, 1 << 30, std::size_t{10}},
                                              {1, 2, std::size_t{0}},
                                              {101, 1, std::size_t{101}}}) {
    EXPECT_EQ(to_gray({bytes, width, height, stride, PixelLayout::kGray8, false}, &gray).code(), ErrorCode::kCorrupt)
        << width << "x" << height << " " << stride;
  }
  EXPECT_EQ(to_gray({bytes, 1, 1, 0, PixelLayout::kJpeg, false}, &gray).code(), ErrorCode::kCorrupt);
  EXPECT_TRUE(to_gray({bytes, 10, 10, 10, PixelLayout::kGray8, false}, &gray));
  EXPECT_EQ(to_gray({bytes, 3, 2, 6, PixelLayout::kUyvy, false}, &gray).code(), ErrorCode::kCorrupt);  // an odd width
  EXPECT_EQ(to_gray({bytes, 2, 2, 4, PixelLayout::kDepth16, false}, &gray).code(), ErrorCode::kUnsupported);
}

OniVideoMode mode_of(int format, int width, int height, int fps) { return {static_cast<OniPixelFormat>(format), width, height, fps}; }

TEST(OniModes, ChoosesTheUsualMode) {
  const std::vector<OniVideoMode> offered{mode_of(101, 640, 480, 30), mode_of(100, 320, 240, 60), mode_of(100, 640, 480, 30),
                                          mode_of(102, 640, 480, 30), mode_of(200, 640, 480, 30), mode_of(100, 1280, 1024, 15)};
  const std::optional<OniVideoMode> mode = choose_mode(offered, StreamUse::kDepth, {});
  ASSERT_TRUE(mode);
  EXPECT_EQ(describe(*mode), "640x480@30 in 1 mm");
}

TEST(OniModes, ObeysTheRequestOrRefuses) {
  const std::vector<OniVideoMode> offered{mode_of(200, 640, 480, 30), mode_of(201, 320, 240, 60), mode_of(205, 320, 240, 30),
                                          mode_of(204, 1280, 1024, 30)};
  const std::vector<OniVideoMode> nonsense{mode_of(200, 0, 480, 30), mode_of(200, 640, 480, 0), mode_of(200, 1 << 30, 480, 30)};
  EXPECT_EQ(describe(*choose_mode(offered, StreamUse::kImage, {320, 240, 0})), "320x240@30 YUYV");
  EXPECT_EQ(describe(*choose_mode(offered, StreamUse::kImage, {0, 0, 60})), "320x240@60 YUV422");
  EXPECT_FALSE(choose_mode(offered, StreamUse::kImage, {1280, 1024, 0}));  // JPEG alone
  EXPECT_FALSE(choose_mode(offered, StreamUse::kDepth, {}));
  EXPECT_FALSE(choose_mode(nonsense, StreamUse::kImage, {}));
}

TEST(OniFieldOfView, RefusesWhatIsNoCamera) {
  EXPECT_FALSE(intrinsics_of({640, 480, 0, 0}));
  EXPECT_FALSE(intrinsics_of({640, 480, 3.14159, 1}));
  EXPECT_FALSE(intrinsics_of({0, 480, 1, 1}));
  const auto square = intrinsics_of({640, 480, 1, 0});
  ASSERT_TRUE(square);
  EXPECT_DOUBLE_EQ(square->fx, square->fy);
  const auto camera = registered_camera({640, 480, 1, 0.8}, 320, 240, 0.001);
  ASSERT_TRUE(camera);
  EXPECT_FALSE(camera->is_depth_registered);  // the same view in other pixels
  EXPECT_NEAR(camera->depth.fx * 2, camera->color.fx, 1e-9);
}

TEST(OniListing, SaysWhichPartOfTheInstallationIsMissing) {
  Openni2Installation openni2;
  const auto expect = [&openni2](const std::string& problem, const std::string& advice) {
    const CameraListing listing = listing_of(openni2);
    EXPECT_EQ(listing.problem.empty(), problem.empty()) << listing.problem;
    EXPECT_NE(listing.problem.find(problem), std::string::npos) << listing.problem;
    EXPECT_NE(listing.advice.find(advice), std::string::npos) << listing.advice;
    return listing;
  };
  openni2.problem = "libOpenNI2.so.0 is not installed";
  expect("not installed", "apt install libopenni2-0");
  openni2.is_library_found = openni2.is_started = true;
  openni2.problem = "";
  openni2.drivers_folder = "/usr/lib/OpenNI2/Drivers";
  expect("/usr/lib/OpenNI2/Drivers: no driver was loaded from here", "lib*.so.0");
  openni2.num_drivers = 1;
  openni2.version = "2.2.0.33";
  const CameraListing none = expect("", "kinect://");
  EXPECT_TRUE(none.cameras.empty());
  EXPECT_EQ(none.searched, "OpenNI2 2.2.0.33, 1 drivers in /usr/lib/OpenNI2/Drivers");
  openni2.cameras = {{"openni2://1d27/0601@1/4", "PrimeSense Xtion", "USB id 1d27:0601", ""}};
  const CameraListing listing = expect("", "");
  ASSERT_EQ(listing.cameras.size(), 1U);
  EXPECT_EQ(listing.cameras[0].url, "openni2://1d27/0601@1/4");
  EXPECT_EQ(listing.cameras[0].name, "PrimeSense Xtion");
}

}  // namespace
}  // namespace camloc::openni2
