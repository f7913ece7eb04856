// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/evaluation/judged_poses.h"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>

#include "core/geometry/symmetric_system.h"
#include "core/io/file_bytes.h"

namespace camloc::tools {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kMaxBytes = std::size_t{1} << 30;

double worst_sigma(const Eigen::Matrix3d& covariance) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance, Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0.0, solver.eigenvalues().maxCoeff()));
}

RiskFeatures features_of(const Json& record) {
  PoseEvidence evidence;
  evidence.num_matches = record.at("matches").get<std::uint32_t>();
  evidence.num_inliers = record.at("inliers").get<std::uint32_t>();
  evidence.spread = record.at("spread").get<double>();
  evidence.num_with_depth = record.at("with_depth").get<std::uint32_t>();
  evidence.depth_agreement = record.at("depth_agreement").get<double>();
  evidence.num_map_depth = record.at("map_depth").get<std::uint32_t>();
  evidence.map_depth_agreement = record.at("map_depth_agreement").get<double>();
  Standing standing;
  standing.margin = record.at("margin").get<double>();
  if (!record.at("lead").is_null()) standing.lead = record.at("lead").get<double>();
  return risk_features(evidence, standing, record.at("tracked").get<bool>());
}

Rigid3 pose_of(const Json& pose) {
  const auto p = pose.at("position_m").get<std::array<double, 3>>();
  const auto q = pose.at("orientation_wxyz").get<std::array<double, 4>>();
  return {Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized(), {p[0], p[1], p[2]}};
}

Matrix6d covariance_of(const Json& record) {
  const auto rows = record.at("covariance").get<std::array<std::array<double, 6>, 6>>();
  Matrix6d covariance;
  for (int i = 0; i < 36; ++i) covariance(i / 6, i % 6) = rows[static_cast<std::size_t>(i / 6)][static_cast<std::size_t>(i % 6)];
  return covariance;
}

/// Nothing for a frame without a pose of its own or without a reference.
std::optional<JudgedPose> judge(const Json& record, const ReferencePose& reference, const Rigid3& T_reference_estimate) {
  const auto state = record.at("state").get<std::string>();
  if (state != "LOCALIZED" && state != "COARSE") return std::nullopt;
  const auto stamp_ns = static_cast<std::int64_t>(std::llround(1e9 * record.at("stamp").get<double>()));
  const auto truth = reference(stamp_ns);
  if (!truth) return std::nullopt;
  JudgedPose judged;
  judged.is_localized = state == "LOCALIZED";
  judged.num_inliers = record.at("inliers").get<std::uint32_t>();
  judged.features = features_of(record);
  judged.integrity_risk = record.at("integrity_risk").get<double>();
  const Json& protection = record.at("protection");
  const auto position_m = protection.at("position_m").get<std::array<double, 2>>();
  const auto rotation_rad = protection.at("rotation_rad").get<std::array<double, 2>>();
  judged.protection = {{position_m[0], rotation_rad[0]}, {position_m[1], rotation_rad[1]}};
  const Rigid3 T_reference_camera = T_reference_estimate * pose_of(record.at("pose"));
  const Matrix6d covariance = covariance_of(record);
  const Vector6d error = pose_error(*truth, T_reference_camera);
  judged.error_m = error.head<3>().norm();
  judged.error_rad = error.tail<3>().norm();
  judged.is_misleading = is_misleading(*truth, T_reference_camera);
  judged.nees = squared_mahalanobis(error, rotate_covariance(T_reference_estimate.rotation, covariance));
  judged.sigma_m = worst_sigma(covariance.topLeftCorner<3, 3>());
  judged.sigma_rad = worst_sigma(covariance.bottomRightCorner<3, 3>());
  return judged;
}

}  // namespace

Result<JudgedRun> judge_records(const std::string& path, const ReferencePose& reference, const Rigid3& T_reference_estimate) {
  const auto text = read_file_text(path, kMaxBytes);
  if (!text) return text.status();
  const Status unreadable{ErrorCode::kInvalid, path + ": is not what 'camloc localize --json' of this version writes"};
  const Json document = Json::parse(*text, nullptr, false);
  if (document.is_discarded() || !document.is_object()) return unreadable;
  JudgedRun run;
  // The library says by exception what a document lacks.
  try {
    for (const Json& record : document.at("frames")) {
      ++run.num_frames;
      if (auto judged = judge(record, reference, T_reference_estimate)) run.poses.push_back(*judged);
    }
  } catch (const Json::exception&) { return unreadable; }
  if (run.poses.empty())
    return Status(ErrorCode::kInvalid, path + ": has no pose at the times of the reference: is it of the same recording?");
  return run;
}

}  // namespace camloc::tools
