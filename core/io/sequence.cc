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
#include <functional>
#include <limits>
#include <map>
#include <queue>
#include <system_error>
#include <tuple>
#include <utility>

#include "core/io/file_bytes.h"
#include "core/io/left_out.h"
#include "core/io/text.h"

namespace camloc {

namespace {

namespace fs = std::filesystem;

struct StampedFile {
  std::int64_t stamp_ns = 0;
  std::string path;
};

bool is_file(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored);
}

/// rgb.txt or depth.txt: "timestamp filename" a line. A comma may stand for the blank, as the benchmark's own tools allow.
Result<std::vector<StampedFile>> read_image_list(const fs::path& folder, const char* name, std::vector<std::string>* notes) {
  const std::string list_path = (folder / name).string();
  Result<std::string> text = read_file_text(list_path);
  if (!text) return text.status();
  std::vector<StampedFile> files;
  LeftOut repeated, timeless;
  for (const TextLine& line : content_lines(*text)) {
    const std::size_t end = line.text.find_first_of(" \t,");
    const std::string_view stamp_text = line.text.substr(0, end);
    if (is_missing_number(stamp_text)) {
      timeless.add(line.number);
      continue;
    }
    const std::optional<std::int64_t> stamp_ns = parse_seconds_ns(stamp_text);
    if (!stamp_ns) return line_error(list_path, line.number, "stamp " + in_quotes(stamp_text) + " is not a time in seconds");
    const std::size_t begin = end == std::string_view::npos ? end : line.text.find_first_not_of(" \t,", end);
    if (begin == std::string_view::npos)
      return line_error(list_path, line.number, "expected 'timestamp filename', the file name is missing");
    if (!files.empty() && *stamp_ns == files.back().stamp_ns) {
      repeated.add(line.number);
      continue;
    }
    if (!files.empty() && *stamp_ns < files.back().stamp_ns) {
      return line_error(list_path, line.number, "stamp " + in_quotes(stamp_text) + " is before the one above it; sort the file by time");
    }
    const std::string_view file = line.text.substr(begin);
    if (file.find('\0') != std::string_view::npos) return line_error(list_path, line.number, "bad file name " + in_quotes(file));
    const fs::path path = folder / fs::path(file);
    if (!is_file(path)) return line_error(list_path, line.number, "image " + path.string() + " does not exist");
    files.push_back({*stamp_ns, path.string()});
  }
  repeated.note(list_path, "image", "with the stamp of the one before", notes);
  timeless.note(list_path, "image", "without a time", notes);
  return files;
}

/// Colour and depth images as one list by time, with the neighbours of each among those that have no partner yet. The closest pair is
/// always one of neighbours (stamps of one kind differ), so that no other pair is ever looked at: however close together the stamps
/// are, there are fewer candidates than twice the images.
class PairsByTime {
 public:
  PairsByTime(const std::vector<StampedFile>& depths, const std::vector<SequenceFrame>& colors, std::int64_t max_gap_ns)
      : max_gap_ns_(max_gap_ns) {
    for (std::size_t color = 0, depth = 0; color < colors.size() || depth < depths.size();) {
      const bool is_color = depth == depths.size() || (color < colors.size() && colors[color].stamp_ns <= depths[depth].stamp_ns);
      images_.push_back(is_color ? Image{colors[color].stamp_ns, true, color} : Image{depths[depth].stamp_ns, false, depth});
      ++(is_color ? color : depth);
    }
    for (std::size_t i = 0; i < images_.size(); ++i) {
      images_[i].before = i == 0 ? kNone : i - 1;
      images_[i].after = i + 1 < images_.size() ? i + 1 : kNone;
      propose(i, images_[i].after);
    }
  }

  /// Colour and depth of the closest pair left, each once.
  std::optional<std::pair<std::size_t, std::size_t>> next() {
    while (!closest_first_.empty()) {
      const Candidate best = closest_first_.top();
      closest_first_.pop();
      if (images_[best.color].is_taken || images_[best.depth].is_taken) continue;
      remove(best.color);
      remove(best.depth);
      const auto [first, last] = std::minmax(best.color, best.depth);
      propose(images_[first].before, images_[last].after);
      return std::pair(images_[best.color].index, images_[best.depth].index);
    }
    return std::nullopt;
  }

 private:
  static constexpr std::size_t kNone = SIZE_MAX;
  struct Image {
    std::int64_t stamp_ns = 0;
    bool is_color = false;
    std::size_t index = 0;  // in its own list
    std::size_t before = kNone, after = kNone;
    bool is_taken = false;
  };
  struct Candidate {
    std::int64_t gap_ns = 0;
    std::size_t color = 0, depth = 0;  // in images_
    bool operator>(const Candidate& other) const {
      return std::tie(gap_ns, color, depth) > std::tie(other.gap_ns, other.color, other.depth);
    }
  };

  void propose(std::size_t a, std::size_t b) {
    if (a == kNone || b == kNone || images_[a].is_color == images_[b].is_color) return;
    const std::int64_t gap_ns = std::abs(images_[a].stamp_ns - images_[b].stamp_ns);
    if (gap_ns <= max_gap_ns_) closest_first_.push(images_[a].is_color ? Candidate{gap_ns, a, b} : Candidate{gap_ns, b, a});
  }
  void remove(std::size_t i) {
    images_[i].is_taken = true;
    if (images_[i].before != kNone) images_[images_[i].before].after = images_[i].after;
    if (images_[i].after != kNone) images_[images_[i].after].before = images_[i].before;
  }

  std::int64_t max_gap_ns_;
  std::vector<Image> images_;
  std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> closest_first_;
};

/// Each depth image goes to at most one colour image: closest pairs first.
void associate(const std::vector<StampedFile>& depths, std::int64_t max_gap_ns, std::vector<SequenceFrame>* frames) {
  PairsByTime pairs(depths, *frames, max_gap_ns);
  while (const auto pair = pairs.next()) (*frames)[pair->first].depth_path = depths[pair->second].path;
}

std::string milliseconds(std::int64_t ns) {
  const std::string tenths = std::to_string((ns + 50'000) / 100'000);
  return (tenths.size() > 1 ? tenths.substr(0, tenths.size() - 1) : "0") + "." + tenths.back() + " ms";
}

/// How far the depth image nearest in time is from each colour image that has none; ascending.
std::vector<std::int64_t> gaps_of_unpaired(const std::vector<SequenceFrame>& frames, const std::vector<StampedFile>& depths) {
  std::vector<std::int64_t> gaps;
  for (const SequenceFrame& frame : frames) {
    if (!frame.depth_path.empty()) continue;
    const auto after = std::lower_bound(depths.begin(), depths.end(), frame.stamp_ns,
                                        [](const StampedFile& file, std::int64_t stamp_ns) { return file.stamp_ns < stamp_ns; });
    std::int64_t gap = std::numeric_limits<std::int64_t>::max();
    if (after != depths.end()) gap = after->stamp_ns - frame.stamp_ns;
    if (after != depths.begin()) gap = std::min(gap, frame.stamp_ns - (after - 1)->stamp_ns);
    gaps.push_back(gap);
  }
  std::sort(gaps.begin(), gaps.end());
  return gaps;
}

/// A few colour images without depth are usual; one in ten and more is worth a word.
void note_pairing(const std::vector<StampedFile>& depths, const SequenceOptions& options, Sequence* sequence) {
  const std::vector<std::int64_t> gaps = gaps_of_unpaired(sequence->frames, depths);
  const std::size_t num_colors = sequence->frames.size();
  if (gaps.size() * 10 < num_colors || depths.empty()) return;
  const std::string counts = std::to_string(num_colors) + " colour and " + std::to_string(depths.size()) + " depth images";
  const std::string found = gaps.size() == num_colors
                                ? counts + ", none nearer than " + milliseconds(gaps.front())
                                : counts + ", " + std::to_string(gaps.size()) + " of the colour images without depth, typically " +
                                      milliseconds(gaps[gaps.size() / 2]) + " from the nearest";
  const std::string window = milliseconds(static_cast<std::int64_t>(options.pair_ms * 1e6));
  sequence->notes.push_back(sequence->folder + ": " + found + "; pairs may be " + window + " apart, pair_ms (--pair-ms) sets that");
}

Result<Sequence> read_tum(const std::string& folder, const SequenceOptions& options) {
  Sequence sequence{folder, "tum", {}, {}};
  Result<std::vector<StampedFile>> colors = read_image_list(folder, "rgb.txt", &sequence.notes);
  if (!colors) return colors.status();
  if (colors->empty()) return Status(ErrorCode::kInvalid, folder + "/rgb.txt: lists no image");
  for (const StampedFile& color : *colors) { sequence.frames.push_back({sequence.frames.size(), color.stamp_ns, color.path, ""}); }
  if (!is_file(fs::path(folder) / "depth.txt")) return sequence;
  Result<std::vector<StampedFile>> depths = read_image_list(folder, "depth.txt", &sequence.notes);
  if (!depths) return depths.status();
  associate(*depths, static_cast<std::int64_t>(options.pair_ms * 1e6), &sequence.frames);
  note_pairing(*depths, options, &sequence);
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

Result<Sequence> read_7scenes(const std::string& folder, const SequenceOptions& options) {
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
    return Status(ErrorCode::kInvalid, folder +
                                           ": not a sequence (no rgb.txt of TUM RGB-D, no associations.txt, no frame-NNNNNN.color.* of "
                                           "7-Scenes, no color/N.jpg of ScanNet)");
  }
  Sequence sequence{folder, "7scenes", {}, {}};
  for (const auto& [number, name] : names) {
    const fs::path color = fs::path(folder) / name;
    const std::string depth = (fs::path(folder) / (name.substr(0, name.find('.')) + ".depth.png")).string();
    const std::int64_t stamp_ns = std::llround(static_cast<double>(number) * 1e9 / options.frame_rate_hz);
    sequence.frames.push_back({sequence.frames.size(), stamp_ns, color.string(), is_file(depth) ? depth : ""});
  }
  return sequence;
}

}  // namespace

Result<Sequence> read_sequence(const std::string& folder, const SequenceOptions& options) {
  std::error_code error;
  const fs::file_status status = fs::status(folder, error);
  if (!fs::exists(status)) return Status(ErrorCode::kNotFound, folder + ": no such folder");
  if (!fs::is_directory(status))
    return Status(ErrorCode::kInvalid, folder + ": not a folder; a sequence is a TUM RGB-D or 7-Scenes folder");
  // The first layout that is there; 7-Scenes says what is missing.
  if (is_file(fs::path(folder) / "rgb.txt")) return read_tum(folder, options);
  if (has_associations(folder)) return read_associations(folder, options);
  return has_scannet_layout(folder) ? read_scannet(folder, options) : read_7scenes(folder, options);
}

}  // namespace camloc
