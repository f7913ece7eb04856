// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/evaluation/risk_chart.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/io/image_writer.h"
#include "tools/common/drawing.h"
#include "tools/common/text_format.h"

namespace camloc::tools {
namespace {

constexpr Rgb kBackground{252, 252, 250}, kInk{40, 40, 46}, kGrid{222, 223, 226}, kBand{236, 241, 246};
constexpr Rgb kMain{0, 114, 178}, kSecond{230, 159, 0}, kBad{213, 60, 40};
constexpr int kWidthPx = 1200, kHeightPx = 900;
constexpr double kTextPx = 10, kTitlePx = 12.5;

/// One chart: values from `low` to `high` on each axis, as they are drawn (logarithms where an axis is one).
struct Panel {
  int u, v, width, height;  ///< of the plotted area, pixels
  Eigen::Vector2d low, high;

  [[nodiscard]] Eigen::Vector2d operator()(double x, double y) const {
    const auto share = [](double value, double from, double to) { return std::clamp((value - from) / (to - from), 0.0, 1.0); };
    return {u + share(x, low.x(), high.x()) * width, v + height - share(y, low.y(), high.y()) * height};
  }
};

void draw_frame(ColorImage* canvas, const Panel& panel, const std::string& title, const std::string& x_name) {
  draw_text(canvas, panel.u, panel.v - 16, title, kTitlePx, kInk);
  draw_line(canvas, panel(panel.low.x(), panel.low.y()), panel(panel.high.x(), panel.low.y()), kInk, 1);
  draw_line(canvas, panel(panel.low.x(), panel.low.y()), panel(panel.low.x(), panel.high.y()), kInk, 1);
  draw_text(canvas, panel.u + (panel.width - text_width(x_name, kTextPx)) / 2, panel.v + panel.height + 42, x_name, kTextPx, kInk);
}

void draw_x_tick(ColorImage* canvas, const Panel& panel, double x, const std::string& text) {
  draw_line(canvas, panel(x, panel.low.y()), panel(x, panel.high.y()), kGrid, 1);
  const Eigen::Vector2d at = panel(x, panel.low.y());
  draw_text(canvas, static_cast<int>(at.x()) - text_width(text, kTextPx) / 2, static_cast<int>(at.y()) + 20, text, kTextPx, kInk);
}

void draw_y_tick(ColorImage* canvas, const Panel& panel, double y, const std::string& text) {
  draw_line(canvas, panel(panel.low.x(), y), panel(panel.high.x(), y), kGrid, 1);
  const Eigen::Vector2d at = panel(panel.low.x(), y);
  draw_text(canvas, static_cast<int>(at.x()) - 8 - text_width(text, kTextPx), static_cast<int>(at.y()) + 5, text, kTextPx, kInk);
}

/// Both axes logarithmic, 0.1 % to 100 %; the band is a factor of two. A bin without a wrong pose is drawn as a bar from zero to what can
/// be excluded with 95 % confidence, three in so many poses.
void draw_reliability(ColorImage* canvas, const RiskReport& report) {
  const Panel panel{90, 60, 460, 330, {-3, -3}, {0, 0}};
  for (double x = -3; x <= 0; x += 0.01) { draw_line(canvas, panel(x, x - std::log10(2)), panel(x, x + std::log10(2)), kBand, 2); }
  for (int decade = -3; decade <= 0; ++decade) {
    draw_x_tick(canvas, panel, decade, text_of("%g %%", std::pow(10.0, decade + 2)));
    draw_y_tick(canvas, panel, decade, text_of("%g %%", std::pow(10.0, decade + 2)));
  }
  draw_frame(canvas, panel, "misleading: observed over promised", "promised (band: within a factor of two; bar: no wrong pose)");
  for (const RiskBin& bin : report.bins) {
    if (bin.num_poses == 0) continue;
    const Rgb color = bin.num_poses < kMinPosesOfBin ? kGrid : kMain;
    const double x = std::log10(bin.promised);
    if (bin.num_misleading == 0) {
      draw_line(canvas, panel(x, -3), panel(x, std::log10(std::min(1.0, 3.0 / static_cast<double>(bin.num_poses)))), color, 3);
      continue;
    }
    const Eigen::Vector2d at = panel(x, std::log10(bin.observed()));
    draw_disc(canvas, at, 5, color);
    draw_text(canvas, static_cast<int>(at.x()) + 9, static_cast<int>(at.y()) + 14, text_of("%llu", llu(bin.num_poses)), kTextPx, kInk);
  }
}

/// Shares from 90 % on.
void draw_coverage(ColorImage* canvas, const RiskReport& report) {
  const Panel panel{690, 60, 460, 330, {0, 0.9}, {3, 1}};
  for (const double share : {0.9, 0.95, 0.98, 1.0}) draw_y_tick(canvas, panel, share, text_of("%g %%", 100 * share));
  draw_frame(canvas, panel, "LOCALIZED poses inside", "");
  const std::pair<const char*, double Coverage::*> bars[] = {{"95 % ellipsoid", &Coverage::ellipsoid_95},
                                                             {"95 % protection", &Coverage::protection_95},
                                                             {"99.9 % protection", &Coverage::protection_999}};
  for (int i = 0; i < 3; ++i) {
    const auto [name, value] = bars[i];
    for (int hardest = 0; hardest < 2; ++hardest) {
      const Coverage& coverage = hardest != 0 ? report.hardest : report.all;
      const Eigen::Vector2d top = panel(i + 0.2 + 0.3 * hardest, coverage.*value);
      const auto u = static_cast<int>(top.x()), v = static_cast<int>(top.y());
      draw_rectangle(canvas, u, v, panel.width / 11, panel.v + panel.height - v, hardest != 0 ? kSecond : kMain);
      draw_text(canvas, u + 3, std::min(v + 16, panel.v + panel.height - 4), text_of("%.1f", 100 * coverage.*value), kTextPx, kBackground);
    }
    draw_text(canvas, static_cast<int>(panel(i + 0.12, 0).x()), panel.v + panel.height + 20, name, kTextPx, kInk);
  }
  draw_text(canvas, panel.u, panel.v + panel.height + 42, "blue: all; orange: the quarter with the fewest inliers", kTextPx, kInk);
}

void draw_availability(ColorImage* canvas, const RiskReport& report) {
  double most = 0.01;
  for (const RiskThreshold& threshold : report.thresholds) most = std::max(most, threshold.misleading_share);
  const Panel panel{90, 510, 460, 310, {0, 0}, {1, 1.1 * most}};
  for (int i = 0; i <= 4; ++i) draw_x_tick(canvas, panel, 0.25 * i, text_of("%d %%", 25 * i));
  for (int i = 0; i <= 2; ++i) draw_y_tick(canvas, panel, 0.5 * i * most, text_of("%.2g %%", 50 * i * most));
  draw_frame(canvas, panel, "misleading share of poses below a risk", "availability: share of all frames, as the limit of the risk grows");
  for (std::size_t i = 0; i < report.thresholds.size(); ++i) {
    const RiskThreshold &here = report.thresholds[i], &before = report.thresholds[i == 0 ? 0 : i - 1];
    draw_line(canvas, panel(before.availability, before.misleading_share), panel(here.availability, here.misleading_share), kBad, 2.5);
  }
}

void draw_nees(ColorImage* canvas, const RiskReport& report) {
  double most = 12;
  for (const NeesBin& bin : report.nees) most = std::max(most, bin.mean);
  const Panel panel{690, 510, 460, 310, {0, 0}, {std::max(1.0, static_cast<double>(report.nees.size())), 1.1 * most}};
  for (int i = 0; i <= 3; ++i) draw_y_tick(canvas, panel, i * most / 3, text_of("%.1f", i * most / 3));
  draw_frame(canvas, panel, "mean NEES by inliers (honest: 6, the line)", "inliers, from");
  for (std::size_t i = 0; i < report.nees.size(); ++i) {
    const Eigen::Vector2d top = panel(static_cast<double>(i) + 0.2, report.nees[i].mean);
    const auto u = static_cast<int>(top.x()), v = static_cast<int>(top.y());
    draw_rectangle(canvas, u, v, panel.width / 14, panel.v + panel.height - v, kMain);
    draw_text(canvas, u, panel.v + panel.height + 20, std::to_string(report.nees[i].min_inliers), kTextPx, kInk);
  }
  draw_line(canvas, panel(0, 6), panel(panel.high.x(), 6), kBad, 1.5);
}

}  // namespace

Status write_risk_chart(const RiskReport& report, const std::string& path) {
  ColorImage canvas = blank_image(kWidthPx, kHeightPx, kBackground);
  draw_reliability(&canvas, report);
  draw_coverage(&canvas, report);
  draw_availability(&canvas, report);
  draw_nees(&canvas, report);
  return write_png(path, canvas);
}

}  // namespace camloc::tools
