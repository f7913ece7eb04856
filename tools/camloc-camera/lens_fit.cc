// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/camloc-camera/lens_fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>

#include "core/base/order_statistics.h"
#include "tools/common/text_format.h"

namespace camloc::camera_tool {
namespace {

constexpr std::size_t kMinViews = 8;
constexpr double kMaxViewRatio = 2.5, kMinOutlierPx = 0.5;  // a view with more than so many times the median error, and so much
constexpr double kMaxDropped = 0.25;                        // of the views; more than that is no matter of single views
constexpr double kMinTiltRad = 0.17;     // some view must show the board at such an angle, else focal length and distance are one
constexpr double kMaxFocalSigma = 0.01;  // relative; above it the answer is not worth writing

struct Correspondences {
  std::vector<std::vector<cv::Point3f>> board;
  std::vector<std::vector<cv::Point2f>> image;
};

void append(const Board& board, const BoardCorners& corners, Correspondences* all) {
  all->board.emplace_back();
  all->image.emplace_back();
  for (std::size_t i = 0; i < corners.ids.size(); ++i) {
    const Eigen::Vector2d p = board.corner_m(corners.ids[i]);
    all->board.back().emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()), 0.0F);
    all->image.back().emplace_back(static_cast<float>(corners.pixels[i].x()), static_cast<float>(corners.pixels[i].y()));
  }
}

Rigid3 to_rigid(const cv::Mat& rotation_vector, const cv::Mat& translation) {
  const Eigen::Vector3d r(rotation_vector.at<double>(0), rotation_vector.at<double>(1), rotation_vector.at<double>(2));
  return {exp_so3(r), {translation.at<double>(0), translation.at<double>(1), translation.at<double>(2)}};
}

/// What OpenCV found, except for the deviations.
void set_lens(LensModel lens, const cv::Mat& matrix, const cv::Mat& distortion, const std::vector<cv::Mat>& rotations,
              const std::vector<cv::Mat>& translations, LensFit* fit) {
  Intrinsics& k = fit->intrinsics;
  k = {k.width, k.height, matrix.at<double>(0, 0), matrix.at<double>(1, 1), matrix.at<double>(0, 2), matrix.at<double>(1, 2), lens};
  const int num_coefficients = lens == LensModel::kPinhole ? 0 : lens == LensModel::kEquidistant ? 4 : 5;
  for (int i = 0; i < num_coefficients; ++i) k.distortion[static_cast<std::size_t>(i)] = distortion.at<double>(i);
  fit->T_camera_board.clear();
  for (std::size_t i = 0; i < rotations.size(); ++i) fit->T_camera_board.push_back(to_rigid(rotations[i], translations[i]));
}

/// OpenCV 4.6 divides the squared error by the number of points less that of the parameters, but every point is two measurements.
double deviation_correction(const Correspondences& points, int num_lens_parameters) {
  double num_points = 0;
  for (const auto& view : points.image) num_points += static_cast<double>(view.size());
  const double num_parameters = num_lens_parameters + 6.0 * static_cast<double>(points.image.size());
  return std::sqrt((num_points - num_parameters) / (2 * num_points - num_parameters));
}

/// Brown's lens, or none. `has_k3`: the sixth power of the radius, too.
void solve_brown(const Correspondences& points, bool has_lens, bool has_k3, LensFit* fit) {
  Intrinsics& k = fit->intrinsics;
  cv::Mat matrix, distortion, sigma, pose_sigma, view_errors;
  std::vector<cv::Mat> rotations, translations;
  int flags = has_k3 ? 0 : cv::CALIB_FIX_K3;
  if (!has_lens) flags |= cv::CALIB_FIX_K1 | cv::CALIB_FIX_K2 | cv::CALIB_FIX_K3 | cv::CALIB_ZERO_TANGENT_DIST;
  cv::calibrateCamera(points.board, points.image, {k.width, k.height}, matrix, distortion, rotations, translations, sigma, pose_sigma,
                      view_errors, flags, {cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 100, 1e-10});
  set_lens(has_lens ? LensModel::kBrownConrady : LensModel::kPinhole, matrix, distortion, rotations, translations, fit);
  const double correction = deviation_correction(points, 4 + (has_lens ? 4 : 0) + (has_k3 ? 1 : 0));
  for (int i = 0; i < 4; ++i) fit->sigma[static_cast<std::size_t>(i)] = correction * sigma.at<double>(i);
  for (int i = 0; i < 5; ++i) fit->distortion_sigma[static_cast<std::size_t>(i)] = has_lens ? correction * sigma.at<double>(4 + i) : 0;
}

/// OpenCV gives no deviations for this model: the inverse of the normal equations, the poses of the board eliminated.
void equidistant_sigmas(const std::vector<std::vector<cv::Point3d>>& board, const std::vector<std::vector<cv::Point2d>>& image,
                        const std::vector<cv::Mat>& rotations, const std::vector<cv::Mat>& translations, LensFit* fit) {
  using Matrix8d = Eigen::Matrix<double, 8, 8>;
  const Intrinsics& k = fit->intrinsics;
  const cv::Matx33d matrix(k.fx, 0, k.cx, 0, k.fy, k.cy, 0, 0, 1);
  const cv::Vec4d distortion(k.distortion[0], k.distortion[1], k.distortion[2], k.distortion[3]);
  Matrix8d information = Matrix8d::Zero();
  double sum = 0, num_values = -8;
  for (std::size_t view = 0; view < board.size(); ++view) {
    cv::Mat projected, jacobian;
    cv::fisheye::projectPoints(board[view], projected, rotations[view], translations[view], matrix, distortion, 0, jacobian);
    const Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> J(jacobian.ptr<double>(), jacobian.rows,
                                                                                                     jacobian.cols);
    const Eigen::MatrixXd lens = J.leftCols(8), pose = J.middleCols(8, 6);  // f c k | rotation translation | skew
    const Eigen::MatrixXd cross = lens.transpose() * pose;
    information += lens.transpose() * lens - cross * (pose.transpose() * pose).ldlt().solve(cross.transpose());
    for (int i = 0; i < static_cast<int>(board[view].size()); ++i) {
      const cv::Vec2d p = projected.at<cv::Vec2d>(i);
      sum +=
          std::pow(p[0] - image[view][static_cast<std::size_t>(i)].x, 2) + std::pow(p[1] - image[view][static_cast<std::size_t>(i)].y, 2);
    }
    num_values += 2.0 * static_cast<double>(board[view].size()) - 6;
  }
  const Matrix8d covariance = information.ldlt().solve(Matrix8d::Identity()) * (sum / std::max(1.0, num_values));
  for (int i = 0; i < 4; ++i) {
    fit->sigma[static_cast<std::size_t>(i)] = std::sqrt(std::max(0.0, covariance(i, i)));
    fit->distortion_sigma[static_cast<std::size_t>(i)] = std::sqrt(std::max(0.0, covariance(4 + i, 4 + i)));
  }
}

void solve_equidistant(const Correspondences& points, LensFit* fit) {
  Intrinsics& k = fit->intrinsics;
  std::vector<std::vector<cv::Point3d>> board;
  std::vector<std::vector<cv::Point2d>> image;
  for (std::size_t view = 0; view < points.board.size(); ++view) {
    board.emplace_back(points.board[view].begin(), points.board[view].end());
    image.emplace_back(points.image[view].begin(), points.image[view].end());
  }
  cv::Mat matrix, distortion;
  std::vector<cv::Mat> rotations, translations;
  // OpenCV's own start (the focal length of a 180 degree lens) sometimes ends in a failed assertion: start elsewhere then.
  for (const double focal_per_width : {0.0, 0.45, 0.3, 0.7}) {
    int flags = cv::fisheye::CALIB_RECOMPUTE_EXTRINSIC | cv::fisheye::CALIB_FIX_SKEW;
    if (focal_per_width > 0) {
      flags |= cv::fisheye::CALIB_USE_INTRINSIC_GUESS;
      const double focal_px = focal_per_width * k.width;
      matrix = cv::Mat(cv::Matx33d(focal_px, 0, 0.5 * (k.width - 1), 0, focal_px, 0.5 * (k.height - 1), 0, 0, 1));
      distortion = cv::Mat::zeros(4, 1, CV_64F);
    }
    try {
      cv::fisheye::calibrate(board, image, {k.width, k.height}, matrix, distortion, rotations, translations, flags,
                             {cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 200, 1e-10});
      break;
    } catch (const cv::Exception&) {
      if (focal_per_width > 0.6) throw;  // the last one
    }
  }
  set_lens(LensModel::kEquidistant, matrix, distortion, rotations, translations, fit);
  equidistant_sigmas(board, image, rotations, translations, fit);
}

Status solve(const Board& board, std::span<const BoardView> views, LensModel lens, LensFit* fit) {
  Correspondences points;
  for (const std::size_t view : fit->used) append(board, views[view].corners, &points);
  try {
    if (lens == LensModel::kEquidistant) {
      solve_equidistant(points, fit);
    } else {
      const bool has_lens = lens == LensModel::kBrownConrady;
      solve_brown(points, has_lens, has_lens, fit);
      // A coefficient that the views do not determine only makes the corners of the image worse.
      if (has_lens && std::abs(fit->intrinsics.distortion[4]) < 2 * fit->distortion_sigma[4]) solve_brown(points, true, false, fit);
    }
  } catch (const cv::Exception&) {
    return {ErrorCode::kInvalid, "the views contradict each other or are all alike; show the board at other places and angles"};
  }
  if (fit->intrinsics.validate()) return Status::ok();
  return {ErrorCode::kInvalid,
          "the views do not determine a lens; tilt the board 20 to 45 degrees to all sides, and show it near and in the corners"};
}

/// Root of the mean squared length, 0 for none.
double rms(std::span<const Eigen::Vector2d> errors) {
  double sum = 0;
  for (const Eigen::Vector2d& error : errors) sum += error.squaredNorm();
  return errors.empty() ? 0 : std::sqrt(sum / static_cast<double>(errors.size()));
}

void measure(const Board& board, std::span<const BoardView> views, LensFit* fit) {
  fit->view_rms_px.clear();
  fit->max_tilt_rad = 0;
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < fit->used.size(); ++i) {
    const auto errors = reprojection_errors(board, views[fit->used[i]].corners, fit->intrinsics, fit->T_camera_board[i]);
    fit->view_rms_px.push_back(rms(errors));
    sum += std::pow(fit->view_rms_px.back(), 2) * static_cast<double>(errors.size());
    count += static_cast<double>(errors.size());
    const Eigen::Vector3d normal = fit->T_camera_board[i].rotation * Eigen::Vector3d::UnitZ();
    fit->max_tilt_rad = std::max(fit->max_tilt_rad, std::acos(std::min(1.0, std::abs(normal.z()))));
  }
  fit->rms_px = std::sqrt(sum / std::max(1.0, count));
}

/// Moves the worst view that does not fit the others from `used` to `dropped`; false where there is none.
bool drop_worst(std::size_t num_views, LensFit* fit) {
  const double median_px = upper_median(fit->view_rms_px);
  const auto worst = std::max_element(fit->view_rms_px.begin(), fit->view_rms_px.end());
  if (*worst < std::max(kMinOutlierPx, kMaxViewRatio * median_px)) return false;
  if (static_cast<double>(fit->dropped.size() + 1) > kMaxDropped * static_cast<double>(num_views)) return false;
  const auto index = worst - fit->view_rms_px.begin();
  fit->dropped.push_back(fit->used[static_cast<std::size_t>(index)]);
  fit->used.erase(fit->used.begin() + index);
  return true;
}

Status check_determined(const LensFit& fit) {
  if (fit.max_tilt_rad < kMinTiltRad) {
    return {ErrorCode::kInvalid,
            tools::text_of("the board was never tilted by more than %.0f degrees, so focal length and distance cannot be told apart; "
                           "tilt it 20 to 45 degrees to each side",
                           tools::degrees(fit.max_tilt_rad))};
  }
  const double focal_sigma = std::max(fit.sigma[0] / fit.intrinsics.fx, fit.sigma[1] / fit.intrinsics.fy);
  if (!(focal_sigma <= kMaxFocalSigma)) {
    return {ErrorCode::kInvalid,
            tools::text_of("the views leave the focal length open by %.1f %%; add views with the board tilted, near, and in the corners",
                           100 * focal_sigma)};
  }
  return Status::ok();
}

}  // namespace

Result<LensFit> fit_lens(const Board& board, std::span<const BoardView> views, int width, int height, LensModel lens) {
  const auto too_few = [&](std::size_t count) {
    return Status(ErrorCode::kInvalid,
                  tools::text_of("%zu views of the board, %zu are needed; show it at more places and angles", count, kMinViews));
  };
  if (views.size() < kMinViews) return too_few(views.size());
  LensFit fit;
  fit.intrinsics.width = width;
  fit.intrinsics.height = height;
  for (std::size_t i = 0; i < views.size(); ++i) fit.used.push_back(i);
  do {
    if (fit.used.size() < kMinViews) return too_few(fit.used.size());
    if (Status status = solve(board, views, lens, &fit); !status) return status;
    measure(board, views, &fit);
  } while (drop_worst(views.size(), &fit));
  if (Status status = check_determined(fit); !status) return status;
  return fit;
}

Result<Rigid3> find_board(const Board& board, const BoardCorners& corners, const Intrinsics& intrinsics) {
  const Status failed(ErrorCode::kInvalid, "the corners give no pose of the board");
  if (corners.ids.size() < 4) return failed;
  std::vector<cv::Point3d> points;
  std::vector<cv::Point2d> normalized;
  for (std::size_t i = 0; i < corners.ids.size(); ++i) {
    const Eigen::Vector2d p = board.corner_m(corners.ids[i]), n = intrinsics.undistort(corners.pixels[i]);
    points.emplace_back(p.x(), p.y(), 0);
    normalized.emplace_back(n.x(), n.y());
  }
  try {
    cv::Mat rotation, translation;
    if (!cv::solvePnP(points, normalized, cv::Matx33d::eye(), cv::noArray(), rotation, translation)) return failed;
    const Rigid3 T_camera_board = to_rigid(rotation, translation);
    return T_camera_board.translation.allFinite() && T_camera_board.translation.z() > 0 ? Result<Rigid3>(T_camera_board)
                                                                                        : Result<Rigid3>(failed);
  } catch (const cv::Exception&) { return failed; }
}

std::vector<Eigen::Vector2d> reprojection_errors(const Board& board, const BoardCorners& corners, const Intrinsics& intrinsics,
                                                 const Rigid3& T_camera_board) {
  std::vector<Eigen::Vector2d> errors;
  for (std::size_t i = 0; i < corners.ids.size(); ++i) {
    const Eigen::Vector2d p = board.corner_m(corners.ids[i]);
    errors.push_back(corners.pixels[i] - intrinsics.project(T_camera_board * Eigen::Vector3d(p.x(), p.y(), 0)));
  }
  return errors;
}

}  // namespace camloc::camera_tool
