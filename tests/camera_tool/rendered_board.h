// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Images of a calibration board, and of its depth, by a camera that the test knows exactly.
#pragma once

#include <cmath>
#include <numbers>
#include <opencv2/aruco/charuco.hpp>
#include <random>
#include <vector>

#include "core/base/frame.h"
#include "core/geometry/camera.h"
#include "tools/camloc-camera/board.h"

namespace camloc::camera_tool {

constexpr int kTexelsPerSquare = 60;

/// The print: a square has kTexelsPerSquare texels. `origin` is the texel of the frame `board`'s origin.
struct Print {
  Image<std::uint8_t> texels;
  Eigen::Vector2d origin;
};

inline Print print_of(const Board& board) {
  Print print;
  if (board.kind == Board::Kind::kCharuco) {
    const auto charuco =
        cv::aruco::CharucoBoard::create(board.columns, board.rows, static_cast<float>(board.square_m), static_cast<float>(board.marker_m),
                                        cv::aruco::getPredefinedDictionary(board.dictionary));
    cv::Mat drawn;
    const int margin = kTexelsPerSquare;
    charuco->draw({board.columns * kTexelsPerSquare + 2 * margin, board.rows * kTexelsPerSquare + 2 * margin}, drawn, margin, 1);
    print.texels.resize(drawn.cols, drawn.rows);
    for (int y = 0; y < drawn.rows; ++y) std::copy_n(drawn.ptr<std::uint8_t>(y), drawn.cols, print.texels.row(y));
    print.origin = {margin - 0.5, margin - 0.5};
    return print;
  }
  // A chessboard of inner corners c x r has c + 1 by r + 1 squares; a white margin of one square around it.
  print.texels.resize((board.columns + 3) * kTexelsPerSquare, (board.rows + 3) * kTexelsPerSquare);
  for (int y = 0; y < print.texels.height; ++y) {
    for (int x = 0; x < print.texels.width; ++x) {
      const int column = x / kTexelsPerSquare - 1, row = y / kTexelsPerSquare - 1;
      const bool is_inside = column >= 0 && row >= 0 && column <= board.columns && row <= board.rows;
      print.texels.at(x, y) = is_inside && (column + row) % 2 == 0 ? 0 : 255;
    }
  }
  print.origin = {2.0 * kTexelsPerSquare - 0.5, 2.0 * kTexelsPerSquare - 0.5};
  return print;
}

/// Renders with 3x3 rays a pixel, which are worked out once.
class BoardRenderer {
 public:
  BoardRenderer(const Board& board, const Intrinsics& k) : board_(board), print_(print_of(board)), k_(k) {
    for (int y = 0; y < k.height; ++y) {
      for (int x = 0; x < k.width; ++x) {
        for (int i = 0; i < kRays * kRays; ++i) {
          const Eigen::Vector2d pixel(x + (i % kRays + 0.5) / kRays - 0.5, y + (i / kRays + 0.5) / kRays - 0.5);
          rays_.push_back(k.undistort(pixel).cast<float>());
        }
      }
    }
  }

  /// Grey values 40 to 220 with noise of `noise` levels.
  [[nodiscard]] Image<std::uint8_t> render(const Rigid3& T_camera_board, double noise, std::mt19937* random) const {
    Image<std::uint8_t> image;
    image.resize(k_.width, k_.height);
    // p_board = R^T (z ray - t) lies in the plane: a homography from the ray to texels.
    const Eigen::Matrix3d R = T_camera_board.rotation.toRotationMatrix();
    Eigen::Matrix3d H;
    H << R.col(0), R.col(1), T_camera_board.translation;
    const Eigen::Matrix3f inverse = H.inverse().cast<float>();
    const auto texels_per_m = static_cast<float>(kTexelsPerSquare / board_.square_m);
    const Eigen::Vector2f origin = print_.origin.cast<float>();
    std::normal_distribution<float> error(0, static_cast<float>(noise));
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
      float sum = 0;
      for (std::size_t ray = 0; ray < kRays * kRays; ++ray) {
        const Eigen::Vector3f p = inverse * rays_[i * kRays * kRays + ray].homogeneous();
        sum += texel(p.z() > 0 ? Eigen::Vector2f(p.head<2>() / p.z() * texels_per_m + origin) : Eigen::Vector2f(-1, -1));
      }
      const float gray = 40 + 180 * sum / (255 * kRays * kRays) + (noise > 0 ? error(*random) : 0);
      image.pixels[i] = static_cast<std::uint8_t>(std::clamp(gray + 0.5F, 0.0F, 255.0F));
    }
    return image;
  }

 private:
  static constexpr int kRays = 3;
  /// A grey wall around the board.
  [[nodiscard]] float texel(const Eigen::Vector2f& at) const {
    const auto x = static_cast<int>(std::lround(at.x())), y = static_cast<int>(std::lround(at.y()));
    return x < 0 || y < 0 || x >= print_.texels.width || y >= print_.texels.height ? 110.0F : static_cast<float>(print_.texels.at(x, y));
  }

  Board board_;
  Print print_;
  Intrinsics k_;
  std::vector<Eigen::Vector2f> rays_;
};

/// Stands of a board that is shown to every part of the image, near and far, tilted to all sides.
inline std::vector<Rigid3> many_stands(const Board& board, const Intrinsics& k, int count, double tilt_rad, std::uint32_t seed) {
  std::mt19937 random(seed);
  const auto uniform = [&random](double low, double high) { return low + (high - low) * static_cast<double>(random()) / 4294967295.0; };
  const Eigen::Vector2d first = board.corner_m(0), last = board.corner_m(board.num_corners() - 1);
  const Eigen::Vector2d middle = 0.5 * (first + last);
  const double size_m = (last - first).norm();
  std::vector<Rigid3> stands;
  while (static_cast<int>(stands.size()) < count) {
    const double distance_m = size_m * k.fx / (k.width * uniform(0.35, 0.75));
    const double turn = uniform(-std::numbers::pi, std::numbers::pi);
    const Eigen::Quaterniond R =
        exp_so3(uniform(0.3, 1) * tilt_rad * Eigen::Vector3d(std::cos(turn), std::sin(turn), 0)) * exp_so3({0, 0, uniform(-0.3, 0.3)});
    const Eigen::Vector2d pixel(uniform(0.15, 0.85) * k.width, uniform(0.15, 0.85) * k.height);
    const Eigen::Vector3d at = distance_m * k.undistort(pixel).homogeneous();
    const Rigid3 T_camera_board{R, at - R * Eigen::Vector3d(middle.x(), middle.y(), 0)};
    bool is_inside = true;
    for (int id = 0; id < board.num_corners(); ++id) {
      const Eigen::Vector2d p = board.corner_m(id), u = k.project(T_camera_board * Eigen::Vector3d(p.x(), p.y(), 0));
      const double margin = 0.03 * k.width;
      is_inside = is_inside && u.x() > margin && u.y() > margin && u.x() < k.width - margin && u.y() < k.height - margin;
    }
    if (is_inside) stands.push_back(T_camera_board);
  }
  return stands;
}

/// Depth of the board, and of a wall half a metre behind it, in raw units of `camera` by its depth noise.
inline Image<std::uint16_t> render_depth(const Board& board, const RgbdCamera& camera, const Rigid3& T_color_board, double scale,
                                         double offset_m, std::mt19937* random) {
  const Rigid3 T_board_depth = T_color_board.inverse() * camera.T_color_depth;
  const Eigen::Vector2d last = board.corner_m(board.num_corners() - 1);
  const UndistortionTable rays(camera.depth);
  std::normal_distribution<double> normal;
  Image<std::uint16_t> depth;
  depth.resize(camera.depth.width, camera.depth.height);
  for (int y = 0; y < depth.height; ++y) {
    for (int x = 0; x < depth.width; ++x) {
      const Eigen::Vector3d ray = rays.undistort(static_cast<float>(x), static_cast<float>(y)).cast<double>().homogeneous();
      const Eigen::Vector3d direction = T_board_depth.rotation * ray;
      double z = -T_board_depth.translation.z() / direction.z();
      const Eigen::Vector3d p = T_board_depth.translation + z * direction;
      const double margin = 1.5 * board.square_m;
      if (!(z > 0) || p.x() < -margin || p.y() < -margin || p.x() > last.x() + margin || p.y() > last.y() + margin) z = 2.5;
      const double measured = scale * z + offset_m + camera.depth_noise.sigma_m(z) * normal(*random);
      depth.at(x, y) = static_cast<std::uint16_t>(std::clamp(measured / camera.depth_unit_m + 0.5, 0.0, 65534.0));
    }
  }
  return depth;
}

}  // namespace camloc::camera_tool
