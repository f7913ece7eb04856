// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/openni2/oni_source.h"

#include <algorithm>
#include <cstdlib>
#include <span>
#include <utility>

#include "core/io/image_file.h"
#include "drivers/openni2/field_of_view.h"
#include "drivers/openni2/oni_file.h"
#include "drivers/playback.h"

namespace camloc {

namespace {

using openni2::OniCodec;
using openni2::OniFile;
using openni2::OniFormat;
using openni2::OniFrameEntry;
using openni2::OniNode;
using openni2::OniStream;
using openni2::PixelLayout;
using openni2::RawImage;
using openni2::to_bgr;
using openni2::to_gray;

constexpr std::int64_t kMaxPairGapUs = 20'000;
constexpr std::size_t kNoDepth = static_cast<std::size_t>(-1);

/// Indices into the frames of the two streams.
struct Pair {
  std::size_t color = 0;
  std::size_t depth = kNoDepth;
};

/// For every colour image the depth image nearest in time. Damage may have left the stamps in any order.
std::vector<Pair> pair_frames(const std::vector<OniFrameEntry>& color, const std::vector<OniFrameEntry>& depth) {
  std::vector<std::pair<std::int64_t, std::size_t>> by_stamp;
  for (std::size_t i = 0; i < depth.size(); ++i) by_stamp.emplace_back(depth[i].stamp_us, i);
  std::sort(by_stamp.begin(), by_stamp.end());
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < color.size(); ++i) {
    Pair pair{i, kNoDepth};
    std::int64_t best_us = kMaxPairGapUs + 1;
    auto after = std::lower_bound(by_stamp.begin(), by_stamp.end(), std::pair(color[i].stamp_us, std::size_t{0}));
    if (after != by_stamp.begin()) --after;
    for (int n = 0; n < 2 && after != by_stamp.end(); ++n, ++after) {
      const std::int64_t gap_us = std::abs(after->first - color[i].stamp_us);
      if (gap_us >= best_us) continue;
      best_us = gap_us;
      pair.depth = after->second;
    }
    pairs.push_back(pair);
  }
  return pairs;
}

/// An open file, the streams that make frames, and which of them were chosen.
struct OniRecording {
  OniFile file;
  OniStream color;
  OniStream depth;  // without frames where there is none
  std::vector<Pair> frames;
  std::size_t num_recorded = 0;  // before any selection
  std::int64_t length_ns = 0;    // first exposure to one mean interval after the last
};

class OniSource final : public Playback {
 public:
  OniSource(OniRecording recording, const PlaybackOptions& options, FrameSourceInfo info)
      : Playback(std::move(info), options, ""), recording_(std::move(recording)) {}

 private:
  [[nodiscard]] Status load(std::size_t position, std::uint64_t round) override {
    const Pair& pair = recording_.frames[position];
    const OniFrameEntry& color = recording_.color.frames[pair.color];
    loaded_.sequence = pair.color + round * recording_.num_recorded;
    // Unsigned: after ages of looping it wraps instead of overflowing.
    loaded_.stamp_ns = static_cast<std::int64_t>(static_cast<std::uint64_t>(color.stamp_us) * 1000 +
                                                 round * static_cast<std::uint64_t>(recording_.length_ns));
    Status status = load_color(color);
    if (pair.depth == kNoDepth) {
      loaded_.depth.resize(0, 0);
    } else if (status) {
      status = load_depth(recording_.depth.frames[pair.depth]);
    }
    if (status) return status;
    return {ErrorCode::kCorrupt, "frame " + std::to_string(pair.color) + ": " + status.message()};
  }

  Status load_color(const OniFrameEntry& entry) {
    const OniFormat& format = recording_.color.formats[entry.format];
    if (Status status = check_format(format, recording_.color.formats.front()); !status) return status;
    if (Status status = recording_.file.read_payload(entry, &bytes_); !status) return status;
    if (format.pixels.layout == PixelLayout::kJpeg) return load_jpeg(format);
    const RawImage raw = raw_image(format, bytes_);
    Status status = to_gray(raw, &loaded_.gray);
    return status && options_.wants_color ? to_bgr(raw, &loaded_.color) : status;
  }

  Status load_jpeg(const OniFormat& format) {
    Image<std::uint8_t>& gray = format.is_mirrored ? unmirrored_ : loaded_.gray;
    Status status = decode_gray(bytes_, "colour image", &gray);
    if (status) status = check_size(gray.width, gray.height, format.width, format.height);
    if (status && format.is_mirrored)
      status =
          to_gray({gray.pixels, gray.width, gray.height, static_cast<std::size_t>(gray.width), PixelLayout::kGray8, true}, &loaded_.gray);
    if (!status || !options_.wants_color) return status;
    Result<ColorImage> color = decode_color(bytes_, "colour image");
    if (!color) return color.status();
    return to_bgr(
        {color->pixels, color->width, color->height, 3 * static_cast<std::size_t>(color->width), PixelLayout::kRgb24, format.is_mirrored},
        &loaded_.color);
  }

  Status load_depth(const OniFrameEntry& entry) {
    const OniFormat& format = recording_.depth.formats[entry.format];
    if (Status status = check_format(format, recording_.depth.formats.front()); !status) return status;
    if (Status status = recording_.file.read_payload(entry, &bytes_); !status) return status;
    if (recording_.depth.codec == OniCodec::kNone) return to_depth(raw_image(format, bytes_), &loaded_.depth);
    loaded_.depth.resize(format.width, format.height);
    if (Status status = decode_depth_codec(recording_.depth.codec, bytes_, loaded_.depth.pixels); !status) return status;
    if (!format.is_mirrored) return Status::ok();
    for (int y = 0; y < format.height; ++y) std::reverse(loaded_.depth.row(y), loaded_.depth.row(y) + format.width);
    return Status::ok();
  }

  static RawImage raw_image(const OniFormat& format, std::span<const std::uint8_t> bytes) {
    const std::size_t stride = static_cast<std::size_t>(format.width) * bytes_per_pixel(format.pixels.layout);
    return {bytes, format.width, format.height, stride, format.pixels.layout, format.is_mirrored};
  }

  /// The size and unit must not change on the way: nobody downstream expects it.
  static Status check_format(const OniFormat& format, const OniFormat& first) {
    if (Status status = check_size(format.width, format.height, first.width, first.height); !status) return status;
    if (format.pixels.depth_unit_m == first.pixels.depth_unit_m && !format.is_cropped) return Status::ok();
    return {ErrorCode::kCorrupt, format.is_cropped ? "cropped" : "another depth unit than the frames before"};
  }

  OniRecording recording_;
  std::vector<std::uint8_t> bytes_;
  Image<std::uint8_t> unmirrored_;
};

/// Refuses what no frame of the source could pass.
Status check_stream(const OniStream& stream, const std::string& name) {
  const OniFormat& format = stream.formats.front();
  if (format.is_cropped) return {ErrorCode::kUnsupported, name + ": a recording of cropped images is not read"};
  const bool is_fine = format.width > 0 && format.height > 0 && format.width <= kMaxImageSide && format.height <= kMaxImageSide;
  if (!is_fine)
    return {ErrorCode::kCorrupt, name + ": images of " + std::to_string(format.width) + "x" + std::to_string(format.height) + " pixels"};
  const bool is_depth = stream.node == OniNode::kDepth;
  const bool is_depth_codec = stream.codec == OniCodec::k16z || stream.codec == OniCodec::k16zTable;
  if (stream.codec == OniCodec::kNone || (is_depth ? is_depth_codec : stream.codec == OniCodec::kJpeg)) return Status::ok();
  return {ErrorCode::kUnsupported, name + ": a stream that is compressed like another kind of images"};
}

std::int64_t length_of(const std::vector<OniFrameEntry>& frames) {
  constexpr std::int64_t kDefaultIntervalNs = 33'333'333;
  const auto [first, last] =
      std::minmax_element(frames.begin(), frames.end(), [](const auto& a, const auto& b) { return a.stamp_us < b.stamp_us; });
  return playback_length_ns((last->stamp_us - first->stamp_us) * 1000, frames.size(), kDefaultIntervalNs);
}

Result<OniRecording> select_recording(const SourceUrl& url) {
  Result<OniFile> file = OniFile::open(url.path);
  if (!file) return file.status();
  const OniStream* color = file->find(OniNode::kColor) != nullptr ? file->find(OniNode::kColor) : file->find(OniNode::kInfrared);
  if (color == nullptr)
    return Status(ErrorCode::kUnsupported, url.path + ": records depth alone; localization needs a colour or infrared stream");
  const OniStream* depth = file->find(OniNode::kDepth);
  if (Status status = check_stream(*color, url.path); !status) return status;
  if (Status status = depth != nullptr ? check_stream(*depth, url.path) : Status::ok(); !status) return status;
  OniRecording recording{std::move(file).value(), {}, {}, {}, color->frames.size(), length_of(color->frames)};
  recording.color = *color;
  if (depth != nullptr) recording.depth = *depth;
  const Result<std::vector<std::size_t>> chosen = chosen_frames(url, recording.num_recorded);
  if (!chosen) return chosen.status();
  const std::vector<Pair> pairs = pair_frames(recording.color.frames, recording.depth.frames);
  for (const std::size_t index : *chosen) recording.frames.push_back(pairs[index]);
  return recording;
}

FrameSourceInfo describe(const std::string& path, const OniRecording& recording, bool is_registered) {
  const OniFormat& color = recording.color.formats.front();
  FrameSourceInfo info;
  info.color_width = color.width;
  info.color_height = color.height;
  info.num_frames = recording.frames.size();
  info.description = "OpenNI recording " + path + ", " + std::to_string(recording.frames.size()) + " of " +
                     std::to_string(recording.num_recorded) + " frames, " +
                     (recording.color.node == OniNode::kInfrared ? "infrared " : "") + std::to_string(color.width) + "x" +
                     std::to_string(color.height);
  const OniFormat* depth = recording.depth.frames.empty() ? nullptr : &recording.depth.formats.front();
  if (depth != nullptr) {
    info.depth_width = depth->width;
    info.depth_height = depth->height;
    info.description += std::string(", depth ") + std::to_string(depth->width) + "x" + std::to_string(depth->height) + " in " +
                        (depth->pixels.depth_unit_m < 5e-4 ? "0.1 mm" : "1 mm") +
                        (is_registered ? ", registered" : ", registration not in the file");
  }
  if (!recording.file.truncation()) info.description += "; cut off: " + recording.file.truncation().message();
  // Infrared and depth are images of one sensor.
  if (is_registered || recording.color.node == OniNode::kInfrared) {
    openni2::StreamGeometry geometry{color.width, color.height, color.horizontal_fov_rad, color.vertical_fov_rad};
    info.camera = openni2::registered_camera(geometry, depth == nullptr ? 0 : depth->width, depth == nullptr ? 0 : depth->height,
                                             depth == nullptr ? 0.001 : depth->pixels.depth_unit_m);
  }
  return info;
}

}  // namespace

Result<std::unique_ptr<FrameSource>> open_oni_source(const SourceUrl& url, const FrameSourceOptions& options) {
  if (Status status = url.check_options({"speed", "loop", "frames", "exclude", "registered"}); !status) return status;
  if (url.path.empty()) return Status(ErrorCode::kInvalid, url.text + ": no file; expected oni://FILE");
  OptionReader reader(url);
  const double speed = reader.number("speed", 0, 0, 1000);
  const PlaybackOptions playback{speed, reader.flag("loop"), options.wants_color};
  const bool is_registered = reader.flag("registered");
  if (!reader.status()) return reader.status();
  Result<OniRecording> recording = select_recording(url);
  if (!recording) return recording.status();
  FrameSourceInfo info = describe(url.path, *recording, is_registered);
  return std::unique_ptr<FrameSource>(std::make_unique<OniSource>(std::move(recording).value(), playback, std::move(info)));
}

}  // namespace camloc
