// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>

#include "core/io/file_bytes.h"
#include "core/io/left_out.h"
#include "core/io/sequence.h"
#include "core/io/text.h"

namespace camloc {

namespace {

namespace fs = std::filesystem;

constexpr std::array kAssociationNames = {"associations.txt", "association.txt", "associate.txt", "associated.txt", "assoc.txt"};

bool is_file(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored);
}

std::string association_file(const std::string& folder) {
  for (const char* name : kAssociationNames) {
    if (is_file(fs::path(folder) / name)) return (fs::path(folder) / name).string();
  }
  return "";
}

/// 16 bits of grey a pixel, by the header of a PNG; nothing where it is no PNG.
std::optional<bool> is_depth_png(const fs::path& path) {
  constexpr std::size_t kHeader = 26;  // signature, length and name of IHDR, width, height, bits, kind
  std::ifstream file(path, std::ios::binary);
  std::array<char, kHeader> bytes{};
  if (!file.read(bytes.data(), kHeader) || std::string_view(bytes.data() + 1, 3) != "PNG") return std::nullopt;
  return bytes[24] == 16 && bytes[25] == 0;
}

/// Whether the second file of a pair is the depth image.
std::optional<bool> is_second_depth(const fs::path& folder, std::string_view first, std::string_view second) {
  const bool has_first = is_depth_png(folder / first).value_or(false), has_second = is_depth_png(folder / second).value_or(false);
  if (has_first != has_second) return has_second;
  const bool names_first = first.find("depth") != std::string_view::npos, names_second = second.find("depth") != std::string_view::npos;
  return names_first != names_second ? std::optional(names_second) : std::nullopt;
}

std::optional<std::int64_t> number_of_name(const fs::path& path) {
  const std::string stem = path.stem().string();
  const bool is_number = !stem.empty() && stem.size() <= 9 && stem.find_first_not_of("0123456789") == std::string::npos;
  return is_number ? parse_int(stem) : std::nullopt;
}

bool is_color_image(const fs::path& path) {
  const std::string extension = path.extension().string();
  return number_of_name(path) && (extension == ".jpg" || extension == ".jpeg" || extension == ".png");
}

}  // namespace

bool has_associations(const std::string& folder) { return !association_file(folder).empty(); }

Result<Sequence> read_associations(const std::string& folder, const SequenceOptions& /*options*/) {
  const std::string path = association_file(folder);
  Result<std::string> text = read_file_text(path);
  if (!text) return text.status();
  Sequence sequence{folder, "tum", {}, {}};
  std::optional<bool> is_color_first;
  LeftOut repeated;
  for (const TextLine& line : content_lines(*text)) {
    const std::vector<std::string_view> fields = split_fields(line.text);
    if (fields.size() != 4)
      return line_error(path, line.number, std::to_string(fields.size()) + " fields, expected 'stamp file stamp file'");
    for (const std::string_view file : {fields[1], fields[3]}) {
      if (file.find('\0') != std::string_view::npos || !is_file(fs::path(folder) / file)) {
        return line_error(path, line.number, "image " + in_quotes(file) + " does not exist");
      }
    }
    if (!is_color_first) is_color_first = is_second_depth(folder, fields[1], fields[3]);
    if (!is_color_first) {
      return line_error(path, line.number, "which is the depth image? Neither is a 16-bit grey PNG nor has 'depth' in its name");
    }
    const std::size_t color = *is_color_first ? 0 : 2, depth = 2 - color;
    const std::optional<std::int64_t> stamp_ns = parse_seconds_ns(fields[color]);
    if (!stamp_ns) return line_error(path, line.number, "stamp " + in_quotes(fields[color]) + " is not a time in seconds");
    if (!sequence.frames.empty() && *stamp_ns == sequence.frames.back().stamp_ns) {
      repeated.add(line.number);
      continue;
    }
    if (!sequence.frames.empty() && *stamp_ns < sequence.frames.back().stamp_ns) {
      return line_error(path, line.number, "stamp " + in_quotes(fields[color]) + " is before the one above it; sort the file by time");
    }
    const auto file = [&](std::size_t field) { return (fs::path(folder) / fs::path(fields[field])).string(); };
    sequence.frames.push_back({sequence.frames.size(), *stamp_ns, file(color + 1), file(depth + 1)});
  }
  if (sequence.frames.empty()) return Status(ErrorCode::kInvalid, path + ": lists no image");
  repeated.note(path, "pair", "with the stamp of the one before", &sequence.notes);
  return sequence;
}

bool has_scannet_layout(const std::string& folder) {
  std::error_code error;
  for (fs::directory_iterator entry(fs::path(folder) / "color", error), end; !error && entry != end; entry.increment(error)) {
    if (is_color_image(entry->path())) return true;
  }
  return false;
}

Result<Sequence> read_scannet(const std::string& folder, const SequenceOptions& options) {
  std::map<std::int64_t, fs::path> colors;
  std::error_code error;
  for (fs::directory_iterator entry(fs::path(folder) / "color", error), end; !error && entry != end; entry.increment(error)) {
    if (!is_color_image(entry->path())) continue;
    const auto [other, is_new] = colors.emplace(*number_of_name(entry->path()), entry->path());
    if (!is_new) {
      return Status(ErrorCode::kInvalid, folder + ": " + other->second.string() + " and " + entry->path().string() + " are the same frame");
    }
  }
  if (error) return Status(ErrorCode::kIo, folder + ": " + error.message());
  Sequence sequence{folder, "scannet", {}, {}};
  for (const auto& [number, color] : colors) {
    const std::string depth = (fs::path(folder) / "depth" / (color.stem().string() + ".png")).string();
    const std::int64_t stamp_ns = std::llround(static_cast<double>(number) * 1e9 / options.frame_rate_hz);
    sequence.frames.push_back({sequence.frames.size(), stamp_ns, color.string(), is_file(depth) ? depth : ""});
  }
  return sequence;
}

}  // namespace camloc
