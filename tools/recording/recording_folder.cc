// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/recording/recording_folder.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <vector>

#include "core/geometry/gravity.h"
#include "core/io/camera_file.h"
#include "core/io/file_bytes.h"
#include "tools/common/text_format.h"

namespace camloc::tools {
namespace {

namespace fs = std::filesystem;

constexpr std::array kRecordingFiles{"rgb.txt", "depth.txt", "accelerometer.txt", "camera.toml"};

Status io_error(const std::string& path) { return {ErrorCode::kIo, path + ": " + std::strerror(errno)}; }

bool is_image_name(const fs::path& path) { return path.extension() == ".png" || path.extension() == ".jpg"; }

/// Entries of `folder` that a recorder did not write; the name of the first, or "".
std::string first_stranger(const fs::path& folder) {
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    if (name == "rgb" || name == "depth") {
      for (const fs::directory_entry& image : fs::directory_iterator(entry.path(), error)) {
        if (!is_image_name(image.path())) return name + "/" + image.path().filename().string();
      }
    } else if (std::find(kRecordingFiles.begin(), kRecordingFiles.end(), name) == kRecordingFiles.end()) {
      return name;
    }
  }
  return "";
}

Status remove_old(const std::string& path) {
  if (const std::string stranger = first_stranger(path); !stranger.empty()) {
    return {ErrorCode::kInvalid, "--out " + path + ": holds " + stranger + ", which camloc record did not write; choose another folder"};
  }
  std::error_code error;
  for (const char* name : {"rgb", "depth"}) fs::remove_all(fs::path(path) / name, error);
  for (const char* name : kRecordingFiles) fs::remove(fs::path(path) / name, error);
  return fs::is_empty(path, error) ? Status::ok() : Status(ErrorCode::kIo, path + ": the old recording cannot be deleted");
}

std::vector<std::uint8_t> rgb_bytes(const Image<Bgr>& color) {
  std::vector<std::uint8_t> bytes(3 * color.pixels.size());
  std::uint8_t* out = bytes.data();
  for (const Bgr& pixel : color.pixels) {
    *out++ = pixel.r;
    *out++ = pixel.g;
    *out++ = pixel.b;
  }
  return bytes;
}

}  // namespace

std::string stamp_text(std::int64_t stamp_ns) {
  return text_of("%lld.%09lld", static_cast<long long>(stamp_ns / 1'000'000'000), static_cast<long long>(stamp_ns % 1'000'000'000));
}

Result<std::uint64_t> free_bytes_at(const std::string& path) {
  std::error_code error;
  fs::path folder = fs::absolute(path, error);
  while (!fs::exists(folder, error) && folder.has_relative_path()) folder = folder.parent_path();
  struct statvfs space {};
  if (::statvfs(folder.c_str(), &space) != 0) return io_error(folder.string());
  return std::uint64_t{space.f_bavail} * space.f_frsize;
}

Result<RecordingFolder> RecordingFolder::create(const std::string& path, const RecordingFormat& format, bool replaces_old) {
  std::error_code error;
  if (path.empty()) return Status(ErrorCode::kInvalid, "--out: is empty; give a folder");
  if (fs::exists(path, error) && !fs::is_directory(path, error)) return Status(ErrorCode::kInvalid, "--out " + path + ": is no folder");
  if (fs::is_directory(path, error) && !fs::is_empty(path, error)) {
    if (!replaces_old)
      return Status(ErrorCode::kInvalid, "--out " + path + ": is not empty; choose another folder, or replace its recording with --force");
    if (Status removed = remove_old(path); !removed) return removed;
  }
  for (const char* part : {"/rgb", "/depth"}) {
    fs::create_directories(path + part, error);
    if (error) return Status(ErrorCode::kIo, path + part + ": " + error.message());
  }
  RecordingFolder folder(path, format);
  Status status = folder.open_index("rgb.txt", "# colour or grey images\n# timestamp filename\n", &folder.color_index_);
  const char* title = "# depth images, raw units; camera.toml says how long one is\n# timestamp filename\n";
  if (status) status = folder.open_index("depth.txt", title, &folder.depth_index_);
  if (!status) return status;
  return folder;
}

Status RecordingFolder::open_index(const char* name, const std::string& title, UniqueFd* index) const {
  const std::string path = path_ + "/" + name;
  index->reset(::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_APPEND | O_CLOEXEC, 0644));
  return index->is_open() ? append_line(name, *index, title) : io_error(path);
}

Status RecordingFolder::append_line(const char* name, const UniqueFd& index, const std::string& line) const {
  // One write a line: whatever kills the program leaves whole lines.
  const ssize_t count = ::write(index.get(), line.data(), line.size());
  if (count == static_cast<ssize_t>(line.size())) return Status::ok();
  const Status error = count < 0 ? io_error(path_ + "/" + name) : Status(ErrorCode::kIo, path_ + "/" + name + ": " + std::strerror(ENOSPC));
  struct stat size {};
  if (count > 0 && ::fstat(index.get(), &size) == 0 && ::ftruncate(index.get(), size.st_size - count) != 0)
    return io_error(path_ + "/" + name);
  return error;
}

std::string RecordingFolder::color_name(std::int64_t stamp_ns) const {
  return "rgb/" + stamp_text(stamp_ns) + (format_.is_jpeg ? ".jpg" : ".png");
}

Result<std::uint64_t> RecordingFolder::write_images(const FrameBuffer& frame, std::int64_t stamp_ns) const {
  const std::string color_path = path_ + "/" + color_name(stamp_ns);
  const std::string depth_path = path_ + "/depth/" + stamp_text(stamp_ns) + ".png";
  const std::vector<std::uint8_t> rgb = format_.is_color ? rgb_bytes(frame.color) : std::vector<std::uint8_t>();
  const std::uint8_t* pixels = format_.is_color ? rgb.data() : frame.gray.pixels.data();
  const int width = format_.is_color ? frame.color.width : frame.gray.width,
            height = format_.is_color ? frame.color.height : frame.gray.height;
  const int channels = format_.is_color ? 3 : 1;
  Status status = format_.is_jpeg ? write_jpeg(color_path, {pixels, width, height, channels}, format_.jpeg_quality)
                                  : write_png(color_path, {pixels, width, height, channels}, format_.compression);
  const bool has_depth = !frame.depth.pixels.empty();
  if (status && has_depth) status = write_depth_png(depth_path, frame.depth, format_.compression);
  std::error_code ignored;
  if (!status) {
    fs::remove(color_path, ignored);  // an image that no index names is only in the way
    return status;
  }
  return std::uint64_t{fs::file_size(color_path, ignored)} + (has_depth ? fs::file_size(depth_path, ignored) : 0);
}

Status RecordingFolder::append_frame(std::int64_t stamp_ns, bool has_depth) {
  const std::string stamp = stamp_text(stamp_ns);
  const Status status = has_depth ? append_line("depth.txt", depth_index_, stamp + " depth/" + stamp + ".png\n") : Status::ok();
  return status ? append_line("rgb.txt", color_index_, stamp + " " + color_name(stamp_ns) + "\n") : status;
}

Status RecordingFolder::append_acceleration(std::int64_t stamp_ns, const Eigen::Vector3d& acceleration) {
  if (!accelerometer_.is_open()) {
    const char* title = "# accelerometer, m/s^2; x left, y up, z forward, as in a Kinect\n# timestamp ax ay az\n";
    if (Status status = open_index("accelerometer.txt", title, &accelerometer_); !status) return status;
  }
  const Eigen::Vector3d a = kinect_R_camera_accelerometer().transpose() * acceleration;
  return append_line("accelerometer.txt", accelerometer_, stamp_text(stamp_ns) + text_of(" %.6f %.6f %.6f\n", a.x(), a.y(), a.z()));
}

Status RecordingFolder::write_camera(const RgbdCamera& camera) const {
  return replace_file(path_ + "/camera.toml", format_camera_toml(camera));
}

Status RecordingFolder::sync() const {
  for (const UniqueFd* index : {&depth_index_, &accelerometer_, &color_index_}) {
    if (index->is_open() && ::fsync(index->get()) != 0) return io_error(path_);
  }
  return Status::ok();
}

void RecordingFolder::discard() {
  for (UniqueFd* index : {&color_index_, &depth_index_, &accelerometer_}) index->reset();
  std::error_code ignored;
  for (const char* name : kRecordingFiles) fs::remove(fs::path(path_) / name, ignored);
  for (const char* part : {"/rgb", "/depth", ""}) fs::remove(path_ + part, ignored);  // refused by the system where something is in it
}

}  // namespace camloc::tools
