// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// How sure is it, after all frames so far, that the camera is at this place and at none of its rivals? A sequential test (Wald,
// "Sequential tests of statistical hypotheses", 1945) over a few places: each frame adds what it says to the log-odds of one place
// against another, and a place is believed beyond odds that a stated risk asks for. Hypotheses move as the camera moves. Views of one
// and the same thing say it once: what is weighed is what is new since the camera last was elsewhere.
//
// What speaks for a place that still looks like another does not add up on purpose: a look-alike that was mapped better leads by a
// little in view after view, and a sum of that is believed (building: 2 of 200 starts were 8 m off). One view must decide by itself.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "core/geometry/rigid3.h"
#include "core/localize/localizer_numbers.h"

namespace camloc {

/// Not thread-safe. Allocates nothing; knows time from the stamps of frames alone.
class PlaceBelief {
 public:
  explicit PlaceBelief(const LocalizerNumbers& numbers) : numbers_(numbers) {}
  void reset() { *this = PlaceBelief(numbers_); }

  /// Log-odds beyond which the wrong place is believed with no more than LocalizerNumbers::max_wrong_place_risk.
  [[nodiscard]] double limit() const;

  /// A verified pose contradicts the motion so far; `weight` in [0, 1] says how strong a single one of its kind is. Log-odds of that
  /// claim against the place that was believed: it must stand for a while, and whatever claims another place speaks against it.
  [[nodiscard]] double claim(std::int64_t stamp_ns, const Rigid3& T_map_camera, double weight);
  /// The place that is believed was seen again.
  void forget_claims() { num_claims_ = 0; }

  /// The believed place is held against a look-alike: a camera there would be at `T_map_rival`, and `lead` is that of the believed
  /// place. Returns the log-odds of the believed place against it; the caller gives the place up when they are even.
  [[nodiscard]] double challenge(const Rigid3& T_map_camera, const Rigid3& T_map_rival, double lead);

  /// Two places explained a frame equally well; true for a while after.
  void note_contest(std::int64_t stamp_ns) { contested_ns_ = stamp_ns; }
  [[nodiscard]] bool is_contested(std::int64_t stamp_ns) const;

 private:
  static constexpr std::size_t kMaxClaims = 4, kMaxRivals = 8;

  struct Claim {
    Rigid3 T_map_camera;
    std::int64_t stamp_ns = 0;
    double log_odds = 0;
  };
  struct Rival {
    Rigid3 T_map_camera, T_map_rival;  ///< of the believed place and of this one, when they were last compared
    double log_odds = 0;
  };
  [[nodiscard]] double novelty(const Rigid3& T_map_from, const Rigid3& T_map_to) const;
  [[nodiscard]] Claim* claim_of(std::int64_t stamp_ns, const Rigid3& T_map_camera);
  [[nodiscard]] Rival* rival_at(const Rigid3& T_map_camera, const Rigid3& T_map_rival);
  void drop_claims(std::int64_t stamp_ns);

  LocalizerNumbers numbers_;
  std::array<Claim, kMaxClaims> claims_;
  std::size_t num_claims_ = 0;
  std::int64_t claimed_ns_ = 0;  ///< when any place was last claimed
  std::array<Rival, kMaxRivals> rivals_;
  std::size_t num_rivals_ = 0;
  std::optional<std::int64_t> contested_ns_;
};

}  // namespace camloc
