// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "core/base/order_statistics.h"
#include "tools/common/text_format.h"
#include "tools/mapping/cloud/cloud_index.h"
#include "tools/mapping/eval/evaluation.h"
#include "tools/mapping/picture/point_raster.h"

namespace camloc::mapping {
namespace {

constexpr Rgb kPaper{252, 252, 250}, kInk{40, 40, 46}, kGrid{222, 222, 218}, kBar{70, 120, 170}, kMean{200, 80, 30}, kMedian{20, 20, 24},
    kP95{130, 60, 150};
constexpr Rgb kNight{18, 19, 22}, kLight{228, 228, 232}, kCamera{255, 255, 255}, kOutside{215, 95, 175};
constexpr int kWidth = 1400, kMinHeight = 360, kMaxHeight = 1400, kMargin = 50, kHeader = 75, kFooter = 45;
constexpr double kNearCosine = 0.866;  // 30 degrees
constexpr double kFullScaleM = 0.10;
constexpr double kCameraSpacingPx = 12;
constexpr std::size_t kFirstRampEntry = 70;  // darker ones cannot be told from the background

/// The cameras' mean up, corrected to the cloud's z axis or else to the walls: who holds a camera looks down a little.
Eigen::Vector3d up_of(const Evaluation& evaluation, const PointCloud& cloud) {
  Eigen::Vector3d up = Eigen::Vector3d::Zero();
  for (const Rigid3& T : evaluation.T_cloud_keyframe) up -= T.rotation * Eigen::Vector3d::UnitY();
  const Eigen::Vector3d z = Eigen::Vector3d::UnitZ();
  if (up.norm() < 1e-3 || up.normalized().dot(z) > kNearCosine) return z;
  up.normalize();
  const PointCloud coarse = thinned(cloud.points_m, 0.1);
  std::vector<Eigen::Vector3d> points;
  for (const Eigen::Vector3f& p : coarse.points_m) points.push_back(p.cast<double>());
  const Eigen::Matrix3d walls = wall_directions(points);
  for (int axis = 0; axis < 3; ++axis) {
    const double cosine = walls.col(axis).dot(up);
    if (std::abs(cosine) > kNearCosine) return (cosine > 0 ? 1 : -1) * walls.col(axis);
  }
  return up;
}

/// The height that cuts ceilings off: a little above most cameras.
double eye_level(const Evaluation& evaluation, const Eigen::Vector3d& up) {
  std::vector<double> heights;
  for (const Eigen::Vector3d& p : evaluation.keyframes_m.empty() ? evaluation.landmarks_m : evaluation.keyframes_m)
    heights.push_back(up.dot(p));
  std::sort(heights.begin(), heights.end());
  return heights.empty() ? 1e9 : heights[heights.size() * 9 / 10] + 0.3;
}

/// Grey by height, so that furniture stands out from the floor; thinned to what a picture can show.
void add_cloud(const Evaluation& evaluation, const PointCloud& cloud, const Viewpoint& viewpoint, const Eigen::Vector3d& up,
               double cut_height, PointRaster* raster) {
  constexpr std::size_t kMaxPoints = 3000000;
  Eigen::Vector3d low(1e18, 1e18, 1e18), high = -low;
  for (const Eigen::Vector3d& p : evaluation.landmarks_m) low = low.cwiseMin(p), high = high.cwiseMax(p);
  double low_height = 1e18;
  std::vector<Eigen::Vector3d> points;
  const std::size_t step = cloud.points_m.size() / kMaxPoints + 1;
  for (std::size_t i = 0; i < cloud.points_m.size(); i += step) {
    const Eigen::Vector3d p = cloud.points_m[i].cast<double>();
    if (up.dot(p) > cut_height || ((p - low).array() < -5).any() || ((p - high).array() > 5).any()) continue;
    points.push_back(p);
    low_height = std::min(low_height, up.dot(p));
  }
  std::vector<Rgb> colors;
  for (const Eigen::Vector3d& p : points) {
    const auto grey = static_cast<std::uint8_t>(50 + 70 * std::clamp((up.dot(p) - low_height) / 2.5, 0.0, 1.0));
    colors.push_back({grey, grey, static_cast<std::uint8_t>(grey + 4)});
  }
  raster->add_points(viewpoint, points, colors, std::clamp(0.015 * viewpoint.px_per_m, 0.5, 2.0));
}

void add_landmarks(const Evaluation& evaluation, Viewpoint viewpoint, PointRaster* raster) {
  if (evaluation.distances.point_m.size() != evaluation.landmarks_m.size()) return;
  const auto ramp = value_ramp().subspan(kFirstRampEntry);
  std::vector<Rgb> colors;
  for (const float value : evaluation.distances.point_m) {
    const auto distance_m = static_cast<double>(value);
    const auto entry = static_cast<std::size_t>(std::min(1.0, distance_m / kFullScaleM) * static_cast<double>(ramp.size() - 1));
    colors.push_back(distance_m > evaluation.max_distance_m ? kOutside : ramp[entry]);
  }
  viewpoint.T_view_world.translation.z() -= 1e4;  // over the cloud, whatever is above them
  raster->add_points(viewpoint, evaluation.landmarks_m, colors, 1.5);
}

/// The view that fills the width, and the height that it needs.
std::pair<Viewpoint, int> fit_picture(const Evaluation& evaluation, CloudView view, const Eigen::Vector3d& up) {
  std::vector<Eigen::Vector3d> shown = evaluation.landmarks_m;
  // The fit may leave a hundredth out; the keyframes, a tenth at least, must not be that.
  for (std::size_t i = 0; i <= evaluation.landmarks_m.size() / (10 * evaluation.keyframes_m.size() + 1); ++i) {
    shown.insert(shown.end(), evaluation.keyframes_m.begin(), evaluation.keyframes_m.end());
  }
  const auto fit = view == CloudView::kTop ? fit_top_view : fit_side_view;
  Viewpoint viewpoint = fit(shown, up, kWidth, kMaxHeight, kMargin);
  std::vector<double> rows;
  for (const Eigen::Vector3d& p : shown) rows.push_back((viewpoint.T_view_world * p).y() * viewpoint.px_per_m);
  const auto [low, high] = trimmed_range(std::move(rows), 100);
  const int height = std::clamp(static_cast<int>(high - low) + 2 * kMargin, kMinHeight, kMaxHeight);
  viewpoint = fit(shown, up, kWidth, height, kMargin);
  viewpoint.center_v += kHeader;
  return {viewpoint, height + kHeader + kFooter};
}

}  // namespace

ColorImage draw_histogram(const CloudDistances& distances, const std::string& title) {
  constexpr int kBins = 40, kBinPx = 22, kLeft = 80, kTop = 90, kPlotHeight = 420, kWidthPx = kLeft + (kBins + 4) * kBinPx + 40;
  PointRaster raster(kWidthPx, kTop + kPlotHeight + 80, kPaper);
  std::vector<std::size_t> bins(kBins + 1);
  for (const float distance : distances.point_m) {
    ++bins[static_cast<std::size_t>(std::clamp(static_cast<double>(distance) / kFullScaleM * kBins, 0.0, static_cast<double>(kBins)))];
  }
  const double total = std::max<double>(1, static_cast<double>(distances.point_m.size()));
  const double highest = std::max(0.01, static_cast<double>(*std::max_element(bins.begin(), bins.end())) / total);
  const double scale = kPlotHeight / (1.08 * highest);
  const int base = kTop + kPlotHeight;
  const double grid = highest > 0.3 ? 0.1 : highest > 0.1 ? 0.05 : 0.02;
  for (double share = 0; share < 1.08 * highest; share += grid) {
    const int v = base - static_cast<int>(share * scale);
    raster.add_rectangle(kLeft, v, (kBins + 4) * kBinPx, 1, kGrid);
    const std::string label = tools::text_of("%.0f %%", 100 * share);
    raster.add_text(kLeft - 12 - PointRaster::text_width(label, 11), v + 5, label, 11, kInk);
  }
  for (int bin = 0; bin <= kBins; ++bin) {
    const int height = static_cast<int>(std::lround(static_cast<double>(bins[static_cast<std::size_t>(bin)]) / total * scale));
    const int u = kLeft + (bin < kBins ? bin : bin + 2) * kBinPx;  // what is beyond the scale stands aside
    raster.add_rectangle(u + 1, base - height, bin < kBins ? kBinPx - 2 : 2 * kBinPx, height, bin < kBins ? kBar : kP95);
  }
  raster.add_rectangle(kLeft, base, (kBins + 4) * kBinPx, 2, kInk);
  for (int cm = 0; cm <= 10; ++cm) raster.add_text(kLeft + 4 * cm * kBinPx - 5, base + 22, std::to_string(cm), 11, kInk);
  raster.add_text(kLeft + (kBins + 2) * kBinPx - 8, base + 22, "more", 11, kInk);
  raster.add_text(kLeft + kBins * kBinPx / 2 - 170, base + 52, "distance from landmark to nearest point of the cloud [cm]", 12, kInk);
  raster.add_text(kLeft, 32, title, 15, kInk);
  constexpr int kKeyU = kLeft + 30 * kBinPx;
  int row = kTop + 22;
  const DistanceStatistics& d = distances.point;
  const struct {
    const char* name;
    double value;
    Rgb color;
  } marks[] = {{"median", d.median_m, kMedian}, {"mean", d.mean_m, kMean}, {"p95", d.p95_m, kP95}};
  for (const auto& mark : marks) {
    const int u = kLeft + static_cast<int>(std::min(1.02, mark.value / kFullScaleM) * kBins * kBinPx);
    raster.add_rectangle(u - 1, kTop, 2, kPlotHeight, mark.color);
    raster.add_rectangle(kKeyU - 26, row - 7, 18, 2, mark.color);
    raster.add_text(kKeyU, row, tools::text_of("%s %.2f cm", mark.name, 100 * mark.value), 12, mark.color);
    row += 22;
  }
  const std::string note = tools::text_of("%llu landmarks near the cloud, %.1f %% within 3 cm, %.1f %% within 5 cm; %llu outside of it",
                                          tools::llu(d.count), 100 * d.share_3cm, 100 * d.share_5cm, tools::llu(distances.num_outside));
  raster.add_text(kLeft, 60, note, 12, kInk);
  return raster.image();
}

ColorImage draw_cloud_view(const Evaluation& evaluation, const PointCloud& cloud, CloudView view, const std::string& title) {
  const Eigen::Vector3d up = up_of(evaluation, cloud);
  const auto [viewpoint, height] = fit_picture(evaluation, view, up);
  PointRaster raster(kWidth, height, kNight);
  add_cloud(evaluation, cloud, viewpoint, up, view == CloudView::kTop ? eye_level(evaluation, up) : 1e18, &raster);
  add_landmarks(evaluation, viewpoint, &raster);
  raster.add_cameras(viewpoint, evaluation.T_cloud_keyframe, kCameraSpacingPx, std::max(0.1, 12 / viewpoint.px_per_m), kCamera);
  raster.add_rectangle(0, 0, kWidth, kHeader, kNight);
  raster.add_rectangle(0, height - kFooter, kWidth, kFooter, kNight);
  raster.add_text(30, 34, title, 14, kLight);
  raster.add_text(30, 59, "grey: cloud   white: keyframes   pink: landmarks outside of the cloud", 11, kLight);
  raster.add_text(kWidth - 520, 28, "landmark to cloud", 11, kLight);
  raster.add_legend(kWidth - 350, 17, 320, "0 cm", "10 cm and more", value_ramp().subspan(kFirstRampEntry));
  raster.add_scale_bar(viewpoint, 30, height - kFooter / 2, kLight);
  return raster.image();
}

}  // namespace camloc::mapping
