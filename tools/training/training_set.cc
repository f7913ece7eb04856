// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/training/training_set.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace camloc::training {
namespace {

/// Pixels of a stored view per pixel of the input, and how much wider it looks.
constexpr int kFineness = 2;
constexpr double kMargin = 1.1;
/// Samples of a pixel, drawn apart along the blur.
constexpr int kSamples = 4;
const Eigen::Vector2d kSampleOffset[kSamples] = {{-0.25, -0.25}, {0.25, -0.25}, {-0.25, 0.25}, {0.25, 0.25}};
constexpr std::size_t kMinViews = 20;
constexpr double kMinSpread_m = 0.02, kMinSpread_rad = 0.02;

NetworkInputLayout fine_layout(const NetworkInputLayout& layout, bool has_depth) {
  const auto wider = [](int pixels) { return static_cast<int>(std::lround(kFineness * kMargin * pixels)); };
  return {.channels = has_depth ? 2 : 1,
          .width = wider(layout.width),
          .height = wider(layout.height),
          .focal_px = kFineness * layout.focal_px,
          .mean = 0,
          .scale = 1};
}

double uniform(std::mt19937_64* random) { return static_cast<double>((*random)() >> 11) * 0x1p-53; }
double within(double limit, std::mt19937_64* random) { return limit * (2 * uniform(random) - 1); }
/// Nearly normal, of standard deviation 1: the sum of four uniform numbers, out of the bits of one.
double nearly_normal(std::mt19937_64* random) {
  const std::uint64_t bits = (*random)();
  const auto part = [&](int shift) { return static_cast<double>((bits >> shift) & 0xFFFF); };
  constexpr double kMean = 2 * 65535.0, kDeviation = 65536 / 1.7320508075688772;
  return (part(0) + part(16) + part(32) + part(48) - kMean) / kDeviation;
}

double bilinear(const Image<std::uint8_t>& image, double u, double v) {
  u = std::clamp(u, 0.0, image.width - 1.001);
  v = std::clamp(v, 0.0, image.height - 1.001);
  const int x = static_cast<int>(u), y = static_cast<int>(v);
  const double du = u - x, dv = v - y;
  return (1 - dv) * ((1 - du) * image.at(x, y) + du * image.at(x + 1, y)) +
         dv * ((1 - du) * image.at(x, y + 1) + du * image.at(x + 1, y + 1));
}

/// Depth does not mix: the pixel nearest to it, none outside.
double nearest(const Image<std::uint8_t>& image, double u, double v) {
  const int x = static_cast<int>(std::lround(u)), y = static_cast<int>(std::lround(v));
  return x < 0 || y < 0 || x >= image.width || y >= image.height ? 0 : image.at(x, y);
}

/// What changes the grey values.
class Light {
 public:
  Light(const AugmentationLimits& limits, std::mt19937_64* random) {
    const double gain = std::exp(within(limits.exposure, random)), exponent = std::exp(within(limits.gamma, random));
    noise_ = limits.noise * uniform(random) * uniform(random);
    const double length = limits.blur_px * std::max(0.0, 2 * uniform(random) - 1), angle = M_PI * uniform(random);
    blur_ = length * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    for (std::size_t gray = 0; gray < tone_.size(); ++gray)
      tone_[gray] = 255 * std::pow(std::clamp(gain * static_cast<double>(gray) / 255, 0.0, 1.0), exponent);
  }
  [[nodiscard]] const Eigen::Vector2d& blur_px() const { return blur_; }
  [[nodiscard]] double operator()(double gray, std::mt19937_64* random) const {
    const auto below = static_cast<std::size_t>(std::clamp(gray, 0.0, 254.999));
    const double lit = tone_[below] + (gray - static_cast<double>(below)) * (tone_[below + 1] - tone_[below]);
    return std::clamp(noise_ > 0 ? lit + noise_ * nearly_normal(random) : lit, 0.0, 255.0);
  }

 private:
  std::array<double, 256> tone_{};
  Eigen::Vector2d blur_ = Eigen::Vector2d::Zero();
  double noise_ = 0;
};

}  // namespace

TrainingSet::TrainingSet(const RgbdCamera& camera, const NetworkInputLayout& layout, bool has_depth)
    : layout_(layout), fine_(fine_layout(layout, has_depth)), to_fine_(camera, fine_), buffer_(to_fine_.size()) {}

std::size_t TrainingSet::input_size() const { return layout_.size(); }

void TrainingSet::add(const Frame& frame, const Rigid3& T_map_camera, std::uint32_t recording) {
  to_fine_.fill(frame, buffer_);
  TrainingView view{.T_map_camera = T_map_camera, .frame = frame.sequence, .recording = recording};
  view.gray.resize(fine_.width, fine_.height);
  const auto byte = [](float value) { return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0F, 255.0F))); };
  const std::size_t size = view.gray.pixels.size();
  for (std::size_t i = 0; i < size; ++i) view.gray.pixels[i] = byte(buffer_[i]);
  if (fine_.channels == 2) {
    view.depth.resize(fine_.width, fine_.height);
    for (std::size_t i = 0; i < size; ++i) view.depth.pixels[i] = byte(255 * buffer_[size + i]);
  }
  views_.push_back(std::move(view));
}

Rigid3 TrainingSet::draw(std::size_t index, const AugmentationLimits& limits, std::mt19937_64* random, std::span<float> input) const {
  const TrainingView& view = views_[index];
  const Eigen::Vector3d turn(within(limits.turn_rad, random), within(limits.turn_rad, random), within(limits.roll_rad, random));
  const Eigen::Matrix3d R = exp_so3(turn).toRotationMatrix();  // stored camera from drawn camera
  const Light light(limits, random);
  const double center_u = 0.5 * (fine_.width - 1), center_v = 0.5 * (fine_.height - 1);
  const std::size_t size = static_cast<std::size_t>(layout_.width) * static_cast<std::size_t>(layout_.height);
  // Of the stored image, for a pixel of the input.
  const auto source_of = [&](double u, double v) -> Eigen::Vector2d {
    const double x = (u - 0.5 * (layout_.width - 1)) / layout_.focal_px, y = (v - 0.5 * (layout_.height - 1)) / layout_.focal_px;
    const Eigen::Vector3d ray = R.col(0) * x + R.col(1) * y + R.col(2);
    return {center_u + fine_.focal_px * ray.x() / ray.z(), center_v + fine_.focal_px * ray.y() / ray.z()};
  };
  const int num_gray = layout_.num_gray();
  for (int y = 0; y < layout_.height; ++y) {
    for (int x = 0; x < layout_.width; ++x) {
      double sum = 0;
      for (int k = 0; k < kSamples; ++k) {
        const Eigen::Vector2d at = Eigen::Vector2d(x, y) + kSampleOffset[k] + (k - 1.5) / 1.5 * light.blur_px();
        const Eigen::Vector2d source = source_of(at.x(), at.y());
        sum += bilinear(view.gray, source.x(), source.y());
      }
      const std::size_t pixel = static_cast<std::size_t>(y) * static_cast<std::size_t>(layout_.width) + static_cast<std::size_t>(x);
      const float value = (static_cast<float>(light(sum / kSamples, random)) - layout_.mean) * layout_.scale;
      for (int c = 0; c < num_gray; ++c) input[static_cast<std::size_t>(c) * size + pixel] = value;
      if (!layout_.has_depth()) continue;
      const Eigen::Vector2d at = source_of(x, y);
      const double depth = view.depth.view().empty() ? 0 : nearest(view.depth, at.x(), at.y());
      input[static_cast<std::size_t>(num_gray) * size + pixel] = static_cast<float>(depth / 255);
    }
  }
  return {view.T_map_camera.rotation * Eigen::Quaterniond(R), view.T_map_camera.translation};
}

Status check_training_views(std::span<const TrainingView> views) {
  if (views.size() < kMinViews)
    return {ErrorCode::kInvalid, std::to_string(views.size()) + " frames with a pose are too few to learn from; " +
                                     std::to_string(kMinViews) + " are the least, some hundreds are better"};
  double spread_m = 0, spread_rad = 0;
  for (const TrainingView& view : views) {
    spread_m = std::max(spread_m, (view.T_map_camera.translation - views[0].T_map_camera.translation).norm());
    spread_rad = std::max(spread_rad, rotation_distance_rad(view.T_map_camera.rotation, views[0].T_map_camera.rotation));
  }
  if (spread_m < kMinSpread_m && spread_rad < kMinSpread_rad)
    return {ErrorCode::kInvalid, "the camera stood still in all frames: there is nothing to tell poses by; train on a recording of a walk"};
  return Status::ok();
}

}  // namespace camloc::training
