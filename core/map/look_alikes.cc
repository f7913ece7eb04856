// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/map/look_alikes.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

namespace camloc {
namespace {

constexpr double kUnitsPerMetre = 2048, kUnitsPerRadian = 32767 / std::numbers::pi;

std::array<std::int16_t, 3> pack(const Eigen::Vector3d& v, double units) {
  std::array<std::int16_t, 3> packed{};
  for (std::size_t i = 0; i < 3; ++i)
    packed[i] = static_cast<std::int16_t>(std::lround(std::clamp(units * v[static_cast<Eigen::Index>(i)], -32767.0, 32767.0)));
  return packed;
}

Eigen::Vector3d unpack(const std::array<std::int16_t, 3>& packed, double units) {
  return Eigen::Vector3d(packed[0], packed[1], packed[2]) / units;
}

}  // namespace

map_format::RivalRecord pack_rival(std::uint32_t keyframe, const RivalPose& rival, const Rigid3& T_map_rival_keyframe) {
  const Rigid3 T_rival_camera = T_map_rival_keyframe.inverse() * rival.T_map_camera;
  return {static_cast<std::uint16_t>(keyframe), static_cast<std::uint16_t>(rival.keyframe),
          pack(T_rival_camera.translation, kUnitsPerMetre), pack(log_so3(T_rival_camera.rotation), kUnitsPerRadian)};
}

LookAlikes::LookAlikes(const MapView& map) : map_(&map), twins_(map.section(map_format::kTwins)) {
  const std::span<const std::byte> bytes = map.section(map_format::kRivals);
  records_.resize(bytes.size() / sizeof(map_format::RivalRecord));
  if (!records_.empty()) std::memcpy(records_.data(), bytes.data(), records_.size() * sizeof records_[0]);
  const std::size_t num_keyframes = map.keyframes().size();
  // A file that changes under the mapping must not lead out of it.
  std::erase_if(records_, [&](const auto& record) { return record.keyframe >= num_keyframes || record.rival >= num_keyframes; });
  std::stable_sort(records_.begin(), records_.end(), [](const auto& a, const auto& b) { return a.keyframe < b.keyframe; });
  begin_.assign(num_keyframes + 1, 0);
  for (const map_format::RivalRecord& record : records_) ++begin_[record.keyframe + 1U];
  for (std::size_t k = 0; k < num_keyframes; ++k) begin_[k + 1] += begin_[k];
}

RivalPose LookAlikes::rival(std::uint32_t keyframe, std::size_t i) const {
  const map_format::RivalRecord& record = records_[begin_[keyframe] + i];
  const Rigid3 T_rival_camera{exp_so3(unpack(record.rotation, kUnitsPerRadian)), unpack(record.position, kUnitsPerMetre)};
  return {record.rival, map_->keyframe_pose(record.rival) * T_rival_camera};
}

}  // namespace camloc
