// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/order_statistics.h"
#include "tools/common/text_format.h"
#include "tools/mapping/picture/map_picture.h"

namespace camloc::mapping {
namespace {

using tools::text_of;

constexpr double kSamePlaceM = 2.0, kSameWayRad = std::numbers::pi / 3;

/// Larger is worse; places of one outlook are compared.
double severity(const KeyframeLocalizability& place) {
  if (place.outlook == FixOutlook::kScanAgain) return place.position_sigma_m;
  const double explained = place.rival->num_inliers;
  return std::max(explained / std::max<std::uint32_t>(1, place.num_landmarks), place.rival->matched_share);
}

bool is_same_place(const MapView& map, std::uint32_t a, std::uint32_t b) {
  const Rigid3 first = map.keyframe_pose(a), second = map.keyframe_pose(b);
  const Eigen::Vector3d ahead = Eigen::Vector3d::UnitZ();
  const double cosine = (first.rotation * ahead).dot(second.rotation * ahead);
  return (first.translation - second.translation).norm() < kSamePlaceM && cosine > std::cos(kSameWayRad);
}

/// Two places that look like each other are one finding.
bool is_mirrored(const MapView& map, const std::vector<KeyframeLocalizability>& places, std::uint32_t a, std::uint32_t b) {
  if (places[a].outlook != FixOutlook::kLookAlike || places[b].outlook != FixOutlook::kLookAlike) return false;
  return is_same_place(map, places[a].rival->keyframe, b) || is_same_place(map, places[b].rival->keyframe, a);
}

std::string centimetres(double metres) { return metres < 10 ? text_of("%.1f cm", 100 * metres) : std::string("unbounded"); }

std::string format_share(const std::vector<KeyframeLocalizability>& places, FixOutlook outlook) {
  std::vector<double> landmarks, sigmas;
  for (const KeyframeLocalizability& place : places) {
    if (place.outlook != outlook) continue;
    landmarks.push_back(place.num_landmarks);
    sigmas.push_back(place.position_sigma_m);
  }
  std::string line = text_of("%-28s%6zu of %zu keyframes %6.1f %%", words_for(outlook), landmarks.size(), places.size(),
                             100.0 * static_cast<double>(landmarks.size()) / static_cast<double>(std::max<std::size_t>(1, places.size())));
  if (!landmarks.empty())
    line += text_of("   median %.0f landmarks, expected sigma %s", upper_median(landmarks), centimetres(upper_median(sigmas)).c_str());
  return line + "\n";
}

}  // namespace

const char* words_for(FixOutlook outlook) {
  constexpr const char* kWords[] = {"a fix is likely", "look-alike of another place", "scan again"};
  return kWords[static_cast<std::size_t>(outlook)];
}

std::vector<WeakPlace> find_weak_places(const MapView& map, const std::vector<KeyframeLocalizability>& places, std::size_t max_each) {
  std::vector<WeakPlace> all;
  for (const FixOutlook outlook : {FixOutlook::kScanAgain, FixOutlook::kLookAlike}) {
    std::vector<std::uint32_t> order;
    for (std::uint32_t k = 0; k < places.size(); ++k)
      if (places[k].outlook == outlook) order.push_back(k);
    std::stable_sort(order.begin(), order.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return severity(places[a]) > severity(places[b]); });
    std::vector<WeakPlace> found;
    for (const std::uint32_t keyframe : order) {
      const auto same = std::find_if(found.begin(), found.end(), [&](const WeakPlace& place) {
        return is_same_place(map, place.keyframe, keyframe) || is_mirrored(map, places, place.keyframe, keyframe);
      });
      if (same != found.end())
        ++same->num_keyframes;
      else
        found.push_back({keyframe, 1, outlook});
    }
    found.resize(std::min(found.size(), max_each));
    all.insert(all.end(), found.begin(), found.end());
  }
  return all;
}

std::string explain(const MapView& map, const KeyframeLocalizability& place) {
  if (place.outlook == FixOutlook::kLookAlike && place.rival) {
    const Eigen::Vector3d there = shown_position(map, place.rival->keyframe);
    return text_of("%u of %u landmarks also fit the place at (%.1f %.1f %.1f); put up something that tells them apart",
                   place.rival->num_inliers, place.num_landmarks, there.x(), there.y(), there.z());
  }
  switch (place.weakness) {
    case FixWeakness::kFewLandmarks: return text_of("only %u landmarks; scan slower, nearer, with more light", place.num_landmarks);
    case FixWeakness::kPoorSpread:
      return text_of("landmarks in only %.0f %% of the image; scan from farther back or turned", 100 * place.spread);
    case FixWeakness::kImprecise:
      return "expected sigma " + centimetres(place.position_sigma_m) + "; scan from nearer and from several sides";
    case FixWeakness::kNone: break;
  }
  return "";
}

Eigen::Vector3d shown_position(const MapView& map, std::uint32_t keyframe) {
  const Eigen::Vector3d position = map.keyframe_pose(keyframe).translation;
  return map.info().wcs ? map.info().wcs->T_wcs_map * position : position;
}

std::string format_places(const MapView& map, const std::vector<KeyframeLocalizability>& places, const std::vector<WeakPlace>& weak) {
  std::string text;
  for (const FixOutlook outlook : {FixOutlook::kLikely, FixOutlook::kLookAlike, FixOutlook::kScanAgain})
    text += format_share(places, outlook);
  if (weak.empty()) return text + "no weak places\n";
  text += text_of("\nworst places (metres, %s)\n   %9s %9s %9s  %9s  %s\n", map.info().wcs ? "site coordinates" : "coordinates of the map",
                  "x", "y", "z", "keyframes", "why and what to do");
  for (std::size_t i = 0; i < weak.size(); ++i) {
    const Eigen::Vector3d at = shown_position(map, weak[i].keyframe);
    text += text_of("%2zu %9.2f %9.2f %9.2f  %9u  %s: ", i + 1, at.x(), at.y(), at.z(), weak[i].num_keyframes, words_for(weak[i].outlook)) +
            explain(map, places[weak[i].keyframe]) + "\n";
  }
  return text;
}

}  // namespace camloc::mapping
