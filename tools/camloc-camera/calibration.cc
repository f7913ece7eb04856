// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/camloc-camera/calibration.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/io/camera_file.h"
#include "tools/common/text_format.h"

namespace camloc::camera_tool {
namespace {

using tools::append_text;
using tools::llu;
using tools::text_of;

constexpr std::chrono::milliseconds kPoll(100);
constexpr std::uint64_t kMaxLookedAt = 600;
constexpr std::size_t kMaxCandidates = 150, kMaxHeldOut = 15;  // different views
constexpr double kMinShift = 0.03;                             // of the image's width, by which a view must differ from the others
constexpr double kGoodCoverage = 0.75;
constexpr double kHeldOutRatio = 1.6;     // held-out over fitted error; more is a lens that was fitted to noise
constexpr double kMinScaleError = 0.003;  // a printed board is rarely better

/// Error of the lens on views it has not seen.
void test_on_held_out(const CalibrationViews& views, const CalibrationOptions& options, Calibration* calibration) {
  double squares = 0;
  for (const std::size_t index : calibration->held_out) {
    const BoardCorners& corners = views.views[index].corners;
    const Result<Rigid3> T_camera_board = find_board(options.board, corners, calibration->camera.color);
    if (!T_camera_board) continue;
    for (const Eigen::Vector2d& error : reprojection_errors(options.board, corners, calibration->camera.color, *T_camera_board))
      squares += error.squaredNorm();
    calibration->num_held_out_corners += corners.ids.size();
  }
  if (calibration->num_held_out_corners > 0)
    calibration->held_out_rms_px = std::sqrt(squares / static_cast<double>(calibration->num_held_out_corners));
}

void measure_depth(const CalibrationViews& views, const CalibrationOptions& options, Calibration* calibration) {
  std::vector<BoardView> used;
  for (const std::size_t index : calibration->lens.used) used.push_back(views.views[index]);
  RgbdCamera& camera = calibration->camera;
  const auto has_depth = [](const BoardView& view) { return !view.depth.pixels.empty(); };
  if (!options.wants_depth || std::none_of(used.begin(), used.end(), has_depth)) return;
  if (!camera.is_depth_registered) {
    const Result<ExtrinsicFit> extrinsic = fit_extrinsic(options.board, used, calibration->lens.T_camera_board, camera);
    if (!extrinsic) return calibration->warnings.push_back("depth to colour kept as it was: " + extrinsic.status().message());
    calibration->extrinsic = *extrinsic;
    camera.T_color_depth = extrinsic->T_color_depth;
  }
  const Result<DepthFit> depth = fit_depth(options.board, used, calibration->lens.T_camera_board, camera);
  if (!depth) return calibration->warnings.push_back("depth not checked: " + depth.status().message());
  calibration->depth = *depth;
  // A focal length that is too long puts the board too far away: no comparison with depth is better than that.
  const double focal_sigma = calibration->lens.sigma[0] / camera.color.fx;
  calibration->depth->scale_sigma = std::hypot(depth->scale_sigma, focal_sigma);
  camera.depth_noise = depth->noise;
  if (options.corrects_depth_unit) camera.depth_unit_m /= depth->scale;
}

void warn_of_doubts(const CalibrationOptions& options, Calibration* calibration) {
  if (calibration->grid.covered() < kGoodCoverage) {
    const std::string sides = calibration->grid.bare_sides();
    calibration->warnings.push_back(text_of("only %.0f %% of the image was covered; the lens is guessed elsewhere: show the board %s",
                                            100 * calibration->grid.covered(),
                                            sides.empty() ? "near the corners, too" : ("at " + sides + " of the image").c_str()));
  }
  if (calibration->num_held_out_corners > 0 && calibration->held_out_rms_px > kHeldOutRatio * calibration->lens.rms_px) {
    calibration->warnings.push_back(text_of("views that were held out fit worse, %.2f px instead of %.2f; take more views",
                                            calibration->held_out_rms_px, calibration->lens.rms_px));
  }
  if (!calibration->depth || options.corrects_depth_unit) return;
  const DepthFit& depth = *calibration->depth;
  if (std::abs(depth.scale - 1) > std::max(3 * depth.scale_sigma, kMinScaleError)) {
    calibration->warnings.push_back(text_of(
        "depth is %.4f times the board's distance: measure a square of the board with a ruler; if it is right, correct the unit with "
        "--correct-depth-unit",
        depth.scale));
  }
}

std::string format_lens(const LensFit& lens) {
  const Intrinsics& k = lens.intrinsics;
  std::string text = text_of("  fx %10.3f +- %.3f px    cx %9.3f +- %.3f px\n  fy %10.3f +- %.3f px    cy %9.3f +- %.3f px\n", k.fx,
                             lens.sigma[0], k.cx, lens.sigma[2], k.fy, lens.sigma[1], k.cy, lens.sigma[3]);
  static constexpr const char* kBrown[] = {"k1", "k2", "p1", "p2", "k3"};
  static constexpr const char* kEquidistant[] = {"k1", "k2", "k3", "k4"};
  const std::size_t count = k.lens == LensModel::kBrownConrady ? 5 : k.lens == LensModel::kEquidistant ? 4 : 0;
  for (std::size_t i = 0; i < count; ++i) {
    const char* name = k.lens == LensModel::kEquidistant ? kEquidistant[i] : kBrown[i];
    if (lens.distortion_sigma[i] > 0) {
      append_text(&text, "  %s %10.5f +- %.5f\n", name, k.distortion[i], lens.distortion_sigma[i]);
    } else {
      append_text(&text, "  %s          0 (the views do not determine it)\n", name);
    }
  }
  return text;
}

std::string format_views(const LensFit& lens, const CalibrationViews& views) {
  std::string text = "  frame  corners  rms px  distance m\n";
  std::vector<std::size_t> order(lens.used.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&lens](std::size_t a, std::size_t b) { return lens.used[a] < lens.used[b]; });
  for (const std::size_t i : order) {
    const BoardView& view = views.views[lens.used[i]];
    append_text(&text, "  %5llu  %7zu  %6.3f  %10.2f\n", llu(view.sequence), view.corners.ids.size(), lens.view_rms_px[i],
                lens.T_camera_board[i].translation.norm());
  }
  for (const std::size_t index : lens.dropped) {
    append_text(&text, "  %5llu  %7zu  dropped: does not fit the others\n", llu(views.views[index].sequence),
                views.views[index].corners.ids.size());
  }
  return text;
}

std::string format_depth(const DepthFit& depth) {
  std::string text = text_of("depth       %zu views from %.2f to %.2f m: measured = %.4f (+- %.4f) * true", depth.planes.size(),
                             depth.near_m, depth.far_m, depth.scale, depth.scale_sigma);
  if (depth.has_offset) append_text(&text, " %+.1f (+- %.1f) mm", 1e3 * depth.offset_m, 1e3 * depth.offset_sigma_m);
  append_text(&text, "\n            noise of a pixel: %.2f mm + %.2f mm * (z / m)^2\n", 1e3 * depth.noise.constant_m,
              1e3 * depth.noise.quadratic_per_m);
  text += "     z m  measured - true mm  noise mm  pixels\n";
  const std::size_t step = std::max<std::size_t>(1, depth.planes.size() / 10);
  for (std::size_t i = 0; i < depth.planes.size(); i += step) {
    const DepthPlane& plane = depth.planes[i];
    append_text(&text, "  %6.2f  %18.1f  %8.2f  %6zu\n", plane.true_z_m, 1e3 * (plane.z_m - plane.true_z_m), 1e3 * plane.noise_m,
                plane.num_pixels);
  }
  return text;
}

std::string format_extrinsic(const ExtrinsicFit& fit) {
  const Eigen::Vector3d t = 1e3 * fit.T_color_depth.translation, r = log_so3(fit.T_color_depth.rotation);
  return text_of(
      "depth camera at %.1f %.1f %.1f mm (+- %.1f) of the colour camera, turned by %.2f %.2f %.2f deg (+- %.2f); planes agree to %.1f mm "
      "and %.2f deg\n",
      t.x(), t.y(), t.z(), 1e3 * fit.translation_sigma_m, tools::degrees(r.x()), tools::degrees(r.y()), tools::degrees(r.z()),
      tools::degrees(fit.rotation_sigma_rad), 1e3 * fit.distance_rms_m, tools::degrees(fit.normal_rms_rad));
}

}  // namespace

Result<CalibrationViews> collect_views(FrameSource* source, const CalibrationOptions& options, const CollectProgress& progress) {
  CalibrationViews views;
  FrameBuffer frame;
  // Looking for the board takes 0.1 s; a long recording shows the same again and again.
  const std::uint64_t step = std::max<std::uint64_t>(1, source->info().num_frames.value_or(0) / kMaxLookedAt);
  while (views.views.size() < kMaxCandidates) {
    const Status status = source->next(&frame, kPoll);
    if (status.code() == ErrorCode::kEnd) break;
    if (status.code() == ErrorCode::kTimeout || status.code() == ErrorCode::kCorrupt) {
      if (!progress(views)) break;
      continue;
    }
    if (!status) {
      if (views.num_frames == 0) return status;
      break;
    }
    ++views.num_frames;
    if (views.width == 0) views.width = frame.gray.width, views.height = frame.gray.height;
    if (frame.gray.width != views.width || frame.gray.height != views.height) continue;
    if ((views.num_frames - 1) % step != 0) continue;
    BoardCorners corners = detect_board(options.board, frame.gray);
    views.num_with_board += corners.ids.empty() ? 0 : 1;
    if (!corners.ids.empty() && is_new_view(corners, views.views, kMinShift * views.width)) {
      views.views.push_back({frame.sequence, std::move(corners), options.wants_depth ? frame.depth : Image<std::uint16_t>{}});
    }
    if (!progress(views)) break;
  }
  views.source_camera = source->info().camera;
  return views;
}

Result<Calibration> calibrate(const CalibrationViews& views, const CalibrationOptions& options) {
  if (views.views.empty()) {
    return Status(
        ErrorCode::kInvalid,
        text_of(
            "the board was seen in none of %llu images; check --board, light, and that all of the board with its white margin is in view",
            llu(views.num_frames)));
  }
  const ViewChoice choice = choose_views(options.board, views.views, views.width, views.height, options.max_views, kMaxHeldOut);
  std::vector<BoardView> chosen;
  for (const std::size_t index : choice.fit) chosen.push_back({views.views[index].sequence, views.views[index].corners, {}});
  Result<LensFit> lens = fit_lens(options.board, chosen, views.width, views.height, options.lens);
  if (!lens) return lens.status();
  for (auto* indices : {&lens->used, &lens->dropped}) {
    for (std::size_t& index : *indices) index = choice.fit[index];
  }

  Calibration calibration;
  const std::optional<RgbdCamera>& known = options.known ? options.known : views.source_camera;
  if (known) calibration.camera = *known;
  if (calibration.camera.name.empty()) calibration.camera.name = "calibrated";
  calibration.camera.color = lens->intrinsics;
  if (calibration.camera.is_depth_registered) calibration.camera.depth = lens->intrinsics;
  calibration.lens = std::move(lens).value();
  calibration.held_out = choice.held_out;
  calibration.grid = {views.width, views.height};
  for (const std::size_t index : calibration.lens.used) calibration.grid.add(views.views[index].corners);
  test_on_held_out(views, options, &calibration);
  measure_depth(views, options, &calibration);
  warn_of_doubts(options, &calibration);
  if (Status status = calibration.camera.validate(); !status) return status;
  return calibration;
}

std::string format_report(const Calibration& calibration, const CalibrationViews& views) {
  const LensFit& lens = calibration.lens;
  std::string text = text_of("images      %llu, the board in %llu, %zu of them unlike each other\n", llu(views.num_frames),
                             llu(views.num_with_board), views.views.size());
  append_text(&text, "views       %zu used, %zu dropped, %zu held out; %.0f %% of the image covered, tilt up to %.0f deg\n",
              lens.used.size(), lens.dropped.size(), calibration.held_out.size(), 100 * calibration.grid.covered(),
              tools::degrees(lens.max_tilt_rad));
  append_text(&text, "error       %.3f px rms", lens.rms_px);
  if (calibration.num_held_out_corners > 0) append_text(&text, ", %.3f px on the views held out", calibration.held_out_rms_px);
  text += "\nlens (standard deviations)\n" + format_lens(lens) + format_views(lens, views);
  if (calibration.extrinsic) text += format_extrinsic(*calibration.extrinsic);
  if (calibration.depth) text += format_depth(*calibration.depth);
  for (const std::string& warning : calibration.warnings) text += "WARNING     " + warning + "\n";
  return text;
}

std::string format_camera_file(const Calibration& calibration, const std::string& board_text) {
  const LensFit& lens = calibration.lens;
  std::string text =
      text_of("# camloc camera calibrate --board %s: %zu views, %.3f px rms", board_text.c_str(), lens.used.size(), lens.rms_px);
  if (calibration.num_held_out_corners > 0)
    append_text(&text, ", %.3f px on %zu views held out", calibration.held_out_rms_px, calibration.held_out.size());
  append_text(&text, "\n# standard deviations: fx %.3f fy %.3f cx %.3f cy %.3f px\n", lens.sigma[0], lens.sigma[1], lens.sigma[2],
              lens.sigma[3]);
  if (calibration.depth) {
    append_text(&text, "# depth: measured = %.4f (+- %.4f) * true %+.1f mm, %.2f to %.2f m\n", calibration.depth->scale,
                calibration.depth->scale_sigma, 1e3 * calibration.depth->offset_m, calibration.depth->near_m, calibration.depth->far_m);
  }
  return text + format_camera_toml(calibration.camera);
}

}  // namespace camloc::camera_tool
