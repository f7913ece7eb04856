// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Our own camera file. TableReader takes one table of it and keeps the first error, so that the sections below read as a list
// of their keys. See camera_file.h, and config/cameras for examples.
#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>

#include "core/io/camera_file.h"
#include "core/io/text.h"

namespace camloc {

namespace {

std::optional<double> finite_number(const toml::node& node) {
  const std::optional<double> found = node.is_number() ? node.value<double>() : std::nullopt;
  return found && std::isfinite(*found) ? found : std::nullopt;
}

std::string listed(std::initializer_list<std::string_view> words) {
  std::string list;
  for (const std::string_view word : words) list += std::string(list.empty() ? "" : ", ") + std::string(word);
  return list;
}

/// One table of the file. Keeps the first error; every getter after it does nothing.
class TableReader {
 public:
  TableReader(const std::string& name, const toml::table& table, std::string section, Status* status)
      : name_(name), table_(table), section_(std::move(section)), status_(*status) {}

  /// Any other key is an error.
  void allow(std::initializer_list<std::string_view> known) {
    for (const auto& [key, node] : table_) {
      if (std::find(known.begin(), known.end(), key.str()) != known.end()) continue;
      return fail(key.source().begin.line, "unknown key " + in_quotes(key.str()) + " in " + where() + "; known: " + listed(known));
    }
  }
  [[nodiscard]] bool has(std::string_view key) const { return table_.contains(key); }
  void number(std::string_view key, bool is_required, double* value) { read(key, is_required, "a number", value, finite_number); }
  void size(std::string_view key, int* value) {
    const auto pixels = [](const toml::node& node) -> std::optional<std::int64_t> {
      const std::optional<std::int64_t> found = node.is_integer() ? node.value<std::int64_t>() : std::nullopt;
      return found && *found >= 1 && *found <= 16384 ? found : std::nullopt;
    };
    read(key, true, "1 to 16384 pixels", value, pixels);
  }
  void flag(std::string_view key, bool* value) {
    read(key, false, "true or false", value, [](const toml::node& node) { return node.value_exact<bool>(); });
  }
  void text(std::string_view key, std::string* value) {
    read(key, false, "a text in quotes", value, [](const toml::node& node) { return node.value_exact<std::string>(); });
  }
  /// One of `choices`, by position.
  void choice(std::string_view key, std::initializer_list<std::string_view> choices, int* value) {
    std::string found;
    text(key, &found);
    if (!status_ || !has(key)) return;
    const auto match = std::find(choices.begin(), choices.end(), found);
    *value = static_cast<int>(match - choices.begin());
    if (match == choices.end()) fail(line_of(key), std::string(key) + ": " + in_quotes(found) + ", expected one of " + listed(choices));
  }
  /// Between `least` and `values.size()` numbers.
  template <std::size_t N>
  void numbers(std::string_view key, std::size_t least, std::size_t most, std::array<double, N>* values) {
    const toml::node* node = find(key, true);
    if (node == nullptr) return;
    const toml::array* array = node->as_array();
    const std::string expected = least == most ? std::to_string(most) : std::to_string(least) + " to " + std::to_string(most);
    if (array == nullptr || array->size() < least || array->size() > most) {
      return fail(line_of(*node), std::string(key) + ": expected " + expected + " numbers");
    }
    for (std::size_t i = 0; i < array->size(); ++i) {
      const toml::node& item = *array->get(i);
      const std::optional<double> found = finite_number(item);
      if (!found) return fail(line_of(item), std::string(key) + ": expected " + expected + " numbers");
      (*values)[i] = *found;
    }
  }
  void fail(std::uint32_t line, const std::string& what) {
    if (status_) status_ = line_error(name_, static_cast<int>(line), what);
  }
  [[nodiscard]] std::uint32_t line() const { return std::max<std::uint32_t>(table_.source().begin.line, 1); }
  [[nodiscard]] std::uint32_t line_of(std::string_view key) const { return line_of(*table_.get(key)); }

 private:
  static std::uint32_t line_of(const toml::node& node) { return node.source().begin.line; }
  [[nodiscard]] std::string where() const { return section_.empty() ? "the file" : "[" + section_ + "]"; }
  /// `parse` gives the value, or nothing where the node does not hold `expected`.
  template <typename Value, typename Parse>
  void read(std::string_view key, bool is_required, const char* expected, Value* value, const Parse& parse) {
    const toml::node* node = find(key, is_required);
    if (node == nullptr) return;
    const auto found = parse(*node);
    if (!found) return fail(line_of(*node), std::string(key) + ": expected " + expected);
    *value = static_cast<Value>(*found);
  }
  const toml::node* find(std::string_view key, bool is_required) {
    if (!status_) return nullptr;
    const toml::node* node = table_.get(key);
    if (node == nullptr && is_required) fail(line(), where() + " needs " + std::string(key));
    return node;
  }

  const std::string& name_;
  const toml::table& table_;
  std::string section_;
  Status& status_;
};

void read_intrinsics(TableReader* reader, Intrinsics* k) {
  reader->size("width", &k->width);
  reader->size("height", &k->height);
  reader->number("fx", true, &k->fx);
  reader->number("fy", true, &k->fy);
  reader->number("cx", true, &k->cx);
  reader->number("cy", true, &k->cy);
  int lens = 0;
  reader->choice("lens", {"pinhole", "brown_conrady", "equidistant", "rational"}, &lens);
  k->lens = static_cast<LensModel>(lens);
  if (k->lens == LensModel::kBrownConrady) reader->numbers("distortion", 4, 5, &k->distortion);
  if (k->lens == LensModel::kRational) reader->numbers("distortion", 8, 8, &k->distortion);
  if (k->lens == LensModel::kEquidistant) reader->numbers("distortion", 4, 4, &k->distortion);
  if (k->lens == LensModel::kPinhole && reader->has("distortion")) {
    reader->fail(reader->line_of("distortion"),
                 "distortion: a pinhole lens has none; name the lens (brown_conrady, equidistant, rational)");
  }
}

void read_depth(TableReader* reader, RgbdCamera* camera) {
  reader->allow({"registered", "width", "height", "fx", "fy", "cx", "cy", "lens", "distortion", "unit_m", "min_m", "max_m",
                 "noise_constant_m", "noise_quadratic_per_m"});
  bool is_registered = !reader->has("width");
  reader->flag("registered", &is_registered);
  camera->is_depth_registered = is_registered;
  if (is_registered) {
    for (const char* key : {"width", "height", "fx", "fy", "cx", "cy", "lens", "distortion"}) {
      if (reader->has(key))
        reader->fail(reader->line_of(key), std::string(key) + ": registered depth has the colour camera's intrinsics; leave it out");
    }
  } else {
    read_intrinsics(reader, &camera->depth);
  }
  reader->number("unit_m", false, &camera->depth_unit_m);
  reader->number("min_m", false, &camera->min_depth_m);
  reader->number("max_m", false, &camera->max_depth_m);
  reader->number("noise_constant_m", false, &camera->depth_noise.constant_m);
  reader->number("noise_quadratic_per_m", false, &camera->depth_noise.quadratic_per_m);
}

void read_extrinsics(TableReader* reader, Rigid3* T_color_depth) {
  reader->allow({"translation_m", "rotation_wxyz"});
  std::array<double, 3> t{};
  reader->numbers("translation_m", 3, 3, &t);
  std::array<double, 4> q{1, 0, 0, 0};
  if (reader->has("rotation_wxyz")) reader->numbers("rotation_wxyz", 4, 4, &q);
  Eigen::Quaterniond rotation(q[0], q[1], q[2], q[3]);
  const double norm = rotation.norm();
  if (!(std::abs(norm - 1) < 0.01)) reader->fail(reader->line(), "rotation_wxyz is not of unit length");
  // A quaternion that is of unit length to the last bits is left alone, so that what was written reads back the same.
  if (std::abs(norm - 1) > 1e-12) rotation.normalize();
  *T_color_depth = {rotation, {t[0], t[1], t[2]}};
}

void read_poses(TableReader* reader, RgbdCamera* camera) {
  reader->allow({"camera"});
  int which = 0;
  reader->choice("camera", {"color", "depth"}, &which);
  camera->poses_are_of_depth_camera = which == 1;
}

}  // namespace

Result<RgbdCamera> parse_camera_toml(const std::string& text, const std::string& name) {
  const toml::parse_result parsed = toml::parse(text, name);
  if (!parsed) { return line_error(name, static_cast<int>(parsed.error().source().begin.line), std::string(parsed.error().description())); }
  const toml::table& file = parsed.table();
  Status status;
  RgbdCamera camera;
  TableReader root(name, file, "", &status);
  root.allow({"name", "color", "depth", "extrinsics", "poses"});
  root.text("name", &camera.name);
  const auto section = [&](const char* key, bool is_required) -> std::optional<TableReader> {
    const toml::node* node = status ? file.get(key) : nullptr;
    if (node != nullptr && node->is_table()) return TableReader(name, *node->as_table(), key, &status);
    if (node != nullptr) root.fail(node->source().begin.line, std::string(key) + ": expected a table [" + key + "]");
    if (node == nullptr && is_required) root.fail(1, std::string("[") + key + "] is missing");
    return std::nullopt;
  };
  if (auto color = section("color", true)) {
    color->allow({"width", "height", "fx", "fy", "cx", "cy", "lens", "distortion"});
    read_intrinsics(&*color, &camera.color);
  }
  if (auto depth = section("depth", false)) read_depth(&*depth, &camera);
  if (auto extrinsics = section("extrinsics", !camera.is_depth_registered)) read_extrinsics(&*extrinsics, &camera.T_color_depth);
  if (auto poses = section("poses", false)) read_poses(&*poses, &camera);
  if (!status) return status;
  if (camera.is_depth_registered) camera.depth = camera.color;
  return camera;
}

}  // namespace camloc
