// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A sheet is panels over one Scene: from above, in perspective, and where a fix is to be expected, with the list of weak places that
// the numbers in the picture belong to.
#include "tools/mapping/picture/map_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "tools/common/text_format.h"

namespace camloc::mapping {
namespace {

using tools::text_of;

constexpr Rgb kBackground{252, 252, 250}, kInk{40, 40, 46}, kSoftInk{110, 112, 120}, kFrame{222, 222, 218};
constexpr Rgb kLandmark{186, 190, 200}, kCamera{222, 70, 0}, kTrajectory{20, 20, 24};
constexpr double kTitlePx = 13, kTextPx = 10, kSmallPx = 9;
constexpr int kMarginPx = 24, kHeaderPx = 58, kPanelMarginPx = 46, kListHeightPx = 560;
constexpr double kWedgePx = 15, kWedgeHalfAngle = 0.42;
constexpr double kCameraPx = 13;
constexpr std::size_t kManyLandmarks = 60000;
constexpr double kBareM = 1.0;              // from the nearest keyframe; farther along the trajectory there was too little to see
constexpr double kMaxTrajectoryGapM = 1.0;  // a line across a gap would show a way that nobody went

void blit(const ColorImage& from, int u, int v, ColorImage* to) {
  for (int y = 0; y < from.height && v + y < to->height; ++y) {
    const auto row_bytes = 3 * static_cast<std::size_t>(std::max(0, std::min(from.width, to->width - u)));
    std::memcpy(
        to->pixels.data() + 3 * (static_cast<std::size_t>(v + y) * static_cast<std::size_t>(to->width) + static_cast<std::size_t>(u)),
        from.pixels.data() + 3 * static_cast<std::size_t>(y) * static_cast<std::size_t>(from.width), row_bytes);
  }
}

void draw_frame(PointRaster* raster, int width, int height, const std::string& title) {
  raster->add_rectangle(0, 0, width, 1, kFrame);
  raster->add_rectangle(0, height - 1, width, 1, kFrame);
  raster->add_rectangle(0, 0, 1, height, kFrame);
  raster->add_rectangle(width - 1, 0, 1, height, kFrame);
  raster->add_rectangle(1, 1, PointRaster::text_width(title, kTextPx) + 20, 28, kBackground);
  raster->add_text(12, 21, title, kTextPx, kInk);
}

void draw_height_legend(const Scene& scene, PointRaster* raster, int width, int height) {
  const auto tenths = [](double value) { return std::round(10 * value) / 10 + 0.0; };  // no "-0.0"
  raster->add_rectangle(width - 256, height - 44, 250, 42, kBackground);
  raster->add_legend(width - 246, height - 40, 230, text_of("height %.1f m", tenths(scene.low_m)), text_of("%.1f m", tenths(scene.high_m)),
                     paper_ramp());
}

void draw_trajectory(const Scene& scene, const Viewpoint& view, double line_px, PointRaster* raster) {
  const std::vector<Rigid3>& poses = scene.picture->trajectory;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const std::array line{poses[i - 1].translation, poses[i].translation};
    if ((line[1] - line[0]).norm() <= kMaxTrajectoryGapM) raster->add_line(view, line, kTrajectory, line_px);
  }
}

ColorImage draw_top(const Scene& scene, const Plan& plan, int width, int height) {
  PointRaster raster(width, height, kBackground);
  const Viewpoint view = top_view(plan, width, height, kPanelMarginPx);
  raster.add_points(view, scene.landmarks, scene.colors, 1.0);
  draw_trajectory(scene, view, 2, &raster);
  raster.add_cameras(view, scene.keyframes, kCameraPx, kCameraPx / view.px_per_m, kCamera);
  draw_frame(&raster, width, height,
             scene.is_cut ? "From above, cut 0.6 m above the cameras; triangles are keyframes" : "From above; triangles are keyframes");
  raster.add_rectangle(2, height - 34, width / 5 + 90, 32, kBackground);
  raster.add_scale_bar(view, 14, height - 18, kInk);
  draw_height_legend(scene, &raster, width, height);
  return raster.image();
}

ColorImage draw_perspective(const Scene& scene, int width, int height) {
  PointRaster raster(width, height, kBackground);
  std::vector<Eigen::Vector3d> framed = scene.landmarks;
  // Keyframes count a tenth of what landmarks do, or the percentiles would cut off those along bare walls.
  const std::size_t repeats = scene.landmarks.size() / (10 * std::max<std::size_t>(1, scene.keyframes.size())) + 1;
  for (const Rigid3& pose : scene.keyframes) framed.insert(framed.end(), repeats, pose.translation);
  const Viewpoint view = fit_perspective_view(framed, scene.up, width, height, 2 * kPanelMarginPx);
  raster.add_points(view, scene.landmarks, scene.colors, 1.0);
  draw_trajectory(scene, view, 2, &raster);
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : framed) middle += p / static_cast<double>(framed.size());
  raster.add_cameras(view, scene.keyframes, kCameraPx, kCameraPx * (view.T_view_world * middle).z() / view.px_per_m, kCamera);
  draw_frame(&raster, width, height, "In perspective");
  return raster.image();
}

/// Pixels of a wedge with its tip at the origin that opens to the right.
std::vector<Eigen::Vector2d> wedge_pixels(bool is_disc) {
  std::vector<Eigen::Vector2d> pixels;
  const double radius = is_disc ? 5 : kWedgePx;
  for (double y = -radius; y <= radius; y += 0.5) {
    for (double x = -radius; x <= radius; x += 0.5) {
      const double r = std::hypot(x, y);
      if (r <= radius && (is_disc || r < 2.5 || std::abs(std::atan2(y, x)) < kWedgeHalfAngle)) pixels.emplace_back(x, y);
    }
  }
  return pixels;
}

/// The keyframes of one outlook as wedges that open the way the camera looks.
void draw_wedges(const Scene& scene, const Viewpoint& view, FixOutlook outlook, PointRaster* raster) {
  const Eigen::Matrix3d axes = view.T_view_world.rotation.toRotationMatrix();
  const std::vector<Eigen::Vector2d> wedge = wedge_pixels(false), disc = wedge_pixels(true);
  std::vector<Eigen::Vector3d> points;
  for (std::uint32_t k = 0; k < scene.picture->places.size(); ++k) {
    if (scene.picture->places[k].outlook != outlook) continue;
    const Rigid3& T_map_camera = scene.keyframes[k];
    const Eigen::Vector2d ahead = (axes * (T_map_camera.rotation * Eigen::Vector3d::UnitZ())).head<2>();
    const bool is_disc = ahead.norm() < 0.3;  // looks up or down
    const Eigen::Vector2d right = is_disc ? Eigen::Vector2d(1, 0) : Eigen::Vector2d(ahead.normalized());
    // Drawn above everything else: weak places over good ones.
    const Eigen::Vector3d tip = T_map_camera.translation + scene.up * (100.0 + 10.0 * static_cast<double>(outlook));
    for (const Eigen::Vector2d& p : is_disc ? disc : wedge) {
      const Eigen::Vector2d turned(p.x() * right.x() - p.y() * right.y(), p.x() * right.y() + p.y() * right.x());
      points.push_back(tip + (axes.row(0) * turned.x() + axes.row(1) * turned.y()).transpose() / view.px_per_m);
    }
  }
  raster->add_points(view, points, color_of(outlook), 0.5);
}

void draw_bare_trajectory(const Scene& scene, const Viewpoint& view, PointRaster* raster) {
  const std::vector<Rigid3>& poses = scene.picture->trajectory;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const std::array line{poses[i - 1].translation, poses[i].translation};
    const auto is_near = [&](const Rigid3& keyframe) { return (keyframe.translation - line[1]).norm() < kBareM; };
    if ((line[1] - line[0]).norm() > kMaxTrajectoryGapM || std::any_of(scene.keyframes.begin(), scene.keyframes.end(), is_near)) continue;
    raster->add_line(view, line, color_of(FixOutlook::kScanAgain), 5);
  }
}

/// Numbers of the weak places, at the wide ends of their wedges, moved apart where they would cover each other.
void draw_numbers(const Scene& scene, const Viewpoint& view, PointRaster* raster) {
  const Eigen::Matrix3d axes = view.T_view_world.rotation.toRotationMatrix();
  std::vector<Eigen::Vector2d> taken;
  for (std::size_t i = 0; i < scene.picture->weak.size(); ++i) {
    const Rigid3& pose = scene.keyframes[scene.picture->weak[i].keyframe];
    const Eigen::Vector2d ahead = (axes * (pose.rotation * Eigen::Vector3d::UnitZ())).head<2>();
    const Eigen::Vector2d direction = ahead.norm() < 0.3 ? Eigen::Vector2d(0, -1) : Eigen::Vector2d(ahead.normalized());
    Eigen::Vector2d at = view.pixel_of(view.T_view_world * pose.translation) + (kWedgePx + 11) * direction;
    const auto collides = [&](const Eigen::Vector2d& other) { return (other - at).norm() < 22; };
    for (int tries = 0; tries < 20 && std::any_of(taken.begin(), taken.end(), collides); ++tries) at += 12 * direction;
    taken.push_back(at);
    const Eigen::Vector3d world = view.T_view_world.inverse() *
                                  Eigen::Vector3d((at.x() - view.center_u) / view.px_per_m, (at.y() - view.center_v) / view.px_per_m, 0);
    const Eigen::Vector3d above = world + scene.up * (1000 - scene.up.dot(world));
    raster->add_points(view, std::span(&above, 1), kInk, 10);
    const std::string number = std::to_string(i + 1);
    raster->add_text(static_cast<int>(at.x()) - PointRaster::text_width(number, kSmallPx) / 2, static_cast<int>(at.y()) + 5, number,
                     kSmallPx, kBackground);
  }
}

ColorImage draw_coverage(const Scene& scene, const Plan& plan, int width, int height) {
  PointRaster raster(width, height, kBackground);
  const Viewpoint view = top_view(plan, width, height, kPanelMarginPx);
  raster.add_points(view, scene.landmarks, kLandmark, scene.landmarks.size() < kManyLandmarks ? 1.0 : 0.5);
  for (const FixOutlook outlook : {FixOutlook::kLikely, FixOutlook::kLookAlike, FixOutlook::kScanAgain})
    draw_wedges(scene, view, outlook, &raster);
  draw_trajectory(scene, view, 1, &raster);
  draw_bare_trajectory(scene, view, &raster);
  draw_numbers(scene, view, &raster);
  draw_frame(&raster, width, height, "Where a fix is to be expected; a wedge opens the way the camera looked");
  raster.add_rectangle(2, height - 34, width / 5 + 90, 32, kBackground);
  raster.add_scale_bar(view, 14, height - 18, kInk);
  return raster.image();
}

/// `text` in lines of at most `width` pixels.
std::vector<std::string> wrapped(const std::string& text, int width, double height_px) {
  std::vector<std::string> lines(1);
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find(' ', begin), text.size());
    const std::string word = text.substr(begin, end - begin);
    const std::string longer = lines.back().empty() ? word : lines.back() + " " + word;
    if (!lines.back().empty() && PointRaster::text_width(longer, height_px) > width)
      lines.push_back(word);
    else
      lines.back() = longer;
    begin = end + 1;
  }
  return lines;
}

void draw_shares(const Scene& scene, PointRaster* raster, int* v) {
  const auto& places = scene.picture->places;
  for (const FixOutlook outlook : {FixOutlook::kLikely, FixOutlook::kLookAlike, FixOutlook::kScanAgain}) {
    const auto count =
        std::count_if(places.begin(), places.end(), [&](const KeyframeLocalizability& place) { return place.outlook == outlook; });
    const std::string share =
        text_of("%.1f %%", 100.0 * static_cast<double>(count) / static_cast<double>(std::max<std::size_t>(1, places.size())));
    raster->add_rectangle(12, *v - 12, 16, 14, color_of(outlook));
    raster->add_text(38, *v, words_for(outlook), kTextPx, kInk);
    raster->add_text(330 - PointRaster::text_width(share, kTextPx), *v, share, kTextPx, kInk);
    *v += 26;
  }
  raster->add_text(12, *v, "shares of keyframes; grey: landmarks", kSmallPx, kSoftInk);
  *v += 26;
  if (!scene.picture->trajectory.empty()) {
    raster->add_rectangle(12, *v - 6, 16, 2, kTrajectory);
    raster->add_text(38, *v, "walk", kSmallPx, kSoftInk);
    raster->add_rectangle(110, *v - 8, 16, 6, color_of(FixOutlook::kScanAgain));
    raster->add_text(136, *v, "no keyframe within 1 m of the walk", kSmallPx, kSoftInk);
    *v += 26;
  }
  *v += 10;
}

/// Legend and the list of weak places that the numbers belong to.
ColorImage draw_list(const Scene& scene, int width, int height) {
  PointRaster raster(width, height, kBackground);
  int v = 22;
  draw_shares(scene, &raster, &v);
  const MapView& map = *scene.picture->map;
  raster.add_text(12, v, scene.picture->weak.empty() ? "no weak places" : "worst places", kTextPx, kInk);
  v += 26;
  for (std::size_t i = 0; i < scene.picture->weak.size(); ++i) {
    const WeakPlace& weak = scene.picture->weak[i];
    const Eigen::Vector3d at = shown_position(map, weak.keyframe);
    const std::string head = text_of("%.1f %.1f %.1f  %s", at.x(), at.y(), at.z(), words_for(weak.outlook));
    const std::vector<std::string> lines = wrapped(explain(map, scene.picture->places[weak.keyframe]), width - 50, kSmallPx);
    if (v + 17 * static_cast<int>(lines.size()) > height - 8) break;
    raster.add_rectangle(12, v - 12, 20, 16, color_of(weak.outlook));
    const std::string number = std::to_string(i + 1);
    raster.add_text(22 - PointRaster::text_width(number, kSmallPx) / 2, v, number, kSmallPx,
                    weak.outlook == FixOutlook::kLookAlike ? kInk : kBackground);
    raster.add_text(40, v, head, kSmallPx, kInk);
    for (const std::string& line : lines) raster.add_text(40, v += 17, line, kSmallPx, kSoftInk);
    v += 25;
  }
  return raster.image();
}

/// Height of a panel of that width in which the plan fills both directions, within reason.
int height_for(const Plan& plan, int width, int least) {
  const double inner = std::max(1, width - 2 * kPanelMarginPx) * plan.v.length() / plan.u.length();
  return std::max(least, std::min(3 * width / 4, static_cast<int>(inner) + 2 * kPanelMarginPx + 20));
}

ColorImage row_of(const ColorImage& left, const ColorImage& right, int width) {
  ColorImage row = tools::blank_image(width, left.height, kBackground);
  blit(left, 0, 0, &row);
  blit(right, width - right.width, 0, &row);
  return row;
}

ColorImage draw_coverage_row(const Scene& scene, const Plan& plan, int width) {
  const int list_width = std::clamp(width / 3, 340, 500), map_width = std::max(1, width - list_width - kMarginPx);
  const int height = height_for(plan, map_width, kListHeightPx);
  return row_of(draw_coverage(scene, plan, map_width, height), draw_list(scene, list_width, height), width);
}

ColorImage draw_view_row(const Scene& scene, const Plan& plan, int width) {
  const int half = (width - kMarginPx) / 2, height = height_for(plan, half, half / 2);
  return row_of(draw_top(scene, plan, half, height), draw_perspective(scene, half, height), width);
}

ColorImage draw_panels(const Scene& scene, MapPanel panel, int width) {
  const Plan plan = make_plan(scene);
  if (panel == MapPanel::kTop) return draw_top(scene, plan, width, height_for(plan, width, width / 3));
  if (panel == MapPanel::kPerspective) return draw_perspective(scene, width, 5 * width / 8);
  if (panel == MapPanel::kCoverage) return draw_coverage_row(scene, plan, width);
  const ColorImage views = draw_view_row(scene, plan, width), coverage = draw_coverage_row(scene, plan, width);
  ColorImage sheet = tools::blank_image(width, views.height + kMarginPx + coverage.height, kBackground);
  blit(views, 0, 0, &sheet);
  blit(coverage, 0, views.height + kMarginPx, &sheet);
  return sheet;
}

std::string title_of(const MapInfo& info) {
  return (info.name.empty() ? info.path : info.name) + ":  " + std::to_string(info.num_landmarks) + " landmarks, " +
         std::to_string(info.num_keyframes) + " keyframes, " + std::to_string(info.file_bytes / 1000) + " kB" +
         (info.wcs ? ", in site coordinates" : "");
}

}  // namespace

Rgb color_of(FixOutlook outlook) {
  constexpr Rgb kColors[] = {{86, 180, 233}, {230, 159, 0}, {150, 40, 90}};
  return kColors[static_cast<std::size_t>(outlook)];
}

ColorImage draw_map(const MapPicture& picture, MapPanel panel, int width_px) {
  const Scene scene = make_scene(picture);
  const ColorImage panels = draw_panels(scene, panel, width_px - 2 * kMarginPx);
  ColorImage sheet = tools::blank_image(width_px, panels.height + kHeaderPx + kMarginPx, kBackground);
  tools::draw_text(&sheet, kMarginPx, 36, title_of(picture.map->info()), kTitlePx, kInk);
  blit(panels, kMarginPx, kHeaderPx, &sheet);
  return sheet;
}

}  // namespace camloc::mapping
