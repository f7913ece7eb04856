// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/camloc-bench/opencv_reference.h"

#include <cstring>
#include <opencv2/calib3d.hpp>

namespace camloc::bench {
namespace {

constexpr int kDescriptorBytes = 32;
constexpr int kNumFeatures = 1000;
constexpr int kRansacIterations = 600;
constexpr float kMaxErrorPx = 5.0F;
constexpr double kMaxRatio = 0.8;
constexpr std::size_t kMinInliers = 15;

Rigid3 pose_from(const cv::Mat& rotation_vector, const cv::Mat& translation) {
  cv::Mat R;
  cv::Rodrigues(rotation_vector, R);
  Rigid3 T_camera_map;
  Eigen::Matrix3d rotation;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) rotation(row, column) = R.at<double>(row, column);
    T_camera_map.translation[row] = translation.at<double>(row);
  }
  T_camera_map.rotation = nearest_rotation(rotation);
  return T_camera_map.inverse();
}

}  // namespace

OpencvReference::OpencvReference(const MapView& map, const RgbdCamera& camera, bool is_tracking, StageTimer::Clock now_ns)
    : map_(map),
      is_tracking_(is_tracking),
      now_ns_(now_ns),
      orb_(cv::ORB::create(kNumFeatures)),
      matcher_(cv::NORM_HAMMING),
      landmarks_(map, camera.color, MapLandmarksOptions{}) {
  const Intrinsics& c = camera.color;
  K_ = (cv::Mat_<double>(3, 3) << c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1);
  distortion_ = cv::Mat::zeros(1, c.lens == LensModel::kRational ? 8 : 5, CV_64F);
  if (c.lens == LensModel::kBrownConrady || c.lens == LensModel::kRational) {
    for (int i = 0; i < distortion_.cols; ++i) distortion_.at<double>(i) = c.distortion[static_cast<std::size_t>(i)];
  }
  for (std::uint32_t landmark = 0; landmark < map.landmarks().size(); ++landmark) add(landmark, &all_);
}

void OpencvReference::add(std::uint32_t landmark, Descriptors* descriptors) const {
  const std::uint32_t first = map_.first_descriptor(landmark);
  for (std::uint32_t d = first; d < first + map_.num_descriptors(landmark); ++d) {
    cv::Mat row(1, kDescriptorBytes, CV_8U);
    std::memcpy(row.data, map_.descriptors()[d].bits.data(), kDescriptorBytes);
    descriptors->rows.push_back(row);
    descriptors->landmarks.push_back(landmark);
  }
}

ReferenceResult OpencvReference::process(const Frame& frame) {
  const bool is_local = is_tracking_ && last_.has_value();
  if (is_local) {  // not timed: a plain program would have its own way, and no cheaper one
    local_ = {};
    for (const ProjectedLandmark& p : landmarks_.project(*last_, 0.0F)) add(static_cast<std::uint32_t>(p.landmark), &local_);
  }

  const std::int64_t started_ns = now_ns_();
  const cv::Mat image(frame.gray.height, frame.gray.width, CV_8U, const_cast<std::uint8_t*>(frame.gray.data),
                      static_cast<std::size_t>(frame.gray.stride));
  std::vector<cv::KeyPoint> keypoints;
  cv::Mat descriptors;
  orb_->detectAndCompute(image, cv::noArray(), keypoints, descriptors);
  const std::int64_t extracted_ns = now_ns_();

  const Descriptors& candidates = is_local ? local_ : all_;
  std::vector<std::vector<cv::DMatch>> nearest;
  if (!descriptors.empty() && candidates.landmarks.size() >= 2) matcher_.knnMatch(descriptors, candidates.rows, nearest, 2);
  std::vector<cv::Point3f> points;
  std::vector<cv::Point2f> pixels;
  for (const auto& pair : nearest) {
    if (pair.size() == 2 && pair[0].distance > kMaxRatio * pair[1].distance) continue;
    const Eigen::Vector3f p = map_.position_m(candidates.landmarks[static_cast<std::size_t>(pair[0].trainIdx)]);
    points.emplace_back(p.x(), p.y(), p.z());
    pixels.push_back(keypoints[static_cast<std::size_t>(pair[0].queryIdx)].pt);
  }
  const std::int64_t matched_ns = now_ns_();

  last_.reset();
  cv::Mat rotation, translation;
  std::vector<int> inliers;
  const bool is_solved = points.size() >= 6 && cv::solvePnPRansac(points, pixels, K_, distortion_, rotation, translation, false,
                                                                  kRansacIterations, kMaxErrorPx, 0.999, inliers);
  if (is_solved && inliers.size() >= kMinInliers) last_ = pose_from(rotation, translation);
  const std::int64_t ended_ns = now_ns_();
  return {last_, {extracted_ns - started_ns, matched_ns - extracted_ns, ended_ns - matched_ns, ended_ns - started_ns}};
}

}  // namespace camloc::bench
