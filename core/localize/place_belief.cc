// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/localize/place_belief.h"

#include <algorithm>
#include <cmath>

#include "core/localize/motion_model.h"
#include "core/registration/rivals.h"

namespace camloc {
namespace {

/// A rival carried along with the camera is the same one within this.
constexpr RivalDistance kSameRival{.position_m = 1.0, .rotation_rad = 0.5};
/// What one view may say against a believed place, of all that it takes: no single view ends a belief.
constexpr double kMaxShareOfView = 0.5;
/// A lead up to here, of min_lead, says nothing: a look-alike that was mapped better has so much where the camera is not (building,
/// tracked right: down to -5.3 sigmas in single frames).
constexpr double kChanceShare = 0.5;

/// Log-odds, a thousand to one: what a claim that stands for confirmation_s is worth, and a lead of min_lead.
constexpr double kProof = 6.906754778648554;

double seconds(std::int64_t ns) { return 1e-9 * static_cast<double>(ns); }

}  // namespace

double PlaceBelief::limit() const {
  const double risk = std::clamp(numbers_.max_wrong_place_risk, 1e-12, 0.5);
  return std::log((1 - risk) / risk);
}

bool PlaceBelief::is_contested(std::int64_t stamp_ns) const {
  return contested_ns_ && seconds(stamp_ns - *contested_ns_) <= numbers_.ambiguity_memory_s;
}

// 1: what is seen from there is another view; 0: the same one.
double PlaceBelief::novelty(const Rigid3& T_map_from, const Rigid3& T_map_to) const {
  const double distance_m = (T_map_from.translation - T_map_to.translation).norm();
  const double angle_rad = rotation_distance_rad(T_map_from.rotation, T_map_to.rotation);
  return std::min(1.0, distance_m / numbers_.new_view_distance_m + angle_rad / numbers_.new_view_angle_rad);
}

void PlaceBelief::drop_claims(std::int64_t stamp_ns) {
  const auto is_over = [&](const Claim& claim) {
    return claim.log_odds < 0 || seconds(stamp_ns - claim.stamp_ns) > numbers_.max_tracking_gap_s;
  };
  const auto end = claims_.begin() + static_cast<std::ptrdiff_t>(num_claims_);
  num_claims_ = static_cast<std::size_t>(std::remove_if(claims_.begin(), end, is_over) - claims_.begin());
}

PlaceBelief::Claim* PlaceBelief::claim_of(std::int64_t stamp_ns, const Rigid3& T_map_camera) {
  for (Claim& claim : std::span(claims_).first(num_claims_)) {
    if (is_within_reach(numbers_, stamp_ns - claim.stamp_ns, claim.T_map_camera, T_map_camera)) return &claim;
  }
  return nullptr;
}

double PlaceBelief::claim(std::int64_t stamp_ns, const Rigid3& T_map_camera, double weight) {
  drop_claims(stamp_ns);
  const double waited_s = num_claims_ == 0 ? 0 : std::min(seconds(stamp_ns - claimed_ns_), numbers_.max_confirmation_gap_s);
  const double gain = weight * kProof * waited_s / numbers_.confirmation_s;
  claimed_ns_ = stamp_ns;
  Claim* const known = claim_of(stamp_ns, T_map_camera);
  for (Claim& other : std::span(claims_).first(num_claims_)) other.log_odds += &other == known ? gain : -gain;
  if (known != nullptr) {
    known->T_map_camera = T_map_camera;
    known->stamp_ns = stamp_ns;
    return known->log_odds;
  }
  drop_claims(stamp_ns);
  if (num_claims_ == claims_.size()) {
    const auto weakest =
        std::min_element(claims_.begin(), claims_.end(), [](const Claim& a, const Claim& b) { return a.log_odds < b.log_odds; });
    *weakest = claims_[--num_claims_];
  }
  claims_[num_claims_++] = {T_map_camera, stamp_ns, 0};
  return 0;
}

PlaceBelief::Rival* PlaceBelief::rival_at(const Rigid3& T_map_camera, const Rigid3& T_map_rival) {
  for (Rival& rival : std::span(rivals_).first(num_rivals_)) {
    const Rigid3 T_then_now = rival.T_map_camera.inverse() * T_map_camera;
    if (!are_rivals(rival.T_map_rival * T_then_now, T_map_rival, kSameRival)) return &rival;
  }
  return nullptr;
}

// A place is believed with the odds that it took: a rival starts from there.
double PlaceBelief::challenge(const Rigid3& T_map_camera, const Rigid3& T_map_rival, double lead) {
  Rival* rival = rival_at(T_map_camera, T_map_rival);
  double share = rival == nullptr ? 1 : novelty(rival->T_map_camera, T_map_camera);
  if (rival == nullptr) {
    rival = num_rivals_ < rivals_.size()
                ? &rivals_[num_rivals_++]
                : std::max_element(rivals_.begin(), rivals_.end(), [](const Rival& a, const Rival& b) { return a.log_odds < b.log_odds; });
    rival->log_odds = limit();
  }
  const double beyond_chance = std::copysign(std::max(0.0, std::abs(lead) / numbers_.min_lead - kChanceShare), lead);
  const double said = std::clamp(beyond_chance, -kMaxShareOfView, kMaxShareOfView);
  rival->log_odds = std::min(limit(), rival->log_odds + share * said * kProof);
  rival->T_map_camera = T_map_camera;
  rival->T_map_rival = T_map_rival;
  return rival->log_odds;
}

}  // namespace camloc
