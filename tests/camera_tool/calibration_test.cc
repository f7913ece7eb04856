// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Calibration against cameras that are known exactly, from rendered images of a board.
#include "tools/camloc-camera/calibration.h"

#include <gtest/gtest.h>

#include "core/io/camera_file.h"
#include "drivers/sources.h"
#include "tests/camera_tool/rendered_board.h"

namespace camloc::camera_tool {
namespace {

Intrinsics small_kinect_lens() {
  Intrinsics k;
  k.width = 480;
  k.height = 360;
  k.fx = 387.9;
  k.fy = 387.4;
  k.cx = 238.9;
  k.cy = 191.4;
  k.lens = LensModel::kBrownConrady;
  k.distortion = {0.12, -0.25, -0.003, 0.002, 0.0};
  return k;
}

Board board_of(const char* text) {
  const auto board = parse_board(text);
  EXPECT_TRUE(board.is_ok()) << board.status().message();
  return board ? *board : Board{};
}

/// Corners as an error-free detector with noise of `noise_px` would find them.
BoardCorners exact_corners(const Board& board, const Intrinsics& k, const Rigid3& T_camera_board, double noise_px, std::mt19937* random) {
  std::normal_distribution<double> normal(0, noise_px);
  BoardCorners corners;
  for (int id = 0; id < board.num_corners(); ++id) {
    const Eigen::Vector2d p = board.corner_m(id);
    corners.ids.push_back(id);
    corners.pixels.push_back(k.project(T_camera_board * Eigen::Vector3d(p.x(), p.y(), 0)) +
                             Eigen::Vector2d(normal(*random), normal(*random)));
  }
  return corners;
}

std::vector<BoardView> exact_views(const Board& board, const Intrinsics& k, int count, double noise_px, std::uint32_t seed,
                                   double tilt_rad = 0.6) {
  std::mt19937 random(seed);
  std::vector<BoardView> views;
  for (const Rigid3& T_camera_board : many_stands(board, k, count, tilt_rad, seed)) {
    views.push_back({views.size(), exact_corners(board, k, T_camera_board, noise_px, &random), {}});
  }
  return views;
}

/// Errors of fx fy cx cy over their standard deviations.
std::array<double, 4> z_scores(const LensFit& fit, const Intrinsics& truth) {
  const Intrinsics& k = fit.intrinsics;
  return {(k.fx - truth.fx) / fit.sigma[0], (k.fy - truth.fy) / fit.sigma[1], (k.cx - truth.cx) / fit.sigma[2],
          (k.cy - truth.cy) / fit.sigma[3]};
}

TEST(LensFitTest, SigmasAreHonest) {
  const Board board = board_of("chessboard:9x6:25mm");
  for (const LensModel lens : {LensModel::kBrownConrady, LensModel::kEquidistant}) {
    Intrinsics truth = small_kinect_lens();
    if (lens == LensModel::kEquidistant) {
      truth.lens = lens;
      truth.fx = truth.fy = 230;
      truth.distortion = {-0.02, 0.005, -0.002, 0.0005, 0};
    }
    double squares = 0;
    int count = 0;
    // Of seed 21 OpenCV's equidistant calibration makes nothing unless it is started elsewhere. Over 40 seeds the mean is 1.06, 1.02.
    for (std::uint32_t seed = 18; seed <= 24; ++seed) {
      const auto fit = fit_lens(board, exact_views(board, truth, 15, 0.2, seed), truth.width, truth.height, lens);
      ASSERT_TRUE(fit.is_ok()) << fit.status().message();
      EXPECT_NEAR(fit->rms_px, 0.2 * std::sqrt(2.0), 0.03);
      for (const double z : z_scores(*fit, truth)) {
        EXPECT_LT(std::abs(z), 4.5);
        squares += z * z;
        ++count;
      }
    }
    EXPECT_GT(squares / count, 0.4) << "sigmas too large";
    EXPECT_LT(squares / count, 2.0) << "sigmas too small";
  }
}

TEST(LensFitTest, AViewThatDoesNotFitIsDropped) {
  const Board board = board_of("chessboard:9x6:25mm");
  std::vector<BoardView> views = exact_views(board, small_kinect_lens(), 20, 0.1, 7);
  for (Eigen::Vector2d& pixel : views[4].corners.pixels)
    pixel.x() += 0.02 * pixel.y() + (pixel.x() > 300 ? 4 : 0);  // moved while it was taken
  const auto fit = fit_lens(board, views, 480, 360);
  ASSERT_TRUE(fit.is_ok()) << fit.status().message();
  EXPECT_EQ(fit->dropped, (std::vector<std::size_t>{4}));
  for (const double z : z_scores(*fit, small_kinect_lens())) EXPECT_LT(std::abs(z), 4);
}

TEST(LensFitTest, RefusesWhatDoesNotDetermineTheLens) {
  const Board board = board_of("chessboard:9x6:25mm");
  const auto few = fit_lens(board, exact_views(board, small_kinect_lens(), 5, 0.1, 3), 480, 360);
  ASSERT_FALSE(few.is_ok());
  EXPECT_NE(few.status().message().find("5 views of the board, 8 are needed"), std::string::npos) << few.status().message();
  const auto flat = fit_lens(board, exact_views(board, small_kinect_lens(), 15, 0.1, 3, 1e-3), 480, 360);
  ASSERT_FALSE(flat.is_ok());
  EXPECT_NE(flat.status().message().find("tilt"), std::string::npos) << flat.status().message();
}

TEST(BoardTest, ReadsBoards) {
  const Board chessboard = board_of("chessboard:9x6:2.5cm");
  EXPECT_EQ(chessboard.num_corners(), 54);
  EXPECT_DOUBLE_EQ(chessboard.square_m, 0.025);
  EXPECT_EQ(chessboard.corner_m(10), Eigen::Vector2d(0.025, 0.025));
  const Board charuco = board_of("charuco:7x5:40mm:30mm:DICT_4X4_50");
  EXPECT_EQ(charuco.num_corners(), 24);
  EXPECT_DOUBLE_EQ(charuco.marker_m, 0.03);
  for (const char* text : {"", "chess", "chessboard", "chessboard:9", "chessboard:2x6:25mm", "chessboard:9x6:25", "chessboard:9x6:0mm",
                           "chessboard:9x6:25mm:1", "chessboard:9x99999999999:25mm", "charuco:7x5:40mm", "charuco:7x5:40mm:40mm",
                           "charuco:7x5:40mm:30mm:DICT_9X9_50", "charuco:20x20:40mm:30mm:DICT_4X4_50"}) {
    EXPECT_EQ(parse_board(text).status().code(), ErrorCode::kInvalid) << text;
  }
}

TEST(ViewSelectionTest, LikeViewsAreSeenOnceAndTheImageIsCovered) {
  const Board board = board_of("chessboard:9x6:25mm");
  const Intrinsics k = small_kinect_lens();
  const std::vector<BoardView> views = exact_views(board, k, 60, 0.1, 11);
  BoardCorners shaken = views[5].corners;
  for (Eigen::Vector2d& pixel : shaken.pixels) pixel.x() += 3;
  EXPECT_FALSE(is_new_view(shaken, views, 15));
  EXPECT_TRUE(is_new_view(shaken, views, 2));
  const ViewChoice choice = choose_views(board, views, k.width, k.height, 12, 10);
  EXPECT_EQ(choice.fit.size(), 12U);
  EXPECT_EQ(choice.held_out.size(), 10U);
  for (const std::size_t held_out : choice.held_out) EXPECT_EQ(std::count(choice.fit.begin(), choice.fit.end(), held_out), 0);
  CoverageGrid chosen{k.width, k.height}, first{k.width, k.height};
  for (const std::size_t index : choice.fit) chosen.add(views[index].corners);
  for (std::size_t i = 0; i < 12; ++i) first.add(views[i].corners);
  EXPECT_GT(chosen.covered(), first.covered());
}

/// The renderer as a frame source, with depth.
class BoardSource final : public FrameSource {
 public:
  BoardSource(const Board& board, const RgbdCamera& camera, int num_views, double depth_scale, double depth_offset_m)
      : board_(board), renderer_(board, camera.color), depth_scale_(depth_scale), depth_offset_m_(depth_offset_m), random_(99) {
    info_.camera = camera;
    stands_ = many_stands(board, camera.color, num_views, 0.6, 5);
  }
  [[nodiscard]] const FrameSourceInfo& info() const override { return info_; }
  [[nodiscard]] Status next(FrameBuffer* frame, std::chrono::milliseconds) override {
    if (index_ == stands_.size()) return {ErrorCode::kEnd, "over"};
    frame->sequence = index_;
    frame->gray = renderer_.render(stands_[index_], 2, &random_);
    frame->depth = render_depth(board_, *info_.camera, stands_[index_], depth_scale_, depth_offset_m_, &random_);
    ++index_;
    return Status::ok();
  }

 private:
  Board board_;
  BoardRenderer renderer_;
  FrameSourceInfo info_;
  std::vector<Rigid3> stands_;
  std::size_t index_ = 0;
  double depth_scale_, depth_offset_m_;
  std::mt19937 random_;
};

RgbdCamera registered_camera() {
  RgbdCamera camera;
  camera.name = "rendered";
  camera.color = camera.depth = small_kinect_lens();
  camera.depth_noise = {0.001, 0.004};
  return camera;
}

Result<Calibration> calibrate_rendered(const char* board_text, const RgbdCamera& truth, double depth_scale, double depth_offset_m,
                                       int num_views, std::string* report = nullptr, ColorImage* picture = nullptr) {
  CalibrationOptions options;
  options.board = board_of(board_text);
  options.known = truth;
  options.known->color = {};
  BoardSource source(options.board, truth, num_views, depth_scale, depth_offset_m);
  const auto views = collect_views(&source, options, [](const CalibrationViews&) { return true; });
  if (!views) return views.status();
  EXPECT_GT(views->views.size(), static_cast<std::size_t>(num_views) * 3 / 4);
  auto calibration = calibrate(*views, options);
  if (calibration && report != nullptr) *report = format_report(*calibration, *views);
  if (calibration && picture != nullptr) *picture = draw_coverage(options.board, *calibration, *views);
  return calibration;
}

TEST(CalibrationTest, ChessboardWithRegisteredDepth) {
  const RgbdCamera truth = registered_camera();
  std::string report;
  ColorImage picture;
  const auto calibration = calibrate_rendered("chessboard:9x6:50mm", truth, 1.01, 0.004, 18, &report, &picture);
  ASSERT_TRUE(calibration.is_ok()) << calibration.status().message();
  for (const double z : z_scores(calibration->lens, truth.color)) EXPECT_LT(std::abs(z), 4) << report;
  EXPECT_LT(calibration->lens.rms_px, 0.15) << report;
  EXPECT_GT(calibration->num_held_out_corners, 0U);
  EXPECT_LT(calibration->held_out_rms_px, 0.2) << report;
  ASSERT_TRUE(calibration->depth.has_value()) << report;
  const DepthFit& depth = *calibration->depth;
  EXPECT_NEAR(depth.scale, 1.01, 4 * depth.scale_sigma + 1e-3) << report;
  EXPECT_LT(depth.scale_sigma, 5e-3) << report;
  ASSERT_TRUE(depth.has_offset) << report;
  EXPECT_NEAR(depth.offset_m, 0.004, 4 * depth.offset_sigma_m + 1e-3) << report;
  const double z = depth.far_m;
  EXPECT_NEAR(depth.noise.sigma_m(z) / truth.depth_noise.sigma_m(z), 1, 0.15) << report;
  EXPECT_NE(report.find("WARNING     depth is 1.0"), std::string::npos) << report;
  EXPECT_EQ(picture.width, 1200);
  const auto read = parse_camera(format_camera_file(*calibration, "chessboard:9x6:50mm"), "camera.toml");
  ASSERT_TRUE(read.is_ok()) << read.status().message();
  EXPECT_EQ(read->color.fx, calibration->camera.color.fx);
  EXPECT_EQ(read->depth_noise.quadratic_per_m, depth.noise.quadratic_per_m);
}

TEST(CalibrationTest, CharucoWithDepthThatIsNotRegistered) {
  RgbdCamera truth = registered_camera();
  truth.is_depth_registered = false;
  truth.depth.fx = truth.depth.fy = 430;
  truth.depth.cx = 240;
  truth.depth.cy = 180;
  truth.depth.lens = LensModel::kPinhole;
  truth.depth.distortion = {};
  truth.T_color_depth = {exp_so3({0.01, -0.02, 0.005}), {-0.025, 0.003, 0.004}};
  CalibrationOptions options;
  options.board = board_of("charuco:7x5:70mm:52mm:DICT_5X5_100");
  BoardSource source(options.board, truth, 16, 1.01, 0);
  const auto views = collect_views(&source, options, [](const CalibrationViews&) { return true; });
  ASSERT_TRUE(views.is_ok()) << views.status().message();
  options.known = truth;
  options.known->T_color_depth = {Eigen::Quaterniond::Identity(), {-0.04, 0, 0}};
  const auto calibration = calibrate(*views, options);
  ASSERT_TRUE(calibration.is_ok()) << calibration.status().message();
  for (const double z : z_scores(calibration->lens, truth.color)) EXPECT_LT(std::abs(z), 4);
  ASSERT_TRUE(calibration->extrinsic.has_value());
  const ExtrinsicFit& fit = *calibration->extrinsic;
  EXPECT_LT((fit.T_color_depth.translation - truth.T_color_depth.translation).norm(), 4 * fit.translation_sigma_m);
  EXPECT_LT(rotation_distance_rad(fit.T_color_depth.rotation, truth.T_color_depth.rotation), 4 * fit.rotation_sigma_rad);
  EXPECT_LT(fit.translation_sigma_m, 0.015);
  EXPECT_NEAR(fit.depth_scale, 1.01, 0.008) << "not taken up by the translation";
  EXPECT_LT(fit.rotation_sigma_rad, 0.004);
}

TEST(CalibrationTest, ImagesWithoutABoardAreRefused) {
  CalibrationOptions options;
  options.board = board_of("chessboard:9x6:25mm");
  const auto source = open_frame_source("sample://?rate_hz=0&frames=3&width=320&height=240");
  ASSERT_TRUE(source.is_ok());
  const auto views = collect_views(source->get(), options, [](const CalibrationViews&) { return true; });
  ASSERT_TRUE(views.is_ok());
  const auto calibration = calibrate(*views, options);
  ASSERT_FALSE(calibration.is_ok());
  EXPECT_NE(calibration.status().message().find("none of 3 images"), std::string::npos) << calibration.status().message();
}

}  // namespace
}  // namespace camloc::camera_tool
