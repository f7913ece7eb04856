// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/merge/landmark_merging.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>

#include "core/features/hamming.h"

namespace camloc {
namespace {

constexpr double kRadiusPx = 2.5;        // of level 0, grows with the level
constexpr int kMaxDistance = 64;         // of any two appearances
constexpr double kMaxDepthSigmas = 3.0;  // tolerance along the optical axis
constexpr double kMinDepthToleranceM = 0.02, kMaxDepthToleranceM = 0.30;
constexpr float kMaxReferenceRatio = 2.0F;  // between the ranges of reference distances
// For a different appearance.
constexpr double kCloseRadiusPx = 1.5, kCloseDepthSigmas = 1.0, kCloseDepthToleranceM = 0.015;
constexpr double kMinDirectionCosine = 0.85;
constexpr int kMaxDifferentDistance = 96;   // of 256 bits; unrelated corners are 128 apart
constexpr int kAppearanceDistance = 48;     // a descriptor farther than this from all others is a further appearance
constexpr std::size_t kMaxDescriptors = 6;  // appearances a landmark may keep

constexpr double kVoxelM = 0.30;           // as wide as the largest tolerance along a ray
constexpr std::uint32_t kMaxSamples = 12;  // observations of a landmark that its descriptors were chosen from

using Voxel = std::array<std::int64_t, 3>;

Voxel voxel_of(const Eigen::Vector3f& p) {
  const auto cell = [](float v) { return static_cast<std::int64_t>(std::floor(static_cast<double>(v) / kVoxelM)); };
  return {cell(p.x()), cell(p.y()), cell(p.z())};
}

int closest_appearances(const MapLandmark& i, const MapLandmark& j) {
  int closest = 257;
  for (const Descriptor& d : i.descriptors) {
    for (const Descriptor& e : j.descriptors) closest = std::min(closest, hamming_distance(d, e));
  }
  return closest;
}

/// The keyframe that each landmark is seen from with the least distance.
std::vector<std::int64_t> nearest_views(const MapData& map) {
  std::vector<std::int64_t> nearest(map.landmarks.size(), -1);
  std::vector<double> least(map.landmarks.size(), std::numeric_limits<double>::infinity());
  for (std::size_t k = 0; k < map.keyframes.size(); ++k) {
    for (const std::uint32_t i : map.keyframes[k].landmarks) {
      const double distance = (map.landmarks[i].position_m.cast<double>() - map.keyframes[k].T_map_camera.translation).norm();
      if (distance >= least[i]) continue;
      least[i] = distance;
      nearest[i] = static_cast<std::int64_t>(k);
    }
  }
  return nearest;
}

/// How two landmarks lie to each other in a view.
struct Offset {
  double px = 0;  ///< in the image, in units of the landmark's scale
  double depth_m = 0;
  double sigma_m = 0;  ///< of that
};

class SameLandmarkFinder {
 public:
  SameLandmarkFinder(const MapData& a, const MapData& b) : a_(a), b_(b) {
    for (std::uint32_t i = 0; i < a.landmarks.size(); ++i) voxels_[voxel_of(a.landmarks[i].position_m)].push_back(i);
  }

  [[nodiscard]] std::vector<SameLandmark> find() const {
    struct Pair {
      double cost;
      SameLandmark same;
    };
    std::vector<Pair> pairs;
    const std::vector<std::int64_t> view_of = nearest_views(b_);
    for (std::uint32_t i = 0; i < b_.landmarks.size(); ++i) {
      if (view_of[i] < 0) continue;
      const Rigid3 T_camera_map = b_.keyframes[static_cast<std::size_t>(view_of[i])].T_map_camera.inverse();
      for_each_near(b_.landmarks[i].position_m, [&](std::uint32_t j) {
        const int distance = closest_appearances(b_.landmarks[i], a_.landmarks[j]);
        const Offset offset = offset_of(a_.landmarks[j], b_.landmarks[i], T_camera_map);
        if (is_alike(a_.landmarks[j], b_.landmarks[i], offset, distance))
          pairs.push_back({static_cast<double>(distance), {i, j}});
        else if (is_same_place(a_.landmarks[j], b_.landmarks[i], offset, distance))
          pairs.push_back({256 + offset.px, {i, j}});
      });
    }
    std::sort(pairs.begin(), pairs.end(),
              [](const Pair& p, const Pair& q) { return std::tie(p.cost, p.same.b, p.same.a) < std::tie(q.cost, q.same.b, q.same.a); });
    std::vector<std::uint8_t> is_taken_a(a_.landmarks.size(), 0), is_taken_b(b_.landmarks.size(), 0);
    std::vector<SameLandmark> result;
    for (const Pair& pair : pairs) {
      if (is_taken_a[pair.same.a] != 0 || is_taken_b[pair.same.b] != 0) continue;
      is_taken_a[pair.same.a] = is_taken_b[pair.same.b] = 1;
      result.push_back(pair.same);
    }
    std::sort(result.begin(), result.end(), [](const SameLandmark& s, const SameLandmark& t) { return s.b < t.b; });
    return result;
  }

 private:
  template <typename Visit>
  void for_each_near(const Eigen::Vector3f& p, const Visit& visit) const {
    const Voxel center = voxel_of(p);
    for (int offset = 0; offset < 27; ++offset) {
      const auto found = voxels_.find({center[0] + offset % 3 - 1, center[1] + offset / 3 % 3 - 1, center[2] + offset / 9 - 1});
      if (found == voxels_.end()) continue;
      for (const std::uint32_t j : found->second) visit(j);
    }
  }

  [[nodiscard]] Offset offset_of(const MapLandmark& in_a, const MapLandmark& in_b, const Rigid3& T_camera_map) const {
    const Eigen::Vector3d p = T_camera_map * in_b.position_m.cast<double>(), q = T_camera_map * in_a.position_m.cast<double>();
    Offset offset{std::numeric_limits<double>::infinity(), 0, 0};
    if (!(p.z() > 0.1 && q.z() > 0.1)) return offset;
    const double scale = std::max(1.0, static_cast<double>(in_b.min_reference_m) / p.norm());
    offset.px = (p.head<2>() / p.z() - q.head<2>() / q.z()).norm() * b_.camera.color.mean_focal_px() / scale;
    offset.depth_m = std::abs(p.z() - q.z());
    offset.sigma_m = b_.camera.depth_noise.sigma_m(p.z()) *
                     std::sqrt(1.0 / std::max(1U, in_a.num_observations) + 1.0 / std::max(1U, in_b.num_observations));
    return offset;
  }

  [[nodiscard]] bool is_alike(const MapLandmark& in_a, const MapLandmark& in_b, const Offset& offset, int distance) const {
    if (distance > kMaxDistance || offset.px > kRadiusPx) return false;
    const double tolerance = std::clamp(kMaxDepthSigmas * offset.sigma_m, kMinDepthToleranceM, kMaxDepthToleranceM);
    const float ratio = kMaxReferenceRatio;
    return offset.depth_m <= tolerance && in_b.min_reference_m <= in_a.max_reference_m * ratio &&
           in_a.min_reference_m <= in_b.max_reference_m * ratio;
  }

  [[nodiscard]] bool is_same_place(const MapLandmark& in_a, const MapLandmark& in_b, const Offset& offset, int distance) const {
    return distance <= kMaxDifferentDistance && offset.px <= kCloseRadiusPx &&
           offset.depth_m <= std::max(kCloseDepthSigmas * offset.sigma_m, kCloseDepthToleranceM) &&
           static_cast<double>(in_a.direction.dot(in_b.direction)) >= kMinDirectionCosine && in_b.min_reference_m <= in_a.max_reference_m &&
           in_a.min_reference_m <= in_b.max_reference_m;
  }

  const MapData& a_;
  const MapData& b_;
  std::map<Voxel, std::vector<std::uint32_t>> voxels_;
};

/// Mean direction, and a cone around it that holds both cones.
void merge_views(const MapLandmark& from, float from_share, MapLandmark* into) {
  const Eigen::Vector3f sum = from_share * from.direction + (1 - from_share) * into->direction;
  const Eigen::Vector3f direction = sum.norm() > 1e-6F ? Eigen::Vector3f(sum.normalized()) : into->direction;
  const auto angle = [](float cosine) { return std::acos(std::clamp(cosine, -1.0F, 1.0F)); };
  const float widest = std::max(angle(direction.dot(into->direction)) + angle(into->view_cosine),
                                angle(direction.dot(from.direction)) + angle(from.view_cosine));
  into->direction = direction;
  into->view_cosine = std::cos(std::min(widest, 3.14159F));
}

void merge_positions(const MapLandmark& from, MapLandmark* into) {
  const auto variance = [](const MapLandmark& l) { return std::max(l.position_sigma_m * l.position_sigma_m, 1e-6F); };
  const auto n = static_cast<float>(std::max(1U, into->num_observations)), m = static_cast<float>(std::max(1U, from.num_observations));
  const float w = n / variance(*into), v = m / variance(from);
  const float apart = (from.position_m - into->position_m).squaredNorm() / 3;
  into->position_m = (w * into->position_m + v * from.position_m) / (w + v);
  // Scatter of all observations: within either map, and between the maps.
  into->position_sigma_m = std::sqrt((n * variance(*into) + m * variance(from)) / (n + m) + n * m / ((n + m) * (n + m)) * apart);
}

}  // namespace

std::vector<SameLandmark> find_same_landmarks(const MapData& a, const MapData& b) { return SameLandmarkFinder(a, b).find(); }

std::uint32_t merge_landmark(const MapLandmark& from, const std::vector<std::uint32_t>& from_support, MapLandmark* into,
                             std::vector<std::uint32_t>* support) {
  const float share =
      static_cast<float>(from.num_observations) / static_cast<float>(std::max(1U, from.num_observations + into->num_observations));
  merge_views(from, share, into);
  merge_positions(from, into);
  into->num_observations += from.num_observations;
  into->min_reference_m = std::min(into->min_reference_m, from.min_reference_m);
  into->max_reference_m = std::max(into->max_reference_m, from.max_reference_m);

  struct Appearance {
    Descriptor descriptor;
    std::uint32_t support;
    float angle_rad;
    bool is_new;
  };
  std::vector<Appearance> all;
  for (std::size_t d = 0; d < into->descriptors.size(); ++d) all.push_back({into->descriptors[d], (*support)[d], into->angle_rad, false});
  for (std::size_t d = 0; d < from.descriptors.size(); ++d) all.push_back({from.descriptors[d], from_support[d], from.angle_rad, true});
  std::stable_sort(all.begin(), all.end(), [](const Appearance& i, const Appearance& j) { return i.support > j.support; });
  std::vector<Appearance> kept;
  for (const Appearance& appearance : all) {
    const auto near = std::find_if(kept.begin(), kept.end(), [&](const Appearance& k) {
      return hamming_distance(k.descriptor, appearance.descriptor) <= kAppearanceDistance;
    });
    if (near != kept.end())
      near->support += appearance.support;
    else if (kept.size() < kMaxDescriptors)
      kept.push_back(appearance);
  }
  std::stable_sort(kept.begin(), kept.end(), [](const Appearance& i, const Appearance& j) { return i.support > j.support; });
  into->descriptors.clear();
  support->clear();
  into->angle_rad = kept.front().angle_rad;
  for (const Appearance& appearance : kept) {
    into->descriptors.push_back(appearance.descriptor);
    support->push_back(appearance.support);
  }
  return static_cast<std::uint32_t>(std::count_if(kept.begin(), kept.end(), [](const Appearance& k) { return k.is_new; }));
}

std::vector<std::uint32_t> guess_support(const MapLandmark& landmark) {
  std::vector<std::uint32_t> support;
  for (std::size_t d = 0; d < landmark.descriptors.size(); ++d) {
    const std::uint32_t samples = std::min(std::max(1U, landmark.num_observations), kMaxSamples);
    // A further descriptor stands for half as many as the one before, and was kept because it stood for two at least.
    support.push_back(d == 0 ? samples : std::max(2U, samples >> (d + 1)));
  }
  return support;
}

}  // namespace camloc
