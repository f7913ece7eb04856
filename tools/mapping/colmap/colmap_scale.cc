// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <map>

#include "tools/common/text_format.h"
#include "tools/mapping/colmap/colmap_model.h"

namespace camloc::mapping {
namespace {

constexpr std::size_t kMinPairs = 50, kMinImages = 2;
constexpr std::size_t kMinPairsPerImage = 5;  // an image's median needs that many
constexpr double kMaxSpread = 0.15;           // points of a structure-from-motion model scatter 1-5 % at room distances
constexpr double kMaxImageSpread = 0.05;

/// Of a list that is not empty; of an even number the mean of the middle two.
double median(std::vector<double> values) {
  const std::size_t middle = values.size() / 2;
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(middle), values.end());
  const double upper = values[middle];
  if (values.size() % 2 == 1) return upper;
  return 0.5 * (upper + *std::max_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(middle)));
}

double robust_deviation(const std::vector<double>& values, double center) {
  std::vector<double> deviations;
  for (const double value : values) deviations.push_back(std::abs(value - center));
  return 1.4826 * median(std::move(deviations));
}

std::string percent(double fraction) { return tools::text_of("%.1f %%", 100 * fraction); }

}  // namespace

std::string describe_scale(const ModelScale& scale) {
  return tools::text_of("%.4g", scale.metres_per_unit) + " m a unit, from " + std::to_string(scale.num_pairs) + " points in " +
         std::to_string(scale.num_images) + " images; scatter " + percent(scale.spread) + ", drift between images " +
         percent(scale.image_spread);
}

Result<ModelScale> estimate_model_scale(std::span<const DepthPair> pairs) {
  std::vector<double> logs;
  std::map<std::uint32_t, std::vector<double>> logs_of_image;
  for (const DepthPair& pair : pairs) {
    const double log_ratio = std::log(pair.measured_depth_m / pair.model_depth);
    if (!std::isfinite(log_ratio)) continue;
    logs.push_back(log_ratio);
    logs_of_image[pair.image].push_back(log_ratio);
  }
  std::vector<double> image_medians;
  for (auto& [image, values] : logs_of_image) {
    if (values.size() >= kMinPairsPerImage) image_medians.push_back(median(std::move(values)));
  }
  const std::string found =
      std::to_string(logs.size()) + " points with measured depth in " + std::to_string(image_medians.size()) + " images";
  if (logs.size() < kMinPairs || image_medians.size() < kMinImages) {
    return {ErrorCode::kInvalid, "the scale of the model cannot be told from " + found + "; at least " + std::to_string(kMinPairs) +
                                     " in " + std::to_string(kMinImages) + " are needed"};
  }
  ModelScale scale;
  const double center = median(logs);
  scale.metres_per_unit = std::exp(center);
  scale.spread = robust_deviation(logs, center);
  scale.image_spread = robust_deviation(image_medians, median(image_medians));
  scale.num_pairs = logs.size();
  scale.num_images = image_medians.size();
  if (scale.spread > kMaxSpread) {
    return {ErrorCode::kInvalid, "the scale of the model cannot be told: measured / model depth scatters by " + percent(scale.spread) +
                                     " (at most " + percent(kMaxSpread) + ") over " + found +
                                     "; does it belong to this recording and camera?"};
  }
  if (scale.image_spread > kMaxImageSpread) {
    return {ErrorCode::kInvalid, "the scale of the model drifts by " + percent(scale.image_spread) + " (at most " +
                                     percent(kMaxImageSpread) + ") between images, over " + found +
                                     "; check the model for parts that do not fit together"};
  }
  return scale;
}

}  // namespace camloc::mapping
