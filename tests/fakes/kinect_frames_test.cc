// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/fakes/kinect_frames.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <random>

#include "core/io/sequence.h"
#include "tests/drivers/test_folder.h"

namespace camloc::fakes {
namespace {

TEST(PackBits, GivesBackWhatItTook) {
  std::mt19937 random(3);
  for (const int bits : {10, 11}) {
    std::vector<std::uint16_t> values(640);
    for (std::uint16_t& value : values) value = static_cast<std::uint16_t>(random() & ((1U << bits) - 1));
    const auto bytes = pack_bits(values, bits);
    EXPECT_EQ(bytes.size(), values.size() * static_cast<std::size_t>(bits) / 8);
    EXPECT_EQ(unpack_bits(bytes, bits), values);
  }
}

TEST(PackBits, PutsTheFirstPixelIntoTheHighestBits) {
  EXPECT_EQ(pack_bits(std::vector<std::uint16_t>{0x7ff, 0, 0, 0, 0, 0, 0, 1}, 11),
            std::vector<std::uint8_t>({0xff, 0xe0, 0, 0, 0, 0, 0, 0, 0, 0, 1}));
}

TEST(BayerMosaic, RowsAreGreenRedAndBlueGreen) {
  ColorImage image;
  image.width = kKinectWidth;
  image.height = kKinectHeight;
  for (std::size_t i = 0; i < kColorBytes; ++i) image.pixels.insert(image.pixels.end(), {10, 20, 30});
  const auto mosaic = bayer_mosaic(image);
  EXPECT_EQ(mosaic[0], 20);
  EXPECT_EQ(mosaic[1], 10);
  EXPECT_EQ(mosaic[kKinectWidth], 30);
  EXPECT_EQ(mosaic[kKinectWidth + 1], 20);
}

TEST(Disparity, GoesToMillimetresAndBack) {
  const KinectCalibration calibration;
  for (int raw = 400; raw < 1060; ++raw) {
    // Where a step is smaller than a millimetre, whole millimetres cannot tell neighbours apart.
    const double mm = disparity_to_mm(calibration, raw);
    EXPECT_LE(std::abs(mm_to_disparity(calibration, static_cast<int>(std::lround(mm))) - raw), mm < 600 ? 1 : 0) << raw;
  }
}

TEST(Disparity, IsNearThePublishedFit) {
  // 1 / z = 3.3309 - 0.0030711 raw, z in metres (OpenKinect wiki, "Imaging Information"), fitted to one device; they differ.
  const KinectCalibration calibration;
  for (const int raw : {500, 700, 900, 1000})
    EXPECT_NEAR(disparity_to_mm(calibration, raw) * (3.3309 - 0.0030711 * raw) / 1000, 1, 0.06) << raw;
}

TEST(Disparity, RoundTripLosesAsMuchAsTheHeaderSays) {
  const KinectCalibration calibration;
  const auto worst_near = [&](int mm) {
    double worst = 0;
    for (int z = mm - 50; z <= mm + 50; ++z)
      worst = std::max(worst, std::abs(disparity_to_mm(calibration, mm_to_disparity(calibration, z)) - z));
    return worst;
  };
  EXPECT_LT(worst_near(1000), 1.6);
  EXPECT_LT(worst_near(2000), 6.3);
  EXPECT_LT(worst_near(4000), 24.5);
  EXPECT_EQ(mm_to_disparity(calibration, 0), kNoDisparity);
  EXPECT_EQ(mm_to_disparity(calibration, 0xffff), kNoDisparity);
  EXPECT_EQ(mm_to_disparity(calibration, 100), kNoDisparity);
}

TEST(PatternShow, IsThePatternThatItSays) {
  PatternShow show;
  const auto color = show.frame(FrameFormat::kBayer, 21);
  const auto depth = unpack_bits(show.frame(FrameFormat::kDepth11, 21), 11);
  const auto coarse = unpack_bits(show.frame(FrameFormat::kDepth10, 21), 10);
  for (int y = 0; y < kKinectHeight; y += 7) {
    for (int x = 0; x < kKinectWidth; x += 5) {
      const auto i = static_cast<std::size_t>(y * kKinectWidth + x);
      ASSERT_EQ(color[i], pattern_color(x, y, 21));
      ASSERT_EQ(depth[i], pattern_disparity(x, y, 21));
      ASSERT_EQ(coarse[i], pattern_disparity(x, y, 21) / 2);
    }
  }
  for (const FrameFormat format : {FrameFormat::kBayerHigh, FrameFormat::kUyvy, FrameFormat::kInfrared, FrameFormat::kInfraredHigh})
    EXPECT_EQ(show.frame(format, 0).size(), payload_bytes(format));
}

TEST(RecordedShow, ShowsARecordingAsItsSensorsWouldHave) {
  ReplayOptions options;
  options.folder = data_folder("kitchen");
  if (!std::filesystem::exists(options.folder)) GTEST_SKIP() << "no recording " << options.folder;
  options.frames = "10:16:5";
  options.at_end = AtEnd::kHold;
  options.cache_file = ::testing::TempDir() + "camloc_show_" + std::to_string(::getpid());
  const KinectCalibration calibration;
  const auto sequence = read_sequence(options.folder);
  ASSERT_TRUE(sequence) << sequence.status().message();
  for (int run = 0; run < 2; ++run) {  // rendered, then from the cache
    auto show = ReplayShow::open(options, calibration);
    ASSERT_TRUE(show) << show.status().message();
    EXPECT_EQ((*show)->num_frames(), 2U);
    ImageReader reader;
    Image<std::uint16_t> depth_mm;
    ASSERT_TRUE(reader.read_depth(sequence->frames[15].depth_path, &depth_mm));
    const auto color = reader.read_color(sequence->frames[15].color_path);
    ASSERT_TRUE(color);
    const auto depth = unpack_bits((*show)->frame(FrameFormat::kDepth11, 99), 11);
    const auto mosaic = (*show)->frame(FrameFormat::kBayer, 99);
    double worst_steps = 0;
    for (std::size_t i = 0; i < depth.size(); ++i) {
      const int mm = depth_mm.pixels[i];
      ASSERT_EQ(depth[i], mm_to_disparity(calibration, mm));
      if (depth[i] == kNoDisparity) continue;
      const double step = disparity_to_mm(calibration, depth[i] + 1) - disparity_to_mm(calibration, depth[i]);
      worst_steps = std::max(worst_steps, std::abs(disparity_to_mm(calibration, depth[i]) - mm) / step);
    }
    EXPECT_LT(worst_steps, 0.51);
    EXPECT_EQ(mosaic[1], color->pixels[3]);
    EXPECT_EQ((*show)->frame(FrameFormat::kDepth10, 1).size(), payload_bytes(FrameFormat::kDepth10));
  }
  ::unlink(options.cache_file.c_str());
}

TEST(ReplayShow, SaysWhatIsWrong) {
  ReplayOptions options;
  options.folder = "/nonexistent";
  EXPECT_FALSE(ReplayShow::open(options, {}));
}

}  // namespace
}  // namespace camloc::fakes
