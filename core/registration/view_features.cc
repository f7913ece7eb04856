// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/registration/view_features.h"

#include <string>

namespace camloc {
namespace {

std::string size_text(int width, int height) { return std::to_string(width) + "x" + std::to_string(height); }

}  // namespace

ViewExtractor::ViewExtractor(const RgbdCamera& camera, const OrbOptions& orb)
    : camera_(camera), extractor_(camera.color.width, camera.color.height, orb), rays_(camera.color), depth_lookup_(camera) {}

Status ViewExtractor::check(const Frame& frame) const {
  const std::string what = "frame " + std::to_string(frame.sequence);
  if (frame.gray.width != camera_.color.width || frame.gray.height != camera_.color.height || frame.gray.empty()) {
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

ViewFeatures ViewExtractor::extract(const Frame& frame) {
  ViewFeatures view;
  view.stamp_ns = frame.stamp_ns;
  view.features = extractor_.extract(frame.gray);
  view.normalized.reserve(view.size());
  view.depth_m.reserve(view.size());
  for (const Keypoint& keypoint : view.features.keypoints) {
    view.normalized.push_back(rays_.undistort(keypoint.u, keypoint.v));
    view.depth_m.push_back(depth_lookup_.depth_at(frame.depth, keypoint.u, keypoint.v));
  }
  return view;
}

ViewFeatures ViewExtractor::extract_with_patches(const Frame& frame) {
  ViewFeatures view = extract(frame);
  extractor_.copy_patches(&view.patches);
  return view;
}

}  // namespace camloc
