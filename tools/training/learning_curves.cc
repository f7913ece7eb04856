// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/training/learning_curves.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/io/image_writer.h"
#include "tools/common/drawing.h"
#include "tools/common/text_format.h"

namespace camloc::training {
namespace {

using namespace tools;  // NOLINT(google-build-using-namespace): the pens

constexpr Rgb kBackground{252, 252, 250}, kInk{40, 40, 46}, kGrid{222, 223, 226}, kCurve{0, 114, 178}, kBest{213, 60, 40};
constexpr int kWidthPx = 900, kPanelPx = 210, kLeftPx = 90, kRightPx = 30, kTopPx = 50, kGapPx = 60;
constexpr double kTextPx = 10, kTitlePx = 12;

/// A round step, so that about five lie between the ends.
double round_step(double span) {
  const double rough = span / 5, power = std::pow(10, std::floor(std::log10(rough)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (factor * power >= rough) return factor * power;
  return 10 * power;
}

struct Curve {
  const char* title;
  std::vector<double> values;
};

void draw_panel(ColorImage* image, int top, const Curve& curve, std::optional<std::size_t> best) {
  const auto [low_at, high_at] = std::minmax_element(curve.values.begin(), curve.values.end());
  const double low = std::min(0.0, *low_at), high = std::max(*high_at, low + 1e-6);
  const auto count = static_cast<double>(std::max<std::size_t>(1, curve.values.size() - 1));
  const auto at = [&](double epoch, double value) {
    return Eigen::Vector2d(kLeftPx + (kWidthPx - kLeftPx - kRightPx) * epoch / count, top + kPanelPx * (1 - (value - low) / (high - low)));
  };
  draw_text(image, kLeftPx, top - 12, curve.title, kTitlePx, kInk);
  const double step = round_step(high - low);
  for (double value = step * std::ceil(low / step); value <= high; value += step) {
    draw_line(image, at(0, value), at(count, value), kGrid, 1);
    const std::string text = text_of("%g", std::abs(value) < 1e-9 ? 0 : value);
    draw_text(image, kLeftPx - 8 - text_width(text, kTextPx), static_cast<int>(at(0, value).y()) + 5, text, kTextPx, kInk);
  }
  for (double epoch = 0, every = std::max(1.0, round_step(count)); epoch <= count; epoch += every) {
    const std::string text = text_of("%g", epoch + 1);
    draw_text(image, static_cast<int>(at(epoch, low).x()) - text_width(text, kTextPx) / 2, top + kPanelPx + 18, text, kTextPx, kInk);
  }
  for (std::size_t i = 1; i < curve.values.size(); ++i)
    draw_line(image, at(static_cast<double>(i) - 1, curve.values[i - 1]), at(static_cast<double>(i), curve.values[i]), kCurve, 2);
  if (best) draw_disc(image, at(static_cast<double>(*best), curve.values[*best]), 5, kBest);
}

}  // namespace

Status write_learning_curves(std::span<const EpochRecord> epochs, std::optional<std::size_t> best_epoch, const std::string& path) {
  if (epochs.empty()) return {ErrorCode::kInvalid, "there is no epoch to draw"};
  Curve curves[] = {{"loss of the frames that are shown (augmented)", {}},
                    {"held-out frames: median error of the position, m (dot: the weights that were kept)", {}},
                    {"held-out frames: median error of the rotation, degrees", {}}};
  for (const EpochRecord& epoch : epochs) {
    curves[0].values.push_back(epoch.loss);
    curves[1].values.push_back(epoch.held_out.median_m);
    curves[2].values.push_back(epoch.held_out.median_deg);
  }
  ColorImage image = blank_image(kWidthPx, kTopPx + 3 * (kPanelPx + kGapPx), kBackground);
  int top = kTopPx;
  for (const Curve& curve : curves) {
    draw_panel(&image, top, curve, best_epoch);
    top += kPanelPx + kGapPx;
  }
  return write_png(path, image);
}

}  // namespace camloc::training
