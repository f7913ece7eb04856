// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sample_source.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <utility>

#include "drivers/playback.h"

namespace camloc {

namespace {

const Eigen::Vector3f kRoomMin(-3.0F, -2.5F, 0.0F);
const Eigen::Vector3f kRoomMax(3.0F, 2.5F, 2.7F);

/// Fills a rectangle of a square texture, clipped to it.
void fill(std::vector<std::uint8_t>* texture, int size, int x0, int y0, int width, int height, int value) {
  for (int y = std::max(y0, 0); y < std::min(y0 + height, size); ++y) {
    for (int x = std::max(x0, 0); x < std::min(x0 + width, size); ++x) {
      (*texture)[static_cast<std::size_t>(y * size + x)] = static_cast<std::uint8_t>(value);
    }
  }
}

/// Overlapping rectangles from large to small: corners at every scale, none alike.
std::vector<std::uint8_t> paint_face(int size, std::uint32_t seed) {
  std::vector<std::uint8_t> texture(static_cast<std::size_t>(size) * static_cast<std::size_t>(size), 128);
  std::mt19937 random(seed);  // its sequence is fixed by the standard, a distribution's is not
  const auto below = [&random](int n) { return static_cast<int>(random() % static_cast<std::uint32_t>(n)); };
  for (int extent = size / 3; extent >= 4; extent = extent * 3 / 4) {
    const int count = size * size / (extent * extent * 6) + 4;
    for (int i = 0; i < count; ++i)
      fill(&texture, size, below(size), below(size), extent / 2 + below(extent), extent / 2 + below(extent), 20 + below(216));
  }
  return texture;
}

/// Distance along the ray to the inner side of the room, and which face (2 * axis + is_max) it meets.
std::pair<float, int> meet_room(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction) {
  float nearest = 1e9F;
  int face = 0;
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(direction[axis]) < 1e-9F) continue;
    const bool is_max = direction[axis] > 0;
    const float distance = ((is_max ? kRoomMax : kRoomMin)[axis] - origin[axis]) / direction[axis];
    if (distance < nearest) {
      nearest = distance;
      face = 2 * axis + (is_max ? 1 : 0);
    }
  }
  return {nearest, face};
}

class SampleSource final : public FrameSource {
 public:
  SampleSource(FrameSourceInfo info, double rate_hz)
      : info_(std::move(info)), pacer_(rate_hz > 0 ? 1.0 : 0.0), stamp_rate_hz_(rate_hz > 0 ? rate_hz : 30.0) {}

  [[nodiscard]] const FrameSourceInfo& info() const override { return info_; }

  [[nodiscard]] Status next(FrameBuffer* frame, std::chrono::milliseconds timeout) override {
    if (info_.num_frames && index_ == *info_.num_frames) return {ErrorCode::kEnd, "sample://: all frames are out"};
    const std::int64_t stamp_ns = std::llround(static_cast<double>(index_) * 1e9 / stamp_rate_hz_);
    if (!pacer_.wait_for(stamp_ns, timeout)) return {ErrorCode::kTimeout, "sample://: the next frame is not due yet"};
    frame->sequence = index_;
    frame->stamp_ns = stamp_ns;
    room_.render(*info_.camera, sample_pose(index_), frame);
    ++index_;
    return Status::ok();
  }

 private:
  FrameSourceInfo info_;
  Pacer pacer_;
  double stamp_rate_hz_;
  SampleRoom room_;
  std::uint64_t index_ = 0;
};

}  // namespace

RgbdCamera sample_camera(int width, int height) {
  RgbdCamera camera;
  camera.name = "sample";
  camera.color.width = width;
  camera.color.height = height;
  camera.color.fx = camera.color.fy = 525.0 * width / 640.0;
  camera.color.cx = 0.5 * (width - 1);
  camera.color.cy = 0.5 * (height - 1);
  camera.depth = camera.color;
  return camera;
}

Rigid3 sample_pose(std::uint64_t index) {
  const double phase = 2 * std::numbers::pi * static_cast<double>(index % kSamplePeriod) / static_cast<double>(kSamplePeriod);
  const Eigen::Vector3d position(1.2 * std::cos(phase), 0.9 * std::sin(phase), 1.4 + 0.15 * std::sin(3 * phase));
  const double yaw_rad = phase + 0.4 * std::sin(2 * phase);
  const double pitch_rad = 0.15 * std::sin(2 * phase + 1);
  // Columns: the camera's right, down and forward axes in the map.
  const Eigen::Vector3d forward(std::cos(yaw_rad) * std::cos(pitch_rad), std::sin(yaw_rad) * std::cos(pitch_rad), std::sin(pitch_rad));
  const Eigen::Vector3d right = forward.cross(Eigen::Vector3d::UnitZ()).normalized();
  Eigen::Matrix3d R_map_camera;
  R_map_camera << right, forward.cross(right), forward;
  return {Eigen::Quaterniond(R_map_camera).normalized(), position};
}

SampleRoom::SampleRoom() {
  for (std::size_t face = 0; face < faces_.size(); ++face)
    faces_[face] = paint_face(kTextureSize, 1000U + static_cast<std::uint32_t>(face));
}

std::uint8_t SampleRoom::shade(int face, float u, float v) const {
  constexpr auto kLast = static_cast<float>(kTextureSize - 1);
  const float x = std::clamp(u, 0.0F, 1.0F) * kLast, y = std::clamp(v, 0.0F, 1.0F) * kLast;
  const int x0 = std::min(static_cast<int>(x), kTextureSize - 2), y0 = std::min(static_cast<int>(y), kTextureSize - 2);
  const float fx = x - static_cast<float>(x0), fy = y - static_cast<float>(y0);
  const std::uint8_t* p = faces_[static_cast<std::size_t>(face)].data() + y0 * kTextureSize + x0;
  const float top = p[0] + fx * static_cast<float>(p[1] - p[0]);
  const float bottom = p[kTextureSize] + fx * static_cast<float>(p[kTextureSize + 1] - p[kTextureSize]);
  return static_cast<std::uint8_t>(top + fy * (bottom - top) + 0.5F);
}

void SampleRoom::render(const RgbdCamera& camera, const Rigid3& T_map_camera, FrameBuffer* frame) const {
  const Intrinsics& k = camera.color;
  frame->gray.resize(k.width, k.height);
  frame->depth.resize(k.width, k.height);
  const Eigen::Matrix3f R = T_map_camera.rotation.toRotationMatrix().cast<float>();
  const Eigen::Vector3f origin = T_map_camera.translation.cast<float>();
  const auto units_per_m = static_cast<float>(1 / camera.depth_unit_m);
  for (int y = 0; y < k.height; ++y) {
    for (int x = 0; x < k.width; ++x) {
      // The ray has z = 1 in the camera, so the distance along it is the depth.
      const Eigen::Vector3f ray(static_cast<float>((x - k.cx) / k.fx), static_cast<float>((y - k.cy) / k.fy), 1.0F);
      const Eigen::Vector3f direction = R * ray;
      const auto [depth, face] = meet_room(origin, direction);
      const Eigen::Vector3f at = (origin + depth * direction - kRoomMin).cwiseQuotient(kRoomMax - kRoomMin);
      const int axis = face / 2;
      frame->gray.at(x, y) = shade(face, at[axis == 0 ? 1 : 0], at[axis == 2 ? 1 : 2]);
      frame->depth.at(x, y) = static_cast<std::uint16_t>(std::clamp(depth * units_per_m + 0.5F, 0.0F, 65534.0F));
    }
  }
}

Result<std::unique_ptr<FrameSource>> open_sample_source(const SourceUrl& url, const FrameSourceOptions& /*options*/) {
  if (Status status = url.check_options({"rate_hz", "frames", "width", "height"}); !status) return status;
  if (!url.path.empty() && url.path != "/") return Status(ErrorCode::kInvalid, url.text + ": sample:// takes no path, only options");
  OptionReader options(url);
  const double rate_hz = options.number("rate_hz", 30, 0, 10000);
  const double frames = options.number("frames", 0, 0, 1e12);
  const double width = options.number("width", 640, 16, 4096), height = options.number("height", 480, 16, 4096);
  if (!options.status()) return options.status();
  FrameSourceInfo info;
  info.camera = sample_camera(static_cast<int>(width), static_cast<int>(height));
  info.color_width = info.depth_width = info.camera->color.width;
  info.color_height = info.depth_height = info.camera->color.height;
  if (frames > 0) info.num_frames = static_cast<std::uint64_t>(frames);
  info.description = "generated images of a room, " + std::to_string(info.color_width) + "x" + std::to_string(info.color_height);
  return std::unique_ptr<FrameSource>(std::make_unique<SampleSource>(std::move(info), rate_hz));
}

}  // namespace camloc
