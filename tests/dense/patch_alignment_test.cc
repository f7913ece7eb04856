// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Patches drawn from one texture at known places: alignment must find the fraction of a pixel, and say when it cannot.
#include "core/dense/patch_alignment.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "tests/dense/generated_texture.h"

namespace camloc {
namespace {

using testing::Texture;

/// The texture around `middle`, seen through A: what align_patch calls the target, its point `shift` off the middle.
FeaturePatch draw(const Texture& texture, const Eigen::Matrix2d& A, const Eigen::Vector2d& shift, double contrast = 1,
                  double brightness = 0) {
  FeaturePatch patch;
  for (int dy = -FeaturePatch::kHalf; dy <= FeaturePatch::kHalf; ++dy) {
    for (int dx = -FeaturePatch::kHalf; dx <= FeaturePatch::kHalf; ++dx) {
      const Eigen::Vector2d at = A * (Eigen::Vector2d(dx, dy) - shift);
      const double grey = 128 + brightness + contrast * texture.at(at);
      patch.pixels[static_cast<std::size_t>((dy + FeaturePatch::kHalf) * FeaturePatch::kSide + dx + FeaturePatch::kHalf)] =
          static_cast<std::uint8_t>(std::lround(std::clamp(grey, 0.0, 255.0)));
    }
  }
  return patch;
}

Eigen::Matrix2d turned_and_scaled(double angle_rad, double scale) { return scale * Eigen::Rotation2Dd(angle_rad).toRotationMatrix(); }

TEST(PatchAlignment, FindsAFractionOfAPixel) {
  std::mt19937_64 rng(4);
  std::uniform_real_distribution<double> shift(-1.2, 1.2), angle(-0.5, 0.5), scale(0.85, 1.15), contrast(0.6, 1.4), brightness(-20, 20);
  int num_aligned = 0, num_close = 0;
  for (int i = 0; i < 200; ++i) {
    const Texture texture(static_cast<std::uint64_t>(i));
    const Eigen::Matrix2d A = turned_and_scaled(angle(rng), scale(rng));
    const Eigen::Vector2d expected(shift(rng), shift(rng));
    const FeaturePatch reference = draw(texture, Eigen::Matrix2d::Identity(), {0, 0});
    const FeaturePatch target = draw(texture, A, expected, contrast(rng), brightness(rng));
    const PatchAlignment found = align_patch(reference, A, target);
    if (found.verdict != PatchVerdict::kAligned) continue;
    ++num_aligned;
    const double error_px = (found.shift_px - expected).norm();
    num_close += error_px < 0.08 ? 1 : 0;
    EXPECT_LT(error_px, 0.25) << i;  // what is left is interpolation between pixels of a patch that is turned and scaled
    EXPECT_GT(found.correlation, 0.95) << i;
  }
  EXPECT_GT(num_aligned, 160);
  EXPECT_GT(num_close, 0.95 * num_aligned);
}

TEST(PatchAlignment, RefusesAnotherTexture) {
  int num_aligned = 0;
  for (std::uint64_t i = 0; i < 200; ++i) {
    const FeaturePatch reference = draw(Texture(i), Eigen::Matrix2d::Identity(), {0, 0});
    const FeaturePatch target = draw(Texture(i + 1000), Eigen::Matrix2d::Identity(), {0, 0});
    num_aligned += align_patch(reference, Eigen::Matrix2d::Identity(), target).verdict == PatchVerdict::kAligned ? 1 : 0;
  }
  EXPECT_LE(num_aligned, 4);
}

TEST(PatchAlignment, RefusesWhatIsTooFarAway) {
  for (std::uint64_t i = 0; i < 50; ++i) {
    const FeaturePatch reference = draw(Texture(i), Eigen::Matrix2d::Identity(), {0, 0});
    const FeaturePatch target = draw(Texture(i), Eigen::Matrix2d::Identity(), {3.2, -2.0});
    const PatchAlignment found = align_patch(reference, Eigen::Matrix2d::Identity(), target);
    EXPECT_FALSE(found.verdict == PatchVerdict::kAligned && found.correlation > 0.95) << i;
  }
}

TEST(PatchAlignment, RefusesBareWallsAndEdges) {
  FeaturePatch bare, edge;
  for (int i = 0; i < FeaturePatch::kSide * FeaturePatch::kSide; ++i) {
    bare.pixels[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(100 + i % 2);
    edge.pixels[static_cast<std::size_t>(i)] = i % FeaturePatch::kSide < FeaturePatch::kHalf ? 40 : 200;
  }
  EXPECT_EQ(align_patch(bare, Eigen::Matrix2d::Identity(), bare).verdict, PatchVerdict::kFlat);
  EXPECT_EQ(align_patch(edge, Eigen::Matrix2d::Identity(), edge).verdict, PatchVerdict::kFlat);
}

TEST(PatchAlignment, RefusesAWarpThatLeavesTheReference) {
  const FeaturePatch patch = draw(Texture(1), Eigen::Matrix2d::Identity(), {0, 0});
  EXPECT_EQ(align_patch(patch, turned_and_scaled(0, 2.0), patch).verdict, PatchVerdict::kOutside);
  EXPECT_EQ(align_patch(patch, Eigen::Matrix2d::Constant(std::nan("")), patch).verdict, PatchVerdict::kOutside);
}

TEST(PatchAlignment, SigmaGrowsWithTheNoise) {
  std::mt19937_64 rng(9);
  std::normal_distribution<double> noise(0, 12);
  const FeaturePatch clean = draw(Texture(2), Eigen::Matrix2d::Identity(), {0, 0});
  FeaturePatch noisy = clean;
  for (std::uint8_t& grey : noisy.pixels) grey = static_cast<std::uint8_t>(std::clamp(grey + noise(rng), 0.0, 255.0));
  const double before = align_patch(clean, Eigen::Matrix2d::Identity(), clean).sigma_px;
  const double after = align_patch(clean, Eigen::Matrix2d::Identity(), noisy).sigma_px;
  EXPECT_GT(before, 0);
  EXPECT_GT(after, 2 * before);
}

}  // namespace
}  // namespace camloc
