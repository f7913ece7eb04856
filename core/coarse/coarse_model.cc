// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/coarse/coarse_model.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>

#include "core/io/text.h"

namespace camloc {
namespace {

constexpr const char* kVersion = "1";

/// The shortest text that reads back as the same number, whatever the locale.
template <typename Number>
std::string number_text(Number value) {
  std::array<char, 40> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  return {text.data(), end};
}

Status wrong(const std::string& what) { return {ErrorCode::kInvalid, what}; }

/// Reads keys "camloc.*" and keeps the first error.
class Metadata {
 public:
  explicit Metadata(const std::map<std::string, std::string>& pairs) : pairs_(pairs) {}

  std::string text(const std::string& key) {
    const auto found = pairs_.find("camloc." + key);
    if (found == pairs_.end()) fail("its metadata has no camloc." + key + ": it was not made by camloc train");
    return found == pairs_.end() ? std::string() : found->second;
  }
  double number(const std::string& key, double smallest, double largest) {
    const std::string value = text(key);
    const std::optional<double> number = parse_double(value);
    if (number && *number >= smallest && *number <= largest) return *number;
    fail("camloc." + key + " = " + in_quotes(value) + " is no number from " + number_text(smallest) + " to " + number_text(largest));
    return smallest;
  }
  template <typename Int>
  Int integer(const std::string& key, double smallest, double largest) {
    const double value = number(key, smallest, largest);
    if (value != std::floor(value)) fail("camloc." + key + " is no whole number");
    return static_cast<Int>(value);
  }
  void fail(const std::string& what) {
    if (status_) status_ = wrong(what);
  }
  [[nodiscard]] const Status& status() const { return status_; }

 private:
  const std::map<std::string, std::string>& pairs_;
  Status status_;
};

std::string shape_text(std::span<const std::int64_t> shape) {
  std::string text;
  for (const std::int64_t side : shape) {
    if (!text.empty()) text += 'x';
    text += side < 0 ? "?" : std::to_string(side);
  }
  return text.empty() ? "no shape" : text;
}

Status check_graph(const OnnxModel& model, const NetworkInputLayout& layout) {
  if (model.inputs.size() != 1 || model.outputs.size() != 1)
    return wrong("it has " + std::to_string(model.inputs.size()) + " inputs and " + std::to_string(model.outputs.size()) +
                 " outputs; a coarse model has one of each");
  const std::array<std::int64_t, 4> input{1, layout.channels, layout.height, layout.width};
  const std::array<std::int64_t, 2> output{1, kCoarseOutputSize};
  if (!std::ranges::equal(model.inputs[0].shape, input))
    return wrong("its input is " + shape_text(model.inputs[0].shape) + ", its metadata says " + shape_text(input));
  if (!std::ranges::equal(model.outputs[0].shape, output))
    return wrong("its output is " + shape_text(model.outputs[0].shape) + "; a pose is " + shape_text(output));
  for (const OnnxTensor& tensor : model.weights) {
    if (!std::ranges::all_of(tensor.values, [](float value) { return std::isfinite(value); }))
      return wrong("weight " + in_quotes(tensor.name) + " has a value that is no finite number; its training went wrong");
  }
  return Status::ok();
}

bool is_map_id(const std::string& text) { return text.size() == 16 && text.find_first_not_of("0123456789abcdef") == std::string::npos; }

}  // namespace

std::string map_id_text(std::uint64_t map_id) {
  std::string text(16, '0');
  for (std::size_t i = 16; i-- > 0; map_id >>= 4) text[i] = "0123456789abcdef"[map_id & 15U];
  return text;
}

void set_coarse_info(const CoarseModelInfo& info, OnnxModel* model) {
  const auto set = [&](const char* key, const std::string& value) { model->metadata[std::string("camloc.") + key] = value; };
  set("version", kVersion);
  set("map_id", info.map_id);
  set("net", info.net);
  set("training", info.training);
  set("num_training_frames", number_text(info.num_training_frames));
  set("channels", number_text(info.layout.channels));
  set("width", number_text(info.layout.width));
  set("height", number_text(info.layout.height));
  set("focal_px", number_text(info.layout.focal_px));
  set("mean", number_text(info.layout.mean));
  set("scale", number_text(info.layout.scale));
  set("sigma_position_m", number_text(info.sigma_position_m));
  set("sigma_rotation_rad", number_text(info.sigma_rotation_rad));
  set("train_fx", number_text(info.train_fx));
  set("train_fy", number_text(info.train_fy));
  set("train_width", number_text(info.train_width));
  set("train_height", number_text(info.train_height));
}

Result<CoarseModelInfo> coarse_info_of(const OnnxModel& model) {
  Metadata data(model.metadata);
  if (data.text("version") != kVersion) data.fail("camloc.version is not 1: a newer camloc made it");
  CoarseModelInfo info;
  info.map_id = data.text("map_id");
  if (!is_map_id(info.map_id)) data.fail("camloc.map_id = " + in_quotes(info.map_id) + " is not 16 hexadecimal digits");
  info.net = data.text("net");
  info.training = data.text("training");
  info.num_training_frames = data.integer<std::uint32_t>("num_training_frames", 1, std::numeric_limits<std::uint32_t>::max());
  info.layout.channels = data.integer<int>("channels", 1, 4);
  info.layout.width = data.integer<int>("width", 8, 1024);
  info.layout.height = data.integer<int>("height", 8, 1024);
  info.layout.focal_px = static_cast<float>(data.number("focal_px", 1, 1e5));
  info.layout.mean = static_cast<float>(data.number("mean", -1e4, 1e4));
  info.layout.scale = static_cast<float>(data.number("scale", -1e4, 1e4));
  info.sigma_position_m = data.number("sigma_position_m", 1e-6, 1e4);
  info.sigma_rotation_rad = data.number("sigma_rotation_rad", 1e-6, 10);
  info.train_fx = static_cast<float>(data.number("train_fx", 1, 1e6));
  info.train_fy = static_cast<float>(data.number("train_fy", 1, 1e6));
  info.train_width = data.integer<int>("train_width", 1, 16384);
  info.train_height = data.integer<int>("train_height", 1, 16384);
  if (!data.status()) return data.status();
  if (Status status = info.layout.validate(); !status) return status;
  if (Status status = check_graph(model, info.layout); !status) return status;
  return info;
}

Result<CoarseModel> read_coarse_model(const std::string& path) {
  Result<OnnxModel> onnx = read_onnx(path);
  if (!onnx) return onnx.status();
  Result<CoarseModelInfo> info = coarse_info_of(*onnx);
  if (!info) return info.status().with_context(path);
  return CoarseModel{std::move(*onnx), std::move(*info)};
}

Status check_coarse_map(const CoarseModelInfo& info, std::uint64_t map_id) {
  const std::string text = map_id_text(map_id);
  if (info.map_id == text) return Status::ok();
  return wrong("the coarse model is for map " + info.map_id + ", and this map is " + text + "; train one for it: camloc train");
}

std::optional<Rigid3> coarse_pose(std::span<const float> output) {
  if (output.size() != kCoarseOutputSize) return std::nullopt;
  if (!std::ranges::all_of(output, [](float value) { return std::isfinite(value) && std::abs(value) < 1e6F; })) return std::nullopt;
  const Eigen::Quaterniond rotation(output[3], output[4], output[5], output[6]);
  if (rotation.norm() < 1e-3) return std::nullopt;
  return Rigid3{rotation.normalized(), {output[0], output[1], output[2]}};
}

Matrix6d coarse_covariance(const CoarseModelInfo& info) {
  Vector6d variances;
  variances.head<3>().setConstant(info.sigma_position_m * info.sigma_position_m);
  variances.tail<3>().setConstant(info.sigma_rotation_rad * info.sigma_rotation_rad);
  return variances.asDiagonal();
}

}  // namespace camloc
