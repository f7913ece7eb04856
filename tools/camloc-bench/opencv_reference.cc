// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/camloc-bench/opencv_reference.h"

#include <cstring>
#include <opencv2/calib3d.hpp>
#include <opencv2/features2d.hpp>

#include "core/map/map_landmarks.h"

namespace camloc::bench {
namespace {

constexpr int kDescriptorBytes = 32;

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

struct OpencvReference::Impl {
  Impl(const MapView& map_view, const RgbdCamera& camera, const ReferenceOptions& reference_options, StageTimer::Clock clock)
      : map(&map_view),
        options(reference_options),
        now_ns(clock),
        orb(cv::ORB::create(reference_options.num_features)),
        matcher(cv::NORM_HAMMING),
        local(map_view, camera.color, MapLandmarksOptions{}) {
    const Intrinsics& c = camera.color;
    K = (cv::Mat_<double>(3, 3) << c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1);
    distortion = cv::Mat::zeros(1, 5, CV_64F);
    if (c.lens == LensModel::kBrownConrady) {
      for (int i = 0; i < 5; ++i) distortion.at<double>(i) = c.distortion[static_cast<std::size_t>(i)];
    }
    for (std::uint32_t landmark = 0; landmark < map->landmarks().size(); ++landmark) add(landmark, all_descriptors, all_landmarks);
  }

  void add(std::uint32_t landmark, cv::Mat& descriptors, std::vector<std::uint32_t>& landmarks) const {
    const std::uint32_t first = map->first_descriptor(landmark);
    for (std::uint32_t d = first; d < first + map->num_descriptors(landmark); ++d) {
      cv::Mat row(1, kDescriptorBytes, CV_8U);
      std::memcpy(row.data, map->descriptors()[d].bits.data(), kDescriptorBytes);
      descriptors.push_back(row);
      landmarks.push_back(landmark);
    }
  }

  void gather_local() {
    local_descriptors.release();
    local_landmarks.clear();
    for (const ProjectedLandmark& p : local.project(*last, 0.0F))
      add(static_cast<std::uint32_t>(p.landmark), local_descriptors, local_landmarks);
  }

  const MapView* map;
  ReferenceOptions options;
  StageTimer::Clock now_ns;
  cv::Ptr<cv::ORB> orb;
  cv::BFMatcher matcher;
  MapLandmarks local;
  cv::Mat K, distortion, all_descriptors, local_descriptors;
  std::vector<std::uint32_t> all_landmarks, local_landmarks;
  std::optional<Rigid3> last;
};

OpencvReference::OpencvReference(const MapView& map, const RgbdCamera& camera, const ReferenceOptions& options, StageTimer::Clock now_ns)
    : impl_(std::make_unique<Impl>(map, camera, options, now_ns)) {}
OpencvReference::~OpencvReference() = default;

ReferenceResult OpencvReference::process(const Frame& frame) {
  Impl& self = *impl_;
  ReferenceResult result;
  const bool is_local = self.options.is_tracking && self.last.has_value();
  if (is_local) self.gather_local();  // not timed: a plain program would have its own way, and no cheaper one

  const std::int64_t started_ns = self.now_ns();
  const cv::Mat image(frame.gray.height, frame.gray.width, CV_8U, const_cast<std::uint8_t*>(frame.gray.data),
                      static_cast<std::size_t>(frame.gray.stride));
  std::vector<cv::KeyPoint> keypoints;
  cv::Mat descriptors;
  self.orb->detectAndCompute(image, cv::noArray(), keypoints, descriptors);
  const std::int64_t extracted_ns = self.now_ns();

  const auto& landmarks = is_local ? self.local_landmarks : self.all_landmarks;
  std::vector<std::vector<cv::DMatch>> nearest;
  if (!descriptors.empty() && landmarks.size() >= 2)
    self.matcher.knnMatch(descriptors, is_local ? self.local_descriptors : self.all_descriptors, nearest, 2);
  std::vector<cv::Point3f> points;
  std::vector<cv::Point2f> pixels;
  for (const auto& pair : nearest) {
    if (pair.size() == 2 && pair[0].distance > self.options.max_ratio * pair[1].distance) continue;
    const Eigen::Vector3f p = self.map->position_m(landmarks[static_cast<std::size_t>(pair[0].trainIdx)]);
    points.emplace_back(p.x(), p.y(), p.z());
    pixels.push_back(keypoints[static_cast<std::size_t>(pair[0].queryIdx)].pt);
  }
  const std::int64_t matched_ns = self.now_ns();

  self.last.reset();
  cv::Mat rotation, translation;
  std::vector<int> inliers;
  const bool is_solved = points.size() >= 6 &&
                         cv::solvePnPRansac(points, pixels, self.K, self.distortion, rotation, translation, false,
                                            self.options.ransac_iterations, static_cast<float>(self.options.max_error_px), 0.999, inliers);
  if (is_solved && inliers.size() >= self.options.min_inliers) self.last = pose_from(rotation, translation);
  result.T_map_camera = self.last;
  result.extract_ns = extracted_ns - started_ns;
  result.match_ns = matched_ns - extracted_ns;
  result.estimate_ns = self.now_ns() - matched_ns;
  return result;
}

}  // namespace camloc::bench
