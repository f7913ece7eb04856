// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstring>

#include "core/io/sequence.h"
#include "tests/fakes/kinect_frames.h"

namespace camloc::fakes {
namespace {

constexpr std::size_t kPairBytes = kColorBytes + kDepthBytes;

Status write_all(int fd, std::span<const std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(fd, bytes.data(), bytes.size());
    if (written <= 0) return {ErrorCode::kIo, std::string("rendered frames: ") + std::strerror(errno)};
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  return {};
}

/// Depth images are 640x480 in units of `unit_mm`; without one, the frame has no depth anywhere.
Status render_pair(ImageReader* reader, const SequenceFrame& frame, double unit_mm, const std::vector<std::uint16_t>& table, int fd) {
  auto color = reader->read_color(frame.color_path);
  if (!color) return color.status();
  if (color->width != kKinectWidth || color->height != kKinectHeight)
    return {ErrorCode::kUnsupported, frame.color_path + ": not 640x480, which is all that a Kinect has"};
  std::vector<std::uint16_t> disparities(kColorBytes, kNoDisparity);
  if (!frame.depth_path.empty()) {
    Image<std::uint16_t> depth;
    if (const Status status = reader->read_depth(frame.depth_path, &depth); !status) return status;
    if (depth.pixels.size() != kColorBytes) return {ErrorCode::kUnsupported, frame.depth_path + ": not 640x480"};
    for (std::size_t i = 0; i < kColorBytes; ++i) {
      const double mm = depth.pixels[i] == 0xffff ? 0 : depth.pixels[i] * unit_mm + 0.5;
      disparities[i] = table[mm >= 0xffff ? 0 : static_cast<std::size_t>(mm)];
    }
  }
  if (const Status status = write_all(fd, bayer_mosaic(*color)); !status) return status;
  return write_all(fd, pack_bits(disparities, 11));
}

Status render(const Sequence& sequence, const std::vector<std::size_t>& chosen, const ReplayOptions& options,
              const KinectCalibration& calibration, int fd) {
  ImageReader reader;
  const std::vector<std::uint16_t> table = disparity_table(calibration);
  for (const std::size_t i : chosen) {
    if (const Status status = render_pair(&reader, sequence.frames[i], options.depth_unit_mm, table, fd); !status) return status;
  }
  return {};
}

/// An open file with the rendered frames: the cache where it has the right size, else rendered now. A cache is written under another
/// name first, so that it is whole or not there.
Result<UniqueFd> rendered_file(const Sequence& sequence, const std::vector<std::size_t>& chosen, const ReplayOptions& options,
                               const KinectCalibration& calibration) {
  const bool has_cache = !options.cache_file.empty();
  if (has_cache) {
    UniqueFd cached(::open(options.cache_file.c_str(), O_RDONLY | O_CLOEXEC));
    struct stat info {};
    if (cached.is_open() && ::fstat(cached.get(), &info) == 0 && info.st_size == static_cast<off_t>(chosen.size() * kPairBytes))
      return cached;
  }
  const std::string partial = options.cache_file + ".part" + std::to_string(::getpid());
  UniqueFd file(has_cache ? ::open(partial.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0600) : ::memfd_create("frames", MFD_CLOEXEC));
  if (!file.is_open()) return {ErrorCode::kIo, partial + ": " + std::strerror(errno)};
  Status status = render(sequence, chosen, options, calibration, file.get());
  if (status && has_cache && ::rename(partial.c_str(), options.cache_file.c_str()) != 0)
    status = {ErrorCode::kIo, options.cache_file + ": " + std::strerror(errno)};
  if (!status) {
    if (has_cache) ::unlink(partial.c_str());
    return status;
  }
  return file;
}

}  // namespace

Result<std::unique_ptr<ReplayShow>> ReplayShow::open(const ReplayOptions& options, const KinectCalibration& calibration) {
  const auto sequence = read_sequence(options.folder);
  if (!sequence) return sequence.status();
  const auto chosen = select_frames(options.frames, "", sequence->frames.size());
  if (!chosen) return chosen.status();
  if (chosen->empty()) return {ErrorCode::kInvalid, options.folder + ": --frames chooses none of its frames"};

  auto file = rendered_file(*sequence, *chosen, options, calibration);
  if (!file) return file.status();
  void* const mapped = ::mmap(nullptr, chosen->size() * kPairBytes, PROT_READ, MAP_SHARED, file->get(), 0);
  if (mapped == MAP_FAILED) return {ErrorCode::kIo, options.folder + ": cannot map the rendered frames: " + std::strerror(errno)};
  std::unique_ptr<ReplayShow> show(new ReplayShow);
  show->file_ = std::move(*file);
  show->mapped_ = static_cast<const std::uint8_t*>(mapped);
  show->num_frames_ = chosen->size();
  show->at_end_ = options.at_end;
  return show;
}

ReplayShow::~ReplayShow() {
  if (mapped_ != nullptr) ::munmap(const_cast<std::uint8_t*>(mapped_), num_frames_ * kPairBytes);
}

std::uint64_t ReplayShow::wrapped(std::uint64_t index) const {
  if (at_end_ == AtEnd::kLoop) return index % num_frames_;
  return index < num_frames_ ? index : num_frames_ - 1;
}

std::span<const std::uint8_t> ReplayShow::frame(FrameFormat format, std::uint64_t index) {
  const std::uint64_t at = wrapped(index);
  const std::uint8_t* const pair = mapped_ + at * kPairBytes;
  const std::span<const std::uint8_t> depth(pair + kColorBytes, kDepthBytes);
  if (format == FrameFormat::kBayer) return {pair, kColorBytes};
  if (format == FrameFormat::kDepth11) return depth;
  if (format != FrameFormat::kDepth10) return pattern_.frame(format, index);
  if (depth10_index_ != at) {
    std::vector<std::uint16_t> values = unpack_bits(depth, 11);
    for (std::uint16_t& value : values) value = static_cast<std::uint16_t>(value >> 1);
    depth10_ = pack_bits(values, 10);
    depth10_index_ = at;
  }
  return depth10_;
}

}  // namespace camloc::fakes
