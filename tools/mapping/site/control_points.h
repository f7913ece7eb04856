// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Control points: surveyed points of the site, and where the map or a recording sees them.
//
// Points file, coordinates of the site (`wcs`, metres):     name x y z [sigma_m]
// Observed file, any number of lines for a name:            name map x y z [sigma_m]          picked in an export of the map
//                                                           name landmark INDEX [sigma_m]     a landmark of the map
//                                                           name pixel FRAME u v [sigma_px]   a pixel of a recorded frame
// '#' starts a comment. Fields are separated by blanks, or by ';', tabs or ',' (then names may hold blanks; see table_row.h). A first line
// of column titles (name, x/easting, y/northing, z/height, sigma) gives the points file another order of columns.
//
// How a bundle adjustment takes pixels: measure_pixel() where the frame is at hand, and the PixelMeasurement's normalized
// coordinates and depth are an observation of the control point's landmark; or resolve_observations() with its own poses.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/frame.h"
#include "core/base/result.h"
#include "core/base/work_observer.h"
#include "core/geometry/camera.h"
#include "core/geometry/depth_registration.h"
#include "core/geometry/wcs.h"
#include "core/map/map_view.h"

namespace camloc::mapping {

inline constexpr double kDefaultPointSigmaM = 0.01;   ///< of a surveyed coordinate
inline constexpr double kDefaultPickedSigmaM = 0.02;  ///< of a position picked in the map
inline constexpr double kDefaultPixelSigmaPx = 1.0;   ///< of a pixel picked in an image

struct ControlPoint {
  std::string name;
  Eigen::Vector3d p_wcs = Eigen::Vector3d::Zero();
  double sigma_m = kDefaultPointSigmaM;  ///< per axis
  int line = 0;
};

enum class ObservationKind : std::uint8_t { kMapPosition, kLandmark, kPixel };

struct ControlObservation {
  std::string name;
  ObservationKind kind = ObservationKind::kMapPosition;
  Eigen::Vector3d p_map = Eigen::Vector3d::Zero();  ///< kMapPosition
  std::uint32_t landmark = 0;                       ///< kLandmark
  std::uint64_t frame = 0;                          ///< kPixel: index in the whole recording
  double u = 0, v = 0;                              ///< kPixel: of the colour image, as recorded (distorted)
  double sigma = 0;                                 ///< metres, for kPixel pixels; 0 for a landmark: what the map says of it
  int line = 0;
};

/// Errors (kInvalid) name file, line and field. Names are unique, coordinates finite and below 1e8 m.
[[nodiscard]] Result<std::vector<ControlPoint>> parse_control_points(std::string_view text, const std::string& file_name);
[[nodiscard]] Result<std::vector<ControlObservation>> parse_control_observations(std::string_view text, const std::string& file_name);
/// The same from files; also kNotFound, kIo.
[[nodiscard]] Result<std::vector<ControlPoint>> read_control_points(const std::string& path);
[[nodiscard]] Result<std::vector<ControlObservation>> read_control_observations(const std::string& path);

/// "pixel (320.5, 240.0) of frame 12", for messages.
[[nodiscard]] std::string describe(const ControlObservation& observation);

/// A control point's pixel with what its own frame knows: an observation as bundle adjustment takes it.
struct PixelMeasurement {
  Eigen::Vector2d normalized = Eigen::Vector2d::Zero();  ///< undistorted image coordinates x/z, y/z
  double depth_m = 0;                                    ///< along the optical axis of the colour camera
  double sigma_px = kDefaultPixelSigmaPx;
};

/// `lookup` belongs to `camera`, `depth` is the frame's depth image. kInvalid: the pixel is outside of the image; kNotFound:
/// there is no depth, or the pixel is at the edge of something.
[[nodiscard]] Result<PixelMeasurement> measure_pixel(const ControlObservation& pixel, const RgbdCamera& camera, const DepthLookup& lookup,
                                                     ImageView<std::uint16_t> depth);

/// By the line of the observation; an error says why there is none.
using PixelMeasurements = std::map<int, Result<PixelMeasurement>>;

/// measure_pixel() for every observation that is in this frame of a recording (Frame::sequence): a pass over a recording calls it
/// frame by frame and resolves with the final poses.
void measure_pixels(const std::vector<ControlObservation>& observations, const RgbdCamera& camera, const DepthLookup& lookup,
                    const Frame& frame, PixelMeasurements* measurements);

/// One measurement of a point in the map.
struct PointMeasurement {
  std::string name;
  Eigen::Vector3d p_map = Eigen::Vector3d::Zero();
  double sigma_m = 0;  ///< per axis
  std::string source;  ///< see describe()
};

/// The measured pixel as a point of the map; its sigma has the pixel's, the depth's and the pose's.
[[nodiscard]] PointMeasurement to_map(const ControlObservation& pixel, const PixelMeasurement& measurement, const RgbdCamera& camera,
                                      const PoseWithCovariance& T_map_camera);

/// Where the answers come from: a finished map, a localizer, or a SLAM that still runs. What is not set is not there. An
/// error says why there is no answer, to the user.
struct ControlSources {
  std::function<Result<PoseWithCovariance>(std::uint64_t frame)> T_map_camera;
  std::function<Result<PixelMeasurement>(const ControlObservation& pixel)> pixel;
  std::function<Result<PointMeasurement>(std::uint32_t landmark)> landmark;  ///< name and source are filled in
};

struct ResolvedObservations {
  std::vector<PointMeasurement> measurements;  ///< in the order of the observations
  std::vector<std::string> left_out;           ///< "C3, pixel (3.0, 4.0) of frame 12: no depth there"
};
[[nodiscard]] ResolvedObservations resolve_observations(const std::vector<ControlObservation>& observations, const RgbdCamera& camera,
                                                        const ControlSources& sources);

/// All measurements of one name, averaged by weight.
struct ObservedPoint {
  std::string name;
  Eigen::Vector3d p_map = Eigen::Vector3d::Zero();
  double sigma_m = 0;    ///< from the sigmas or from the scatter, whichever is larger
  double scatter_m = 0;  ///< root mean square distance from the mean; 0 for a single one
  std::size_t num_measurements = 0;
  std::string farthest;  ///< set where they disagree by more than their sigmas explain: the one farthest from the mean
};
/// In the order in which the names come first.
[[nodiscard]] std::vector<ObservedPoint> average_measurements(const std::vector<PointMeasurement>& measurements);

/// A control point known in the map and in a cloud: a line "name map_x map_y map_z cloud_x cloud_y cloud_z [sigma]" of a text file,
/// metres, separated and commented as a points file; a first line without numbers is titles.
struct ControlPair {
  std::string name;
  Eigen::Vector3d p_map, p_cloud;
  double sigma_m = 0.01;
};

/// Errors name file and line: a wrong number of fields, what is no finite number, a sigma that is not positive, a name used
/// twice, fewer than three pairs.
[[nodiscard]] Result<std::vector<ControlPair>> parse_point_pairs(std::string_view text, const std::string& path);
[[nodiscard]] Result<std::vector<ControlPair>> read_point_pairs(const std::string& path);

/// What one frame had to say. Errors are reasons for people.
struct LocalizedFrame {
  Result<PoseWithCovariance> T_map_camera = Status(ErrorCode::kNotFound, "the recording has no such frame, or it cannot be read");
  PixelMeasurements measurements;
};

/// Localizes the frames that `observations` have pixels in. A few frames before each are run through the localizer too, so
/// that it may track. Errors are those of opening the recording, kInvalid where its images are not the camera's, kIo where `observer` wants
/// to stop.
[[nodiscard]] Result<std::map<std::uint64_t, LocalizedFrame>> localize_frames(const MapView& map, const RgbdCamera& camera,
                                                                              const std::string& sequence_url,
                                                                              const std::vector<ControlObservation>& observations,
                                                                              const WorkObserver& observer);

}  // namespace camloc::mapping
