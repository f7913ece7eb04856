// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <filesystem>
#include <map>

#include "core/geometry/depth_registration.h"
#include "core/io/camera_file.h"
#include "core/io/image_file.h"
#include "core/io/text.h"
#include "tools/common/text_format.h"
#include "tools/mapping/colmap/colmap_model.h"

namespace camloc::mapping {
namespace {

constexpr std::size_t kMaxScaleImages = 60;
constexpr double kMaxLensDifferencePx = 4;  // self-calibration scatters by one or two

std::string file_name(const std::string& path) { return std::filesystem::path(path).filename().string(); }

/// Of the cameras that took an image.
Status check_image_sizes(const ColmapModel& model, const Intrinsics& color) {
  for (const ColmapCamera& camera : model.cameras) {
    if (std::none_of(model.images.begin(), model.images.end(), [&](const ColmapImage& image) { return image.camera_id == camera.id; }))
      continue;
    if (camera.width == color.width && camera.height == color.height) continue;
    return {ErrorCode::kInvalid, tools::text_of("camera %u of the model takes images of %dx%d, the camera file says %dx%d; "
                                                "make the model from the recording's own images",
                                                camera.id, camera.width, camera.height, color.width, color.height)};
  }
  return Status::ok();
}

/// Where the model's lens and the camera file's show the same ray, pixels apart; one line for the camera that is worst.
void note_other_lens(const ColmapModel& model, const Intrinsics& color, std::vector<std::string>* notes) {
  double worst_px = kMaxLensDifferencePx;
  std::string note;
  for (const ColmapCamera& camera : model.cameras) {
    const auto lens = colmap_intrinsics(camera.model, camera.width, camera.height, camera.parameters);
    if (!lens.is_ok()) {
      notes->push_back("the lens of the model's camera " + std::to_string(camera.id) + " was not compared: " + lens.status().message());
      continue;
    }
    if (camera.width != color.width || camera.height != color.height) continue;  // took no image of the recording
    double most_px = 0;
    for (int i = 0; i <= 8; ++i) {
      for (int j = 0; j <= 8; ++j) {
        const Eigen::Vector2d pixel((color.width - 1) * i / 8.0, (color.height - 1) * j / 8.0);
        most_px = std::max(most_px, (lens->distort(color.undistort(pixel)) - pixel).norm());
      }
    }
    if (most_px <= worst_px) continue;
    worst_px = most_px;
    note = tools::text_of(
        "camera %u of the model (fx %.1f px) and the camera file (fx %.1f px) disagree: the same ray is up to %.1f px apart. "
        "One of them is wrong; 'camloc camera import %s' takes over the model's",
        camera.id, lens->fx, color.fx, most_px, "cameras.txt");
  }
  if (!note.empty()) notes->push_back(note);
}

void append_pairs(const ColmapModel& model, std::uint32_t index, const Intrinsics& size, const DepthLookup& lookup,
                  ImageView<std::uint16_t> depth, std::vector<DepthPair>* pairs) {
  const ColmapImage& image = model.images[index];
  for (const ColmapObservation& seen : image.observations) {
    if (!(seen.u >= 0 && seen.v >= 0 && seen.u <= size.width && seen.v <= size.height)) continue;
    const double model_depth = (image.T_camera_world * model.points[seen.point].position).z();
    if (!(model_depth > 0)) continue;
    const float measured_m =
        lookup.depth_at(depth, static_cast<float>(seen.u - kColmapPixelShift), static_cast<float>(seen.v - kColmapPixelShift));
    if (measured_m > 0) pairs->push_back({index, model_depth, static_cast<double>(measured_m)});
  }
}

/// Depth pairs of images that are spread evenly over the recording.
Result<std::vector<DepthPair>> measure_depths(const ColmapModel& model, const std::vector<std::size_t>& frame_of_image,
                                              const Sequence& sequence, const RgbdCamera& camera) {
  std::map<std::size_t, std::uint32_t> image_of_frame;  // those that say something about scale, in the recording's order
  for (std::uint32_t i = 0; i < model.images.size(); ++i) {
    const bool has_depth = !sequence.frames[frame_of_image[i]].depth_path.empty();
    if (has_depth && !model.images[i].observations.empty()) image_of_frame.emplace(frame_of_image[i], i);
  }
  std::vector<std::uint32_t> images;
  for (const auto& [frame, image] : image_of_frame) images.push_back(image);
  const std::size_t count = std::min(kMaxScaleImages, images.size());
  const DepthLookup lookup(camera);
  ImageReader reader;
  Image<std::uint16_t> depth;
  std::vector<DepthPair> pairs;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t image = images[i * images.size() / count];
    const std::string& path = sequence.frames[frame_of_image[image]].depth_path;
    if (!reader.read_depth(path, &depth).is_ok()) continue;  // the build will count it as broken
    if (depth.width != camera.depth.width || depth.height != camera.depth.height) {
      return {ErrorCode::kInvalid, path + tools::text_of(": is %dx%d, the camera file says %dx%d", depth.width, depth.height,
                                                         camera.depth.width, camera.depth.height)};
    }
    append_pairs(model, image, camera.color, lookup, depth.view(), &pairs);
  }
  return pairs;
}

/// Frame index of each image of the model: the frame whose colour file has the same name; folders in front do not count.
/// Images that no frame fits are taken out of the model.
Result<std::vector<std::size_t>> match_image_names(const Sequence& sequence, ColmapModel* model, std::vector<std::string>* notes) {
  std::map<std::string, std::vector<std::size_t>> frames_of_name;
  for (std::size_t i = 0; i < sequence.frames.size(); ++i) frames_of_name[file_name(sequence.frames[i].color_path)].push_back(i);
  std::vector<std::size_t> frame_of_image;
  std::map<std::size_t, std::string> image_of_frame;
  const auto is_foreign = [&](const ColmapImage& image) { return !frames_of_name.contains(file_name(image.name)); };
  const auto first_foreign = std::find_if(model->images.begin(), model->images.end(), is_foreign);
  const std::string foreign_name = first_foreign == model->images.end() ? "" : first_foreign->name;
  const std::size_t num_foreign = std::erase_if(model->images, is_foreign);
  if (model->images.empty()) {
    return {ErrorCode::kInvalid, "image " + in_quotes(foreign_name) + " of the model is no colour image of the recording (its first is " +
                                     in_quotes(file_name(sequence.frames.front().color_path)) +
                                     "), and no other image is; names must be the same but for folders"};
  }
  if (num_foreign > 0) {
    notes->push_back(std::to_string(num_foreign) + (num_foreign == 1 ? " image of the model is" : " images of the model are") +
                     " none of the recording, left out: " + in_quotes(foreign_name) + (num_foreign == 1 ? "" : " and so on"));
  }
  for (const ColmapImage& image : model->images) {
    const auto frames = frames_of_name.find(file_name(image.name));
    if (frames->second.size() > 1) {
      return {ErrorCode::kInvalid,
              "image " + in_quotes(image.name) + " of the model fits several frames of the recording; file names must differ"};
    }
    const auto [other, is_new] = image_of_frame.emplace(frames->second.front(), image.name);
    if (!is_new) {
      return {ErrorCode::kInvalid,
              "images " + in_quotes(other->second) + " and " + in_quotes(image.name) + " of the model are the same frame of the recording"};
    }
    frame_of_image.push_back(frames->second.front());
  }
  return frame_of_image;
}

}  // namespace

Result<ColmapPoses> read_colmap_poses(const std::string& folder, const Sequence& sequence, const RgbdCamera& camera) {
  auto model = read_colmap_model(folder);
  if (!model) return model.status();
  std::vector<std::string> notes;
  const auto frame_of_image = match_image_names(sequence, &*model, &notes);
  if (!frame_of_image) return frame_of_image.status().with_context(folder);
  if (const Status sizes = check_image_sizes(*model, camera.color); !sizes.is_ok()) return sizes.with_context(folder);
  note_other_lens(*model, camera.color, &notes);
  const auto pairs = measure_depths(*model, *frame_of_image, sequence, camera);
  if (!pairs) return pairs.status();
  const auto scale = estimate_model_scale(*pairs);
  if (!scale) return scale.status().with_context(folder);
  ColmapPoses poses{std::vector<std::optional<Rigid3>>(sequence.frames.size()), *scale, std::move(notes)};
  for (std::size_t i = 0; i < model->images.size(); ++i) {
    Rigid3 T_map_camera = model->images[i].T_camera_world.inverse();
    T_map_camera.translation *= scale->metres_per_unit;
    poses.T_map_camera[(*frame_of_image)[i]] = T_map_camera;
  }
  return poses;
}

}  // namespace camloc::mapping
