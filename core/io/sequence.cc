// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The image lists of a TUM folder are read line by line and colour and depth paired by time; of a 7-Scenes folder the names
// of the files are the index. Poses are in trajectory.cc.
#include "core/io/sequence.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <system_error>
#include <tuple>

#include "core/io/file_bytes.h"
#include "core/io/text.h"

namespace camloc {

namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kMaxGapNs = 20'000'000;  // between a colour image and its depth; TUM's own tools take the same

struct StampedFile {
  std::int64_t stamp_ns = 0;
  std::string path;
};

bool is_file(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored);
}

/// rgb.txt or depth.txt: "timestamp filename" a line. A comma may stand for the blank, as the benchmark's own tools allow.
Result<std::vector<StampedFile>> read_image_list(const fs::path& folder, const char* name) {
  const std::string list_path = (folder / name).string();
  Result<std::string> text = read_file_text(list_path);
  if (!text) return text.status();
  std::vector<StampedFile> files;
  for (const TextLine& line : content_lines(*text)) {
    const std::size_t end = line.text.find_first_of(" \t,");
    const std::string_view stamp_text = line.text.substr(0, end);
    const std::optional<std::int64_t> stamp_ns = parse_seconds_ns(stamp_text);
    if (!stamp_ns) return line_error(list_path, line.number, "stamp " + in_quotes(stamp_text) + " is not a time in seconds");
    const std::size_t begin = end == std::string_view::npos ? end : line.text.find_first_not_of(" \t,", end);
    if (begin == std::string_view::npos)
      return line_error(list_path, line.number, "expected 'timestamp filename', the file name is missing");
    if (!files.empty() && *stamp_ns <= files.back().stamp_ns) {
      return line_error(list_path, line.number, "stamp " + in_quotes(stamp_text) + " is not after the one above it; sort the file by time");
    }
    const std::string_view file = line.text.substr(begin);
    if (file.find('\0') != std::string_view::npos) return line_error(list_path, line.number, "bad file name " + in_quotes(file));
    const fs::path path = folder / fs::path(file);
    if (!is_file(path)) return line_error(list_path, line.number, "image " + path.string() + " does not exist");
    files.push_back({*stamp_ns, path.string()});
  }
  return files;
}

/// Each depth image goes to at most one colour image: closest pairs first.
void associate(const std::vector<StampedFile>& depths, std::vector<SequenceFrame>* frames) {
  std::vector<std::tuple<std::int64_t, std::size_t, std::size_t>> candidates;  // gap, colour, depth
  std::size_t first = 0;
  for (std::size_t color = 0; color < frames->size(); ++color) {
    const std::int64_t stamp_ns = (*frames)[color].stamp_ns;
    while (first < depths.size() && depths[first].stamp_ns < stamp_ns - kMaxGapNs) ++first;
    for (std::size_t depth = first; depth < depths.size() && depths[depth].stamp_ns <= stamp_ns + kMaxGapNs; ++depth) {
      candidates.emplace_back(std::abs(depths[depth].stamp_ns - stamp_ns), color, depth);
    }
  }
  std::sort(candidates.begin(), candidates.end());
  std::vector<bool> is_taken(depths.size(), false);
  for (const auto& [gap, color, depth] : candidates) {
    std::string& depth_path = (*frames)[color].depth_path;
    if (is_taken[depth] || !depth_path.empty()) continue;
    is_taken[depth] = true;
    depth_path = depths[depth].path;
  }
}

Result<Sequence> read_tum(const std::string& folder) {
  Result<std::vector<StampedFile>> colors = read_image_list(folder, "rgb.txt");
  if (!colors) return colors.status();
  if (colors->empty()) return Status(ErrorCode::kInvalid, folder + "/rgb.txt: lists no image");
  Sequence sequence{folder, "tum", {}};
  for (const StampedFile& color : *colors) { sequence.frames.push_back({sequence.frames.size(), color.stamp_ns, color.path, ""}); }
  if (!is_file(fs::path(folder) / "depth.txt")) return sequence;
  Result<std::vector<StampedFile>> depths = read_image_list(folder, "depth.txt");
  if (!depths) return depths.status();
  associate(*depths, &sequence.frames);
  return sequence;
}

/// NNNNNN of "frame-NNNNNN.color.png" (or jpg, jpeg).
std::optional<std::int64_t> frame_number(std::string_view name) {
  constexpr std::string_view kPrefix = "frame-";
  const std::size_t dot = name.find('.');
  if (!name.starts_with(kPrefix) || dot == std::string_view::npos) return std::nullopt;
  const std::string_view suffix = name.substr(dot);
  if (suffix != ".color.png" && suffix != ".color.jpg" && suffix != ".color.jpeg") return std::nullopt;
  const std::string_view digits = name.substr(kPrefix.size(), dot - kPrefix.size());
  if (digits.empty() || digits.size() > 9 || digits.find_first_not_of("0123456789") != std::string_view::npos) return std::nullopt;
  return parse_int(digits);
}

Result<Sequence> read_7scenes(const std::string& folder, double frame_rate_hz) {
  std::error_code error;
  std::map<std::int64_t, std::string> names;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    const std::optional<std::int64_t> number = frame_number(name);
    if (!number) continue;
    const auto [other, is_new] = names.emplace(*number, name);
    if (!is_new) return Status(ErrorCode::kInvalid, folder + ": " + other->second + " and " + name + " are the same frame");
  }
  if (error) return Status(ErrorCode::kIo, folder + ": " + error.message());
  if (names.empty()) {
    return Status(ErrorCode::kInvalid, folder + ": not a sequence (neither rgb.txt of TUM RGB-D nor frame-NNNNNN.color.* of 7-Scenes)");
  }
  Sequence sequence{folder, "7scenes", {}};
  for (const auto& [number, name] : names) {
    const fs::path color = fs::path(folder) / name;
    const std::string depth = (fs::path(folder) / (name.substr(0, name.find('.')) + ".depth.png")).string();
    const std::int64_t stamp_ns = std::llround(static_cast<double>(number) * 1e9 / frame_rate_hz);
    sequence.frames.push_back({sequence.frames.size(), stamp_ns, color.string(), is_file(depth) ? depth : ""});
  }
  return sequence;
}

}  // namespace

Result<Sequence> read_sequence(const std::string& folder, double frame_rate_hz) {
  std::error_code error;
  const fs::file_status status = fs::status(folder, error);
  if (!fs::exists(status)) return Status(ErrorCode::kNotFound, folder + ": no such folder");
  if (!fs::is_directory(status))
    return Status(ErrorCode::kInvalid, folder + ": not a folder; a sequence is a TUM RGB-D or 7-Scenes folder");
  return is_file(fs::path(folder) / "rgb.txt") ? read_tum(folder) : read_7scenes(folder, frame_rate_hz);
}

}  // namespace camloc
