// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// See select_frames() in sequence.h. Bounds follow Python's slice.indices(): a negative bound counts from the end, then both are
// clipped into the sequence.
#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "core/io/sequence.h"
#include "core/io/text.h"

namespace camloc {

namespace {

/// Start, stop and step.
using Slice = std::array<std::optional<std::int64_t>, 3>;

Status bad(std::string_view part, const std::string& why) {
  return {ErrorCode::kInvalid, "frame selection " + in_quotes(part) + ": " + why};
}

Result<Slice> parse_slice(std::string_view part) {
  Slice bounds;
  std::size_t count = 0;
  for (std::string_view rest = part;;) {
    if (count == 3) return bad(part, "more than start:stop:step");
    const std::size_t colon = rest.find(':');
    const std::string_view bound = trimmed(rest.substr(0, colon));
    bounds[count] = parse_int(bound);
    if (!bound.empty() && !bounds[count]) return bad(part, in_quotes(bound) + " is not an integer; expected start:stop:step");
    ++count;
    if (colon == std::string_view::npos) break;
    rest.remove_prefix(colon + 1);
  }
  if (bounds[2] == 0) return bad(part, "step must not be zero");
  return bounds;
}

/// Where a bound lands among `size` items: counted from the end if negative, then clipped to [low, high].
std::int64_t clip_bound(std::int64_t bound, std::int64_t size, std::int64_t low, std::int64_t high) {
  if (bound < 0) bound += size;
  return std::clamp(bound, low, high);
}

void mark_slice(const Slice& slice, std::vector<bool>* marks) {
  const auto& [first, last, stride] = slice;
  const auto size = static_cast<std::int64_t>(marks->size());
  const std::int64_t step = std::clamp<std::int64_t>(stride.value_or(1), -size - 1, size + 1);
  const bool is_forward = step > 0;
  const std::int64_t low = is_forward ? 0 : -1;
  const std::int64_t high = is_forward ? size : size - 1;
  const std::int64_t start = first ? clip_bound(*first, size, low, high) : (is_forward ? low : high);
  const std::int64_t stop = last ? clip_bound(*last, size, low, high) : (is_forward ? high : low);
  for (std::int64_t i = start; is_forward ? i < stop : i > stop; i += step) (*marks)[static_cast<std::size_t>(i)] = true;
}

/// A lone integer is an index, and as in Python it must exist.
Status mark_index(std::string_view part, std::vector<bool>* marks) {
  const std::optional<std::int64_t> value = parse_int(part);
  if (!value) return bad(part, "is not start:stop:step and not an index");
  const auto size = static_cast<std::int64_t>(marks->size());
  if (*value < -size || *value >= size) return bad(part, "no such frame, the recording has " + std::to_string(size));
  (*marks)[static_cast<std::size_t>(*value < 0 ? *value + size : *value)] = true;
  return Status::ok();
}

Status mark_selection(std::string_view selection, std::vector<bool>* marks) {
  for (std::string_view rest = selection;;) {
    const std::size_t comma = rest.find(',');
    const std::string_view part = trimmed(rest.substr(0, comma));
    if (part.empty()) return bad(selection, "an empty part; expected start:stop:step[,...]");
    if (part.find(':') == std::string_view::npos) {
      if (Status status = mark_index(part, marks); !status) return status;
    } else {
      Result<Slice> slice = parse_slice(part);
      if (!slice) return slice.status();
      mark_slice(*slice, marks);
    }
    if (comma == std::string_view::npos) return Status::ok();
    rest.remove_prefix(comma + 1);
  }
}

}  // namespace

Result<std::vector<std::size_t>> select_frames(const std::string& include, const std::string& exclude, std::size_t num_frames) {
  std::vector<bool> included(num_frames, include.empty());
  std::vector<bool> excluded(num_frames, false);
  if (!include.empty()) {
    if (Status status = mark_selection(include, &included); !status) return status;
  }
  if (!exclude.empty()) {
    if (Status status = mark_selection(exclude, &excluded); !status) return status;
  }
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < num_frames; ++i) {
    if (included[i] && !excluded[i]) indices.push_back(i);
  }
  return indices;
}

}  // namespace camloc
