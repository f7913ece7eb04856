// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/registration/frame_features.h"

#include <string>

namespace camloc {
namespace {

std::string size_text(int width, int height) { return std::to_string(width) + "x" + std::to_string(height); }

}  // namespace

void FrameFeatures::clear() {
  T_map_camera = Rigid3{};
  features.keypoints.clear();
  features.descriptors.clear();
  normalized.clear();
  depth_m.clear();
  patches.clear();
}

void FrameFeatures::reserve(std::size_t num_features) {
  features.keypoints.reserve(num_features);
  features.descriptors.reserve(num_features);
  normalized.reserve(num_features);
  depth_m.reserve(num_features);
}

FrameExtractor::FrameExtractor(const RgbdCamera& camera, const OrbOptions& orb, bool use_depth)
    : camera_(camera),
      use_depth_(use_depth),
      extractor_(camera.color.width, camera.color.height, orb),
      rays_(camera.color),
      depth_lookup_(camera) {}

Status FrameExtractor::check(const Frame& frame) const {
  const std::string what = "frame " + std::to_string(frame.sequence);
  if (!has_image(frame)) {
    return {ErrorCode::kInvalid, what + ": colour image is " + size_text(frame.gray.width, frame.gray.height) + " but camera '" +
                                     camera_.name + "' has " + size_text(camera_.color.width, camera_.color.height)};
  }
  if (frame.depth.empty()) return {ErrorCode::kInvalid, what + ": no depth image"};
  if (frame.depth.width != camera_.depth.width || frame.depth.height != camera_.depth.height) {
    return {ErrorCode::kInvalid, what + ": depth image is " + size_text(frame.depth.width, frame.depth.height) + " but camera '" +
                                     camera_.name + "' has " + size_text(camera_.depth.width, camera_.depth.height)};
  }
  return Status::ok();
}

bool FrameExtractor::has_image(const Frame& frame) const {
  return !frame.gray.empty() && frame.gray.width == camera_.color.width && frame.gray.height == camera_.color.height;
}

MeasuredDepth FrameExtractor::depth_of(const Frame& frame) const {
  return !use_depth_ || frame.depth.empty() ? MeasuredDepth{} : MeasuredDepth{&depth_lookup_, frame.depth};
}

void FrameExtractor::extract(const Frame& frame, FrameFeatures* view) {
  view->clear();
  view->stamp_ns = frame.stamp_ns;
  view->features = extractor_.extract(frame.gray);
  const MeasuredDepth depth = depth_of(frame);
  for (const Keypoint& keypoint : view->features.keypoints) {
    view->normalized.push_back(rays_.undistort(keypoint.u, keypoint.v));
    view->depth_m.push_back(depth.at(keypoint.u, keypoint.v));
  }
}

FrameFeatures FrameExtractor::extract_with_patches(const Frame& frame) {
  FrameFeatures view;
  extract(frame, &view);
  extractor_.copy_patches(&view.patches);
  return view;
}

}  // namespace camloc
