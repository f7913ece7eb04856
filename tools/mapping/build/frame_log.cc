// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Every record is checked before it is believed: sizes against what is left of the file, then the hash over header and arrays.
#include "tools/mapping/build/frame_log.h"

#define XXH_INLINE_ALL
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>

namespace camloc::mapping {
namespace {

constexpr std::array<char, 8> kMagic = {'C', 'M', 'V', 'I', 'E', 'W', 'S', '\n'};
constexpr std::uint32_t kVersion = 2, kMaxFeatures = 1U << 20, kMaxSurface = 1U << 20, kMaxCells = 1U << 20;

struct LogHeader {
  std::array<char, 8> magic = kMagic;
  std::uint32_t version = kVersion, reserved = 0;
  std::uint64_t identity = 0;
  std::array<std::uint64_t, 5> padding{};
};
static_assert(sizeof(LogHeader) == 64);

struct RecordHeader {
  std::uint64_t frame = 0;
  std::int64_t stamp_ns = 0;
  std::uint32_t num_features = 0, num_surface = 0;
  std::uint32_t num_patches = 0;  ///< as many as features, or none
  std::uint32_t num_cells = 0;    ///< of the thumbnail
  std::uint16_t thumbnail_width = 0, cell_px = 0;
  std::uint32_t reserved = 0;
  std::uint64_t hash = 0;  ///< of the fields above and the arrays
};
static_assert(sizeof(RecordHeader) == 48);

/// A keypoint without the padding of the struct.
struct PackedKeypoint {
  float u, v, angle_rad, response;
  std::uint32_t level;
};

template <typename T>
void put(const std::vector<T>& values, std::vector<char>* bytes) {
  const auto* begin = reinterpret_cast<const char*>(values.data());
  bytes->insert(bytes->end(), begin, begin + values.size() * sizeof(T));
}

template <typename T>
const char* get(const char* from, std::size_t count, std::vector<T>* values) {
  values->resize(count);
  if (count > 0) std::memcpy(static_cast<void*>(values->data()), from, count * sizeof(T));
  return from + count * sizeof(T);
}

/// The arrays of a record in the order of the file: `take` gets each with its number of elements.
template <typename Logged, typename Keypoints, typename Take>
void for_each_array(Logged& logged, Keypoints& keypoints, const RecordHeader& header, const Take& take) {
  take(keypoints, header.num_features);
  take(logged.view.features.descriptors, header.num_features);
  take(logged.view.normalized, header.num_features);
  take(logged.view.depth_m, header.num_features);
  take(logged.surface_m, header.num_surface);
  take(logged.view.patches, header.num_patches);
  take(logged.thumbnail.grey, header.num_cells);
  take(logged.thumbnail.depth, header.num_cells);
}

std::uint64_t hash_of(RecordHeader header, const std::vector<char>& bytes) {
  header.hash = XXH3_64bits(bytes.data(), bytes.size());
  return XXH3_64bits(&header, sizeof header);
}

Status io_error(const std::string& path, const std::string& what) {
  const int error = errno;
  return {ErrorCode::kIo, path + ": " + what + (error == 0 ? std::string() : std::string(": ") + std::strerror(error))};
}

/// Whether the file is empty or begins as a log does.
bool may_be_log(int fd, const struct stat& info) {
  std::array<char, 8> magic{};
  return info.st_size == 0 || (::pread(fd, magic.data(), magic.size(), 0) == ssize_t{magic.size()} && magic == kMagic);
}

/// A stream on the file itself: a link that came in its place meanwhile is not followed.
bool open_stream(const std::string& path, std::ios::openmode mode, std::ofstream* stream) {
  const UniqueFd fd(::open(path.c_str(), O_WRONLY | O_CREAT | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC, 0644));
  if (!fd.is_open()) return false;
  stream->open("/proc/self/fd/" + std::to_string(fd.get()), std::ios::binary | mode);
  return stream->is_open();
}

}  // namespace

Result<UniqueFd> lock_frame_log(const std::string& path) {
  errno = 0;
  UniqueFd fd(::open(path.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC, 0644));
  if (!fd.is_open() && errno == ELOOP) return Status(ErrorCode::kInvalid, path + ": is a symbolic link, which is not followed; remove it");
  if (!fd.is_open()) return io_error(path, "cannot be written");
  struct stat info {
  }, now{};
  if (::fstat(fd.get(), &info) != 0) return io_error(path, "cannot be written");
  if (!S_ISREG(info.st_mode) || info.st_nlink > 1 || !may_be_log(fd.get(), info))
    return Status(ErrorCode::kInvalid, path + ": is something else than the views of a build; move it away");
  // The one that had it may have removed it: then this is no longer the file at the path.
  const bool is_ours = ::flock(fd.get(), LOCK_EX | LOCK_NB) == 0 && ::lstat(path.c_str(), &now) == 0 && now.st_ino == info.st_ino;
  if (!is_ours)
    return Status(ErrorCode::kUnavailable, path + ": another build of the same map is running; wait for it or take another --out");
  return fd;
}

Result<FrameLogWriter> FrameLogWriter::create(const std::string& path, std::uint64_t identity) {
  FrameLogWriter writer;
  writer.path_ = path;
  errno = 0;
  if (!open_stream(path, std::ios::trunc, &writer.file_)) return io_error(path, "cannot be written");
  LogHeader header;
  header.identity = identity;
  writer.file_.write(reinterpret_cast<const char*>(&header), sizeof header);
  if (!writer.file_) return io_error(path, "cannot be written");
  return writer;
}

Result<FrameLogWriter> FrameLogWriter::append(const std::string& path, std::uint64_t size_bytes) {
  FrameLogWriter writer;
  writer.path_ = path;
  std::error_code error;
  std::filesystem::resize_file(path, size_bytes, error);
  if (error) return Status(ErrorCode::kIo, path + ": cannot be written: " + error.message());
  errno = 0;
  if (!open_stream(path, std::ios::app, &writer.file_)) return io_error(path, "cannot be written");
  return writer;
}

Status FrameLogWriter::add(const LoggedFrame& logged) {
  const FrameFeatures& view = logged.view;
  std::vector<PackedKeypoint> keypoints;
  keypoints.reserve(view.size());
  for (const Keypoint& k : view.features.keypoints) keypoints.push_back({k.u, k.v, k.angle_rad, k.response, k.level});
  RecordHeader header;
  header.frame = logged.frame;
  header.stamp_ns = view.stamp_ns;
  header.num_features = static_cast<std::uint32_t>(view.size());
  header.num_surface = static_cast<std::uint32_t>(logged.surface_m.size());
  header.num_patches = static_cast<std::uint32_t>(view.patches.size());
  header.num_cells = static_cast<std::uint32_t>(logged.thumbnail.grey.size());
  header.thumbnail_width = static_cast<std::uint16_t>(logged.thumbnail.width);
  header.cell_px = static_cast<std::uint16_t>(logged.thumbnail.cell_px);
  bytes_.clear();
  for_each_array(logged, keypoints, header, [this](const auto& values, std::size_t) { put(values, &bytes_); });
  header.hash = hash_of(header, bytes_);
  errno = 0;
  file_.write(reinterpret_cast<const char*>(&header), sizeof header);
  file_.write(bytes_.data(), static_cast<std::streamsize>(bytes_.size()));
  return file_ ? Status::ok() : io_error(path_, "cannot be written; is the disk full?");
}

Status FrameLogWriter::flush() {
  errno = 0;
  file_.flush();
  return file_ ? Status::ok() : io_error(path_, "cannot be written; is the disk full?");
}

Result<FrameLogReader> FrameLogReader::open(const std::string& path, std::uint64_t identity) {
  FrameLogReader reader;
  reader.path_ = path;
  std::error_code error;
  reader.file_bytes_ = std::filesystem::file_size(path, error);
  if (error) return Status(ErrorCode::kNotFound, path + ": " + error.message());
  reader.file_.open(path, std::ios::binary);
  LogHeader header;
  reader.file_.read(reinterpret_cast<char*>(&header), sizeof header);
  if (!reader.file_ || header.magic != kMagic || header.version != kVersion)
    return Status(ErrorCode::kCorrupt, path + ": is no view log of this version");
  if (header.identity != identity)
    return Status(ErrorCode::kInvalid, path + ": belongs to a build with another recording, camera or options");
  reader.position_ = sizeof header;
  return reader;
}

Status FrameLogReader::next(LoggedFrame* logged) {
  const Status end(ErrorCode::kEnd, path_ + ": no more views");
  RecordHeader header;
  if (position_ + sizeof header > file_bytes_) return end;
  file_.read(reinterpret_cast<char*>(&header), sizeof header);
  if (!file_ || header.num_features > kMaxFeatures || header.num_surface > kMaxSurface) return end;
  if (header.num_patches != 0 && header.num_patches != header.num_features) return end;
  if (header.num_cells > kMaxCells ||
      (header.num_cells > 0 && (header.thumbnail_width == 0 || header.num_cells % header.thumbnail_width != 0)))
    return end;
  std::vector<PackedKeypoint> keypoints;
  std::size_t size = 0;
  for_each_array(*logged, keypoints, header, [&](const auto& values, std::size_t count) { size += count * sizeof values[0]; });
  if (position_ + sizeof header + size > file_bytes_) return end;
  bytes_.resize(size);
  file_.read(bytes_.data(), static_cast<std::streamsize>(size));
  const std::uint64_t expected = header.hash;
  header.hash = 0;
  if (!file_ || hash_of(header, bytes_) != expected) return end;
  position_ += sizeof header + size;

  FrameFeatures& view = logged->view;
  const char* from = bytes_.data();
  for_each_array(*logged, keypoints, header, [&from](auto& values, std::size_t count) { from = get(from, count, &values); });
  logged->thumbnail.width = header.thumbnail_width;
  logged->thumbnail.height = header.num_cells > 0 ? static_cast<int>(header.num_cells / header.thumbnail_width) : 0;
  logged->thumbnail.cell_px = header.cell_px;
  view.features.keypoints.clear();
  for (const PackedKeypoint& k : keypoints)
    view.features.keypoints.push_back({k.u, k.v, k.angle_rad, k.response, static_cast<std::uint8_t>(k.level)});
  view.T_map_camera = {};
  view.stamp_ns = header.stamp_ns;
  logged->frame = header.frame;
  return Status::ok();
}

}  // namespace camloc::mapping
