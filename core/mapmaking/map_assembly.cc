// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Rounds until the map fits: choose landmarks (landmark_budget), cover them with keyframes (keyframe_cover), give back as many
// further descriptors as the bytes allow, train the words (vocabulary), pack it and weigh the file. Too large: fewer
// landmarks; lists too long: fewer keyframes; room left over: more landmarks.
#include "core/mapmaking/map_assembly.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <string>

#include "core/map/map_writer.h"
#include "core/mapmaking/keyframe_cover.h"
#include "core/mapmaking/landmark_budget.h"
#include "core/mapmaking/vocabulary.h"

namespace camloc {
namespace {

constexpr int kMaxBudgetRounds = 24;
constexpr int kMaxFills = 4;
constexpr double kFullShare = 0.97, kNextShare = 0.98;  // of the budget: full enough, and what the next round aims at
// A view that alone sees fewer landmarks is no keyframe, those landmarks go; up to the second where the lists are too long.
constexpr std::uint32_t kMinKeyframeGain = 20, kMaxKeyframeGain = 200;
constexpr double kMaxBytesPerLandmark = 60;  // of the whole file: bounds the further descriptors and the keyframes' lists
// What a landmark costs in the file: its record, one descriptor, its share of words and lists.
constexpr double kRecordBytes = 16, kDescriptorBytes = 32, kListEntryBytes = 1.2, kInvertedEntryBytes = 3, kKeyframeBytes = 40,
                 kFixedBytes = 2048, kMinWordBytes = 64 * 36, kFurtherBytes = kDescriptorBytes + kInvertedEntryBytes;

std::size_t num_descriptors_of(const MapData& map) {
  std::size_t count = 0;
  for (const MapLandmark& landmark : map.landmarks) count += landmark.descriptors.size();
  return count;
}

class MapAssembler {
 public:
  MapAssembler(const MapParts& parts, const MapBuildOptions& options) : parts_(parts), options_(options) {}
  [[nodiscard]] Result<MapData> run();
  void count(const MapData& map, MapBuildReport* report) const;

 private:
  [[nodiscard]] std::vector<std::uint32_t> useful_landmarks(std::uint32_t max_landmarks) const;
  [[nodiscard]] MapData select(const std::vector<std::uint32_t>& kept, std::uint32_t min_gain);
  void choose_keyframes(const std::vector<std::uint32_t>& kept, std::uint32_t min_gain, MapData* map);
  void keep_descriptors(const std::vector<std::uint32_t>& kept, MapData* map) const;
  void add_words(MapData* map) const;
  [[nodiscard]] bool has_long_lists(const MapData& map, double file_bytes) const;
  [[nodiscard]] Status nothing_left() const;

  const MapParts& parts_;
  const MapBuildOptions& options_;
  std::uint32_t num_keyframes_before_ = 0;
  std::uint64_t file_bytes_ = 0;
};

std::vector<std::uint32_t> MapAssembler::useful_landmarks(std::uint32_t max_landmarks) const {
  return select_landmarks(parts_.views, parts_.landmarks.size(), max_landmarks, parts_.worth);
}

// Landmarks, keyframes and descriptors of a map of the kept landmarks; no words yet.
MapData MapAssembler::select(const std::vector<std::uint32_t>& kept, std::uint32_t min_gain) {
  MapData map;
  map.camera = parts_.camera;
  map.orb_scale_factor = options_.orb.scale_factor;
  map.orb_num_levels = static_cast<std::uint32_t>(options_.orb.num_levels);
  choose_keyframes(kept, min_gain, &map);
  return map;
}

// Keyframes that cover the kept landmarks, with their lists; landmarks that only a superfluous view would cover go.
void MapAssembler::choose_keyframes(const std::vector<std::uint32_t>& kept, std::uint32_t min_gain, MapData* map) {
  constexpr std::uint32_t kGone = 0xFFFFFFFF;
  std::vector<std::uint32_t> new_index(parts_.landmarks.size(), kGone);
  for (std::uint32_t i = 0; i < kept.size(); ++i) new_index[kept[i]] = i;
  std::vector<std::vector<std::uint32_t>> lists(parts_.views.size());
  num_keyframes_before_ = 0;
  for (std::size_t v = 0; v < lists.size(); ++v) {
    for (const ViewObservation& o : parts_.views[v]) {
      if (new_index[o.landmark] != kGone) lists[v].push_back(new_index[o.landmark]);
    }
    if (!lists[v].empty()) ++num_keyframes_before_;
  }
  const KeyframeCover cover = cover_with_keyframes(lists, kept.size(), min_gain);
  std::vector<std::uint32_t> covered, renumbered(kept.size(), kGone);
  for (std::uint32_t i = 0; i < kept.size(); ++i) {
    if (std::binary_search(cover.uncovered.begin(), cover.uncovered.end(), i)) continue;
    renumbered[i] = static_cast<std::uint32_t>(covered.size());
    covered.push_back(kept[i]);
  }
  for (const std::uint32_t v : cover.views) {
    MapKeyframe& keyframe = map->keyframes.emplace_back();
    keyframe.T_map_camera = parts_.poses[v];
    for (const std::uint32_t i : lists[v]) keyframe.landmarks.push_back(renumbered[i]);
    std::sort(keyframe.landmarks.begin(), keyframe.landmarks.end());
  }
  keep_descriptors(covered, map);
}

// One descriptor for each landmark; further ones, those that stand for the most observations first, as far as the bytes
// per landmark allow.
void MapAssembler::keep_descriptors(const std::vector<std::uint32_t>& kept, MapData* map) const {
  struct Further {
    std::uint32_t support, landmark;
    std::size_t descriptor;
  };
  std::vector<Further> further;
  for (std::uint32_t i = 0; i < kept.size(); ++i) {
    MapLandmark& landmark = map->landmarks.emplace_back(parts_.landmarks[kept[i]]);
    for (std::size_t d = 1; d < landmark.descriptors.size(); ++d) further.push_back({parts_.support[kept[i]][d], i, d});
    landmark.descriptors.resize(1);
  }
  std::stable_sort(further.begin(), further.end(), [](const Further& a, const Further& b) { return a.support > b.support; });
  std::size_t entries = 0;
  for (const MapKeyframe& keyframe : map->keyframes) entries += keyframe.landmarks.size();
  const auto n = static_cast<double>(kept.size());
  const double words = default_num_words(kept.size());
  double bytes = kFixedBytes + n * (kRecordBytes + kDescriptorBytes) + words * (kDescriptorBytes + 8) +
                 static_cast<double>(entries) * (kListEntryBytes + kInvertedEntryBytes) +
                 static_cast<double>(map->keyframes.size()) * kKeyframeBytes;
  double set_aside = options_.appearance_share * static_cast<double>(options_.max_bytes);
  if (options_.appearance_share > 0 && options_.max_bytes == 0) set_aside = std::numeric_limits<double>::infinity();
  for (const Further& f : further) {
    bytes += kFurtherBytes;
    if (f.support < 2 || bytes > kMaxBytesPerLandmark * n + set_aside) break;
    map->landmarks[f.landmark].descriptors.push_back(parts_.landmarks[kept[f.landmark]].descriptors[f.descriptor]);
  }
}

void MapAssembler::add_words(MapData* map) const {
  std::vector<Descriptor> descriptors;
  for (const MapLandmark& landmark : map->landmarks)
    descriptors.insert(descriptors.end(), landmark.descriptors.begin(), landmark.descriptors.end());
  map->words = train_vocabulary(descriptors, default_num_words(map->landmarks.size()));
  build_inverted_file(map);
}

void MapAssembler::count(const MapData& map, MapBuildReport* report) const {
  report->num_landmarks_before = static_cast<std::uint32_t>(parts_.landmarks.size());
  report->num_landmarks = static_cast<std::uint32_t>(map.landmarks.size());
  report->num_keyframes_before = num_keyframes_before_;
  report->num_keyframes = static_cast<std::uint32_t>(map.keyframes.size());
  report->num_descriptors = static_cast<std::uint32_t>(num_descriptors_of(map));
  report->num_words = static_cast<std::uint32_t>(map.words.size());
  report->file_bytes = file_bytes_;
}

// Rounds of choosing and weighing: fewer keyframes while their lists are too long, fewer landmarks while the file is too large,
// and more of them where much of the budget is left over.
Result<MapData> MapAssembler::run() {
  const auto max_bytes = static_cast<double>(options_.max_bytes);
  std::uint32_t max_landmarks = 0;
  std::uint32_t min_gain = kMinKeyframeGain;
  if (options_.max_bytes > 0)
    max_landmarks = static_cast<std::uint32_t>((1 - options_.appearance_share) * max_bytes / kMaxBytesPerLandmark) + 1;
  std::vector<std::uint32_t> kept = useful_landmarks(max_landmarks);
  std::optional<MapData> fitting;
  int num_fills = 0;
  for (int round = 0; round < kMaxBudgetRounds; ++round) {
    MapData map = select(kept, min_gain);
    if (map.landmarks.empty()) return nothing_left();
    if (map.keyframes.size() > map_format::kMaxKeyframes)
      return {ErrorCode::kUnsupported, "map: more than 65535 keyframes; select fewer frames"};
    add_words(&map);
    map.pose_sigma_m = parts_.pose_sigma_m;
    map.pose_sigma_rad = parts_.pose_sigma_rad;
    const auto bytes = serialize_map(map);
    if (!bytes.is_ok()) return bytes.status();
    const auto size = static_cast<double>(bytes.value().size());
    if (has_long_lists(map, size) && min_gain < kMaxKeyframeGain) {
      min_gain += min_gain / 2 + 1;
      continue;
    }
    const bool is_too_large = options_.max_bytes > 0 && bytes.value().size() > options_.max_bytes;
    if (!is_too_large && (!fitting || bytes.value().size() > file_bytes_)) {
      file_bytes_ = bytes.value().size();
      const bool is_cut = max_landmarks > 0 && kept.size() >= max_landmarks;
      if (!options_.fills_budget || !is_cut || size > kFullShare * max_bytes) return map;
      fitting = std::move(map);
    }
    if (fitting && ++num_fills > kMaxFills) break;
    max_landmarks = static_cast<std::uint32_t>(kNextShare * max_bytes / size * static_cast<double>(kept.size()));
    if (max_landmarks == 0) break;
    kept = useful_landmarks(max_landmarks);
  }
  if (fitting) return std::move(*fitting);
  return {ErrorCode::kInvalid,
          "map: " + std::to_string(options_.max_bytes) + " bytes are not enough for a map of these frames; raise the byte budget"};
}

Status MapAssembler::nothing_left() const {
  return {ErrorCode::kInvalid, options_.max_bytes > 0
                                   ? "map: no landmark fits into " + std::to_string(options_.max_bytes) + " bytes; raise the byte budget"
                                   : "map: no landmark is left; do the frames show textured surfaces with depth, and are the poses right?"};
}

// Small maps consist of headers and words: the bytes a landmark mean something from a few thousand on.
bool MapAssembler::has_long_lists(const MapData& map, double file_bytes) const {
  const auto num_landmarks = static_cast<double>(map.landmarks.size());
  const double further = options_.appearance_share > 0 ? kFurtherBytes * (static_cast<double>(num_descriptors_of(map)) - num_landmarks) : 0;
  return file_bytes - further > kMaxBytesPerLandmark * num_landmarks + kFixedBytes + kMinWordBytes;
}

}  // namespace

Result<MapData> assemble_map(const MapParts& parts, const MapBuildOptions& options, MapBuildReport* report) {
  MapAssembler assembler(parts, options);
  Result<MapData> map = assembler.run();
  if (map.is_ok() && report != nullptr) assembler.count(map.value(), report);
  return map;
}

}  // namespace camloc
