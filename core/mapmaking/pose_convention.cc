// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/mapmaking/pose_convention.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>

#include "core/base/order_statistics.h"

namespace camloc {
namespace {

// What a registration of two frames and a good trajectory differ by: noise, and a share of the motion (rolling shutter, blur, depth scale).
constexpr double kToleranceM = 0.015, kToleranceRad = 0.01, kToleranceShare = 0.1;
constexpr double kMinMovedM = 0.03, kMinTurnedRad = 0.035;  // less says nothing about a convention
constexpr double kMaxScore = 1.5;                           // half of the motions are off by more: contradicted
constexpr double kWidenedScore = 0.5;                       // below, it is what registrations are off by
constexpr double kNotedScore = 0.7, kBetterShare = 0.4;     // contradicted, too, where another reading is so much better
constexpr double kMaxOffsetS = 0.6, kOffsetStepS = 0.02, kMaxGapS = 0.5;
constexpr double kMaxScaleSpread = 0.25;

using Motions = std::vector<std::pair<Rigid3, Rigid3>>;  ///< given and seen

PoseMisfit misfit_of(const Motions& motions) {
  std::vector<double> errors_m, errors_rad, scores;
  for (const auto& [given, seen] : motions) {
    errors_m.push_back((given.translation - seen.translation).norm());
    errors_rad.push_back(rotation_distance_rad(given.rotation, seen.rotation));
    const double moved_m = seen.translation.norm(), turned_rad = rotation_distance_rad(seen.rotation, Eigen::Quaterniond::Identity());
    scores.push_back(std::max(errors_m.back() / (kToleranceM + kToleranceShare * moved_m),
                              errors_rad.back() / (kToleranceRad + kToleranceShare * turned_rad)));
  }
  if (motions.empty()) return {0, 0, 1e9};
  return {upper_median(std::move(errors_m)), upper_median(std::move(errors_rad)), upper_median(std::move(scores))};
}

/// How a given pose might be meant.
struct Reading {
  const char* explanation;
  bool is_reordered, is_inverted;  ///< in this order
  Eigen::Quaterniond R_given_camera;
};

const Eigen::Quaterniond& opengl_axes() {
  static const Eigen::Quaterniond R(0, 1, 0, 0);
  return R;
}

const Eigen::Quaterniond& body_axes() {
  static const Eigen::Quaterniond R((Eigen::Matrix3d() << 0, 0, 1, -1, 0, 0, 0, -1, 0).finished());
  return R;
}

std::vector<Reading> readings() {
  const Eigen::Quaterniond same = Eigen::Quaterniond::Identity();
  return {
      {"inverted: they take points of the map to the camera, and T_map_camera is wanted", false, true, same},
      {"with the quaternion read as w x y z; the format is x y z w", true, false, same},
      {"with the quaternion read as w x y z, and inverted", true, true, same},
      {"with OpenGL's axes of the camera (y up, z backward); x right, y down, z forward are wanted", false, false, opengl_axes()},
      {"with a robot's axes (x forward, y left, z up); those of the camera (x right, y down, z forward) are wanted", false, false,
       body_axes()},
      {"inverted and with OpenGL's axes (y up, z backward)", false, true, opengl_axes()},
      {"inverted and with a robot's axes (x forward, y left, z up)", false, true, body_axes()},
      {"with the quaternion read as w x y z, and OpenGL's axes", true, false, opengl_axes()},
      {"with the quaternion read as w x y z, and a robot's axes", true, false, body_axes()},
  };
}

Rigid3 read_as(const Reading& reading, Rigid3 T) {
  if (reading.is_reordered) {
    const Eigen::Quaterniond q = T.rotation;
    T.rotation = Eigen::Quaterniond(q.x(), q.y(), q.z(), q.w());  // the file's first number was w
  }
  if (reading.is_inverted) T = T.inverse();
  T.rotation = T.rotation * reading.R_given_camera;
  return T;
}

/// Interpolated, where neighbours are near enough in time.
std::optional<Rigid3> pose_at(std::span<const GivenPose> poses, std::int64_t stamp_ns) {
  const auto after =
      std::lower_bound(poses.begin(), poses.end(), stamp_ns, [](const GivenPose& p, std::int64_t t) { return p.stamp_ns < t; });
  if (after == poses.end() || (after == poses.begin() && after->stamp_ns != stamp_ns)) return std::nullopt;
  if (after->stamp_ns == stamp_ns) return after->T_map_camera;
  const GivenPose& before = *(after - 1);
  const auto gap_ns = static_cast<double>(after->stamp_ns - before.stamp_ns);
  if (gap_ns > 1e9 * kMaxGapS) return std::nullopt;
  return interpolate(before.T_map_camera, after->T_map_camera, static_cast<double>(stamp_ns - before.stamp_ns) / gap_ns);
}

/// Keeps the best explanation so far.
class Search {
 public:
  Search(std::span<const GivenPose> poses, std::vector<SeenMotion> motions) : poses_(poses), motions_(std::move(motions)) {}

  [[nodiscard]] PoseMisfit misfit(const std::function<std::optional<Rigid3>(std::size_t)>& pose) const {
    Motions pairs;
    for (const SeenMotion& motion : motions_) {
      const auto from = pose(motion.from), to = pose(motion.to);
      if (from && to) pairs.emplace_back(from->inverse() * *to, motion.T_from_to);
    }
    if (pairs.size() < PoseVerdict::kMinMotions) return {0, 0, 1e9};
    return misfit_of(pairs);
  }
  void consider(const PoseMisfit& misfit, const std::string& explanation, PoseVerdict* verdict) const {
    if (verdict->fitting && verdict->fitting->score <= misfit.score) return;
    verdict->fitting = misfit;
    verdict->explanation = explanation;
  }
  void try_readings(PoseVerdict* verdict) const {
    for (const Reading& reading : readings()) {
      consider(misfit([&](std::size_t i) { return read_as(reading, poses_[i].T_map_camera); }), reading.explanation, verdict);
    }
  }
  void try_offsets(PoseVerdict* verdict) const {
    for (int step = 1; step * kOffsetStepS <= kMaxOffsetS + 1e-9; ++step) {
      for (const double offset_s : {step * kOffsetStepS, -step * kOffsetStepS}) {
        const auto offset_ns = static_cast<std::int64_t>(std::llround(1e9 * offset_s));
        const PoseMisfit found = misfit([&](std::size_t i) { return pose_at(poses_, poses_[i].stamp_ns + offset_ns); });
        char text[120];
        std::snprintf(text, sizeof(text), "with another clock: their stamps are %.2f s %s those of the images", std::abs(offset_s),
                      offset_s > 0 ? "behind" : "ahead of");
        consider(found, text, verdict);
      }
    }
  }
  /// One factor for all lengths.
  void try_scale(PoseVerdict* verdict) const {
    std::vector<double> ratios;
    for (const SeenMotion& motion : motions_) {
      const Rigid3 given = poses_[motion.from].T_map_camera.inverse() * poses_[motion.to].T_map_camera;
      if (motion.T_from_to.translation.norm() > kMinMovedM)
        ratios.push_back(given.translation.norm() / motion.T_from_to.translation.norm());
    }
    if (ratios.size() < PoseVerdict::kMinMotions) return;
    const double scale = upper_median(ratios);
    for (double& ratio : ratios) ratio = std::abs(ratio / scale - 1);
    if (!(scale > 0) || upper_median(std::move(ratios)) > kMaxScaleSpread) return;
    const PoseMisfit found = misfit([&](std::size_t i) {
      Rigid3 T = poses_[i].T_map_camera;
      T.translation /= scale;
      return std::optional(T);
    });
    char text[200];
    std::snprintf(text, sizeof(text),
                  "with another unit of length: they are %.3g times as long as depth says; are they in metres, and is unit_m of "
                  "the camera file right?",
                  scale);
    consider(found, text, verdict);
  }

 private:
  std::span<const GivenPose> poses_;
  std::vector<SeenMotion> motions_;
};

}  // namespace

bool PoseVerdict::is_contradicted() const {
  if (num_motions < kMinMotions) return false;
  return given.score > kMaxScore || (fitting && given.score > kNotedScore && !explanation.empty());
}

PoseVerdict judge_poses(std::span<const GivenPose> poses, std::span<const SeenMotion> motions) {
  PoseVerdict verdict;
  std::vector<SeenMotion> telling;
  std::vector<double> moved_m, turned_rad;
  for (const SeenMotion& motion : motions) {
    const double moved = motion.T_from_to.translation.norm();
    const double turned = rotation_distance_rad(motion.T_from_to.rotation, Eigen::Quaterniond::Identity());
    if (moved < kMinMovedM && turned < kMinTurnedRad) continue;
    telling.push_back(motion);
    moved_m.push_back(moved);
    turned_rad.push_back(turned);
  }
  verdict.num_motions = telling.size();
  if (telling.size() < PoseVerdict::kMinMotions) return verdict;
  verdict.moved_m = upper_median(std::move(moved_m));
  verdict.turned_rad = upper_median(std::move(turned_rad));
  const Search search(poses, std::move(telling));
  verdict.given = search.misfit([&](std::size_t i) { return std::optional(poses[i].T_map_camera); });
  if (verdict.given.score > kWidenedScore) {
    // The median of a length of three normal components is 1.538 of their standard deviation.
    verdict.sigma_m = verdict.given.translation_m / 1.538;
    verdict.sigma_rad = verdict.given.rotation_rad / 1.538;
  }
  if (verdict.given.score <= kNotedScore) return verdict;
  search.try_readings(&verdict);
  search.try_scale(&verdict);
  search.try_offsets(&verdict);
  const bool explains = verdict.fitting && verdict.fitting->score < kBetterShare * verdict.given.score && verdict.fitting->score < 1;
  if (!explains) verdict.explanation.clear(), verdict.fitting.reset();
  return verdict;
}

}  // namespace camloc
