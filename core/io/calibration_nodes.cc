// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/io/calibration_nodes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <initializer_list>
#include <optional>

#include "core/io/text.h"

namespace camloc {

namespace {

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : static_cast<char>(c); });
  return text;
}

}  // namespace

Result<RgbdCamera> parse_foreign(const std::string& name, const std::function<void(RgbdCamera*)>& read) {
  try {
    RgbdCamera camera;
    camera.depth.width = 0;  // registered, until a reader finds a depth camera
    read(&camera);
    if (camera.is_depth_registered) camera.depth = camera.color;
    return camera;
  } catch (const BadCalibration& bad) {
    return bad.line > 0 ? line_error(name, bad.line, bad.what) : Status(ErrorCode::kInvalid, name + ": " + bad.what);
  } catch (const YAML::Exception& error) {
    return line_error(name, std::max(error.mark.line + 1, 1), error.msg);
  } catch (const std::exception& error) { return Status(ErrorCode::kInvalid, name + ": " + error.what()); }
}

void fail(const YAML::Node& node, const std::string& what) { throw BadCalibration{node.IsDefined() ? node.Mark().line + 1 : 0, what}; }

YAML::Node need(const YAML::Node& parent, const char* key) {
  YAML::Node node = parent[key];
  if (!node.IsDefined()) fail(parent, std::string("needs ") + key);
  return node;
}

double number(const YAML::Node& node, const char* key) {
  const std::optional<double> value = node.IsScalar() ? parse_double(node.Scalar()) : std::nullopt;
  if (!value || !std::isfinite(*value)) fail(node, std::string(key) + ": expected a number");
  return *value;
}

int pixels(const YAML::Node& node, const char* key) {
  const double value = number(node, key);
  if (value < 1 || value > 16384 || value != std::floor(value)) fail(node, std::string(key) + ": expected 1 to 16384 pixels");
  return static_cast<int>(value);
}

std::vector<double> numbers(const YAML::Node& node, const char* key) {
  if (!node.IsSequence() || node.size() > 16) fail(node, std::string(key) + ": expected a short list of numbers");
  std::vector<double> values;
  for (std::size_t i = 0; i < node.size(); ++i) values.push_back(number(node[i], key));
  return values;
}

/// A plain list, or OpenCV's and ROS's {rows, cols, data}.
std::vector<double> matrix(const YAML::Node& node, const char* key) { return numbers(node.IsMap() ? need(node, "data") : node, key); }

void set_distortion(const YAML::Node& node, LensModel lens, const std::vector<double>& values, Intrinsics* k) {
  // OpenCV's vectors have 4, 5, 8, 12 or 14 coefficients; the last are a thin prism's and a tilted sensor's.
  const bool is_long = values.size() >= 8 && std::any_of(values.begin() + 5, values.begin() + 8, [](double value) { return value != 0; });
  if (lens == LensModel::kBrownConrady && is_long) lens = LensModel::kRational;
  const std::size_t most = lens == LensModel::kEquidistant ? 4 : lens == LensModel::kRational ? 8 : 5;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i < most) k->distortion[i] = values[i];
    if (i >= most && values[i] != 0)
      fail(node, "distortion: " + std::to_string(values.size()) + " coefficients; at most " + std::to_string(most) + " are read");
  }
  const bool has_any = std::any_of(k->distortion.begin(), k->distortion.end(), [](double value) { return value != 0; });
  // Equidistant without coefficients is still not a pinhole.
  k->lens = has_any || lens == LensModel::kEquidistant ? lens : LensModel::kPinhole;
}

LensModel lens_of(const YAML::Node& node, const std::string& name) {
  const std::string model = lower(name);
  constexpr std::array kPlain = {"radtan", "plumb_bob", "rational_polynomial", "none", "pinhole", ""};
  constexpr std::array kWide = {"equidistant", "fisheye", "kannalabrandt8"};
  if (std::find(kPlain.begin(), kPlain.end(), model) != kPlain.end()) return LensModel::kBrownConrady;
  if (std::find(kWide.begin(), kWide.end(), model) != kWide.end()) return LensModel::kEquidistant;
  fail(node, "lens model " + in_quotes(name) + " is not known");
}

std::string scalar_or(const YAML::Node& parent, const char* key, const std::string& fallback) {
  const YAML::Node node = parent[key];
  return node.IsDefined() && node.IsScalar() ? node.Scalar() : fallback;
}

YAML::Node first_of(const YAML::Node& parent, std::initializer_list<const char*> keys) {
  for (const char* key : keys) {
    YAML::Node node = parent[key];
    if (node.IsDefined()) return node;
  }
  fail(parent, std::string("needs ") + *keys.begin());
}

YAML::Node find_any(const YAML::Node& parent, std::initializer_list<const char*> keys) {
  for (const char* key : keys) {
    YAML::Node node = parent[key];
    if (node.IsDefined()) return node;
  }
  return YAML::Node(YAML::NodeType::Undefined);
}

void set_size(const YAML::Node& parent, const char* key, const YAML::Node& width, const YAML::Node& height, const CameraHints& hints,
              Intrinsics* k) {
  if (width.IsDefined() && height.IsDefined()) {
    k->width = pixels(width, key), k->height = pixels(height, "image height");
    return;
  }
  if (hints.width < 1 || hints.height < 1) {
    fail(parent, std::string("needs ") + key +
                     ": the file does not say the size of the images; give it, as with 'camloc camera import FILE --size 640x480'");
  }
  k->width = hints.width, k->height = hints.height;
  hints.note("the size of the images is as given, the file does not say it");
}

}  // namespace camloc
