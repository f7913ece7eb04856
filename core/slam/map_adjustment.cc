// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/slam/map_adjustment.h"

#include <cmath>

#include "core/base/order_statistics.h"

namespace camloc {
namespace {

// What the residuals say, before anything is removed.
MapFit measure_fit(const BundleOptions& bundle, const MapExtract& extract, std::span<const BundleResidual> residuals) {
  MapFit fit;
  std::vector<double> pixels, sigmas, metres;
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    const BundleObservation& o = extract.problem.observations[i];
    pixels.push_back(static_cast<double>(residuals[i].pixel_sigmas) * o.sigma_px);
    if (o.depth_m <= 0) continue;
    sigmas.push_back(std::abs(static_cast<double>(residuals[i].depth_sigmas)));
    metres.push_back(sigmas.back() * bundle.depth_noise.sigma_m(o.depth_m));
  }
  fit.num_observations = residuals.size();
  fit.median_px = lower_quantile(pixels, 0.5);
  fit.p90_px = lower_quantile(std::move(pixels), 0.9);
  fit.median_depth_sigmas = lower_quantile(std::move(sigmas), 0.5);
  fit.median_depth_m = lower_quantile(std::move(metres), 0.5);
  return fit;
}

// Takes observations that do not fit out of the map; the observations of the extract are left as they are.
void remove_outliers(const MapExtract& extract, std::span<const BundleResidual> residuals, double max_pixel_sigmas, SlamMap* map) {
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    if (residuals[i].pixel_sigmas <= max_pixel_sigmas) continue;
    const BundleObservation& o = extract.problem.observations[i];
    if (o.landmark < extract.landmarks.size()) map->remove_observation(extract.landmarks[o.landmark], extract.keyframes[o.camera]);
  }
}

}  // namespace

MapFit adjust_locally(const BundleOptions& bundle, const SlamNumbers& numbers, std::uint32_t keyframe, SlamMap* map) {
  MapExtract extract = extract_window(numbers, keyframe, *map);
  BundleOptions local = bundle;
  local.max_iterations = numbers.window_iterations;
  local.min_relative_decrease = 1e-3;
  adjust_bundle(local, &extract.problem);
  write_back(extract, map);
  const std::vector<BundleResidual> residuals = bundle_residuals(local, extract.problem);
  const MapFit fit = measure_fit(local, extract, residuals);
  remove_outliers(extract, residuals, numbers.window_max_pixel_sigmas, map);
  for (const std::uint32_t index : extract.landmarks) map->summarize(index);
  return fit;
}

MapFit adjust_globally(const BundleOptions& bundle, std::uint32_t segment, const MapEvidence& evidence, double max_pixel_sigmas,
                       SlamMap* map, const BundleCallback& on_iteration) {
  MapFit fit;
  for (int round = 0; round < 2; ++round) {
    MapExtract extract = extract_segment(segment, evidence, *map);
    const BundleReport report = adjust_bundle(bundle, &extract.problem, on_iteration);
    write_back(extract, map);
    const std::vector<BundleResidual> residuals = bundle_residuals(bundle, extract.problem);
    fit = measure_fit(bundle, extract, residuals);
    if (report.is_stopped) break;
    remove_outliers(extract, residuals, max_pixel_sigmas, map);
  }
  for (std::uint32_t i = 0; i < map->landmarks().size(); ++i) map->summarize(i);
  return fit;
}

}  // namespace camloc
