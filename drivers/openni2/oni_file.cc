// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The scanner reads the head of one record after the other and believes no size before it has compared it
// with the file's.
#include "drivers/openni2/oni_file.h"

#include <OniCEnums.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstring>
#include <map>
#include <string_view>
#include <system_error>
#include <utility>

namespace camloc::openni2 {

namespace {

constexpr std::size_t kFileHeadBytes = 24;
constexpr std::uint32_t kRecordMagic = 0x0052494E;  // "NIR\0"
constexpr std::uint32_t kMaxFieldBytes = 1 << 20;   // the largest known property, a table of 65536 shifts, has 128 KiB
constexpr std::uint32_t kMaxPayloadBytes = 64 << 20;
constexpr std::int64_t kMaxStampUs = 4'000'000'000'000'000;  // the year 2096 in microseconds
constexpr std::size_t kMaxNodes = 64;
constexpr std::size_t kMaxFormats = 1000;

enum RecordType : std::uint32_t {
  kNodeAdded1004 = 2,
  kIntProperty = 3,
  kRealProperty = 4,
  kTextProperty = 5,
  kGeneralProperty = 6,
  kNodeRemoved = 7,
  kDataBegin = 8,
  kNodeReady = 9,
  kNewData = 10,
  kEnd = 11,
  kNodeAdded1005 = 12,
  kNodeAdded = 13,
  kSeekTable = 14,
};

/// All of `size` bytes at `position`, or an error.
Status read_at(int fd, const std::string& name, std::uint64_t position, std::size_t size, std::uint8_t* bytes) {
  std::size_t done = 0;
  while (done < size) {
    const ssize_t count = ::pread(fd, bytes + done, size - done, static_cast<off_t>(position + done));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return {ErrorCode::kIo, name + ": " + std::generic_category().message(errno)};
    if (count == 0) return {ErrorCode::kCorrupt, name + ": ends at byte " + std::to_string(position + done)};
    done += static_cast<std::size_t>(count);
  }
  return Status::ok();
}

/// Takes numbers and texts from the fields of a record. Beyond their end it gives zeros and remembers.
class FieldReader {
 public:
  explicit FieldReader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  std::uint64_t number(std::size_t size) {
    std::uint64_t value = 0;
    const std::span<const std::uint8_t> from = take(size);
    for (std::size_t i = from.size(); i > 0; --i) value = value << 8 | from[i - 1];
    return value;
  }
  double real() { return std::bit_cast<double>(number(8)); }
  std::string_view text() {
    const std::span<const std::uint8_t> from = take(static_cast<std::size_t>(number(4)));
    const std::string_view all(reinterpret_cast<const char*>(from.data()), from.size());
    return all.substr(0, all.find('\0'));
  }
  std::span<const std::uint8_t> take(std::size_t size) {
    if (size > bytes_.size()) {
      is_short_ = true;
      return {};
    }
    const std::span<const std::uint8_t> front = bytes_.first(size);
    bytes_ = bytes_.subspan(size);
    return front;
  }
  [[nodiscard]] bool is_short() const { return is_short_; }

 private:
  std::span<const std::uint8_t> bytes_;
  bool is_short_ = false;
};

struct Record {
  std::uint32_t type = 0;
  std::uint32_t node_id = 0;
  std::uint32_t fields_size = 0;  // with the head
  std::uint32_t payload_size = 0;
};

std::optional<OniCodec> codec_of(std::string_view letters) {
  if (letters == "NONE") return OniCodec::kNone;
  if (letters == "16zP") return OniCodec::k16z;
  if (letters == "16zT") return OniCodec::k16zTable;
  if (letters == "JPEG") return OniCodec::kJpeg;
  return std::nullopt;
}

/// Letters of a codec from the file, fit for a message.
std::string printable(std::string_view letters) {
  std::string text(letters);
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return text;
}

/// OpenNI 1's numbers of pixel formats ("xnPixelFormat") as OpenNI2's.
int from_xn_pixel_format(std::uint64_t value, OniNode node) {
  if (node == OniNode::kDepth) return ONI_PIXEL_FORMAT_DEPTH_1_MM;
  constexpr int kFormats[] = {
      0, ONI_PIXEL_FORMAT_RGB888, ONI_PIXEL_FORMAT_YUV422, ONI_PIXEL_FORMAT_GRAY8, ONI_PIXEL_FORMAT_GRAY16, ONI_PIXEL_FORMAT_JPEG};
  return value < std::size(kFormats) ? kFormats[value] : 0;
}

/// One node while the file is read.
struct NodeState {
  bool is_stream = false;  // false: a device, audio and whatever else there is
  std::size_t stream = 0;
  int oni_pixel_format = 0;
  bool has_oni_pixel_format = false;
  OniFormat format;
};

int default_pixel_format(OniNode node) {
  if (node == OniNode::kDepth) return ONI_PIXEL_FORMAT_DEPTH_1_MM;
  return node == OniNode::kColor ? ONI_PIXEL_FORMAT_RGB888 : ONI_PIXEL_FORMAT_GRAY16;
}

class Scanner {
 public:
  Scanner(int fd, const std::string& name, std::uint64_t file_size) : fd_(fd), name_(name), file_size_(file_size) {}

  /// The file's head; decides how long the heads of records are.
  [[nodiscard]] Status read_file_head() {
    std::uint8_t head[kFileHeadBytes];
    if (file_size_ < kFileHeadBytes)
      return {ErrorCode::kInvalid, name_ + ": " + std::to_string(file_size_) + " bytes are no .oni recording"};
    if (Status status = read_at(fd_, name_, 0, sizeof(head), head); !status) return status;
    if (std::memcmp(head, "NI10", 4) != 0) return {ErrorCode::kInvalid, name_ + ": no .oni recording, which begins with NI10"};
    FieldReader fields(std::span<const std::uint8_t>(head).subspan(4));
    const std::uint64_t major = fields.number(1), minor = fields.number(1), maintenance = fields.number(2), build = fields.number(4);
    const std::string version =
        std::to_string(major) + "." + std::to_string(minor) + "." + std::to_string(maintenance) + "." + std::to_string(build);
    const std::uint64_t ordered = maintenance << 32 | build;
    constexpr std::uint64_t k64BitVersion = std::uint64_t{1} << 32;
    if (major != 1 || minor != 0 || ordered < 4 || ordered > k64BitVersion) {
      return {ErrorCode::kUnsupported, name_ + ": version " + version + " of the .oni format; 1.0.0.4 to 1.0.1.0 are read"};
    }
    record_head_bytes_ = ordered < k64BitVersion ? 24 : 28;
    position_ = kFileHeadBytes;
    return Status::ok();
  }

  /// Up to the end record (ok) or the first thing that is broken, which is the error.
  [[nodiscard]] Status scan() {
    while (true) {
      Result<Record> record = read_record();
      if (!record) return record.status();
      if (record->type == kEnd) return Status::ok();
      FieldReader fields(std::span<const std::uint8_t>(fields_).subspan(record_head_bytes_));
      if (Status status = handle(*record, fields); !status) return status;
      if (fields.is_short()) return broken("fields are too short");
      position_ += std::uint64_t{record->fields_size} + record->payload_size;
    }
  }

  [[nodiscard]] std::vector<OniStream> take_streams() { return std::move(streams_); }

 private:
  /// Head and fields of the record at `position_`, into `fields_`.
  Result<Record> read_record() {
    if (position_ == file_size_) return broken("the end record is missing");
    if (file_size_ - position_ < record_head_bytes_) return broken("cut off");
    fields_.resize(record_head_bytes_);
    if (Status status = read_at(fd_, name_, position_, record_head_bytes_, fields_.data()); !status) return status;
    FieldReader head(fields_);
    if (head.number(4) != kRecordMagic) return broken("no record begins here");
    const auto number = [&head] { return static_cast<std::uint32_t>(head.number(4)); };
    const Record record{number(), number(), number(), number()};
    if (record.fields_size < record_head_bytes_ || record.fields_size > kMaxFieldBytes)
      return broken("fields of " + std::to_string(record.fields_size) + " bytes");
    if (record.payload_size > kMaxPayloadBytes && record.type != kSeekTable)
      return broken("image of " + std::to_string(record.payload_size) + " bytes");
    if (std::uint64_t{record.fields_size} + record.payload_size > file_size_ - position_) return broken("cut off");
    fields_.resize(record.fields_size);
    if (Status status = read_at(fd_, name_, position_, record.fields_size, fields_.data()); !status) return status;
    return record;
  }

  Status handle(const Record& record, FieldReader& fields) {
    switch (record.type) {
      case kNodeAdded1004:
      case kNodeAdded1005:
      case kNodeAdded: return add_node(record, fields);
      case kIntProperty:
      case kRealProperty:
      case kTextProperty:
      case kGeneralProperty: return set_property(record, fields);
      case kNewData: return add_frame(record, fields);
      case kNodeRemoved:
      case kDataBegin:
      case kNodeReady:
      case kSeekTable: return Status::ok();
      default: return broken("unknown type " + std::to_string(record.type));
    }
  }

  Status add_node(const Record& record, FieldReader& fields) {
    const std::string_view name = fields.text();
    const std::uint64_t type = fields.number(4);
    const std::span<const std::uint8_t> letters = fields.take(4);
    if (fields.is_short()) return broken("fields are too short");
    if (nodes_.size() == kMaxNodes || nodes_.count(record.node_id) != 0)
      return broken("node " + std::to_string(record.node_id) + " is one too many");
    NodeState& node = nodes_[record.node_id];
    if (type != 2 && type != 3 && type != 5) return Status::ok();
    OniStream stream;
    stream.node = type == 2 ? OniNode::kDepth : type == 3 ? OniNode::kColor : OniNode::kInfrared;
    const std::string_view codec_letters(reinterpret_cast<const char*>(letters.data()), letters.size());
    const std::optional<OniCodec> codec = codec_of(codec_letters);
    if (!codec)
      return {ErrorCode::kUnsupported, name_ + ": stream " + printable(name) + " is compressed as " + printable(codec_letters) +
                                           "; NONE, 16zP, 16zT and JPEG are read"};
    stream.codec = *codec;
    node.is_stream = true;
    node.stream = streams_.size();
    node.oni_pixel_format = default_pixel_format(stream.node);
    streams_.push_back(std::move(stream));
    return Status::ok();
  }

  Status set_property(const Record& record, FieldReader& fields) {
    const auto found = nodes_.find(record.node_id);
    if (found == nodes_.end()) return broken("a property of node " + std::to_string(record.node_id) + ", which was not added");
    NodeState& node = found->second;
    const std::string_view name = fields.text();
    const std::uint64_t size = fields.number(4);
    FieldReader data(fields.take(static_cast<std::size_t>(size)));
    if (fields.is_short() || !node.is_stream) return Status::ok();
    OniFormat& format = node.format;
    if (name == "xnMapOutputMode") {
      format.width = static_cast<int>(std::min<std::uint64_t>(data.number(4), 1 << 20));
      format.height = static_cast<int>(std::min<std::uint64_t>(data.number(4), 1 << 20));
    } else if (name == "oniPixelFormat") {
      node.oni_pixel_format = static_cast<int>(std::min<std::uint64_t>(data.number(8), 1 << 20));
      node.has_oni_pixel_format = true;
    } else if (name == "xnPixelFormat" && !node.has_oni_pixel_format) {
      node.oni_pixel_format = from_xn_pixel_format(data.number(8), streams_[node.stream].node);
    } else if (name == "xnMirror") {
      format.is_mirrored = data.number(8) != 0;
    } else if (name == "xnCropping") {
      format.is_cropped = data.number(4) != 0;
    } else if (name == "xnFOV") {
      format.horizontal_fov_rad = plausible_fov(data.real());
      format.vertical_fov_rad = plausible_fov(data.real());
    }
    return data.is_short() ? broken("property " + printable(name) + " is too short") : Status::ok();
  }

  Status add_frame(const Record& record, FieldReader& fields) {
    const auto found = nodes_.find(record.node_id);
    if (found == nodes_.end()) return broken("a frame of node " + std::to_string(record.node_id) + ", which was not added");
    NodeState& node = found->second;
    const std::uint64_t stamp_us = fields.number(8);
    if (fields.is_short() || !node.is_stream) return Status::ok();
    if (stamp_us > static_cast<std::uint64_t>(kMaxStampUs)) return broken("stamp out of range");
    const std::optional<PixelFormat> pixels = pixel_format_of(node.oni_pixel_format);
    OniStream& stream = streams_[node.stream];
    if (!pixels) return {ErrorCode::kUnsupported, name_ + ": pixel format " + std::to_string(node.oni_pixel_format) + " is not read"};
    node.format.pixels = *pixels;
    if (stream.codec == OniCodec::kJpeg) node.format.pixels.layout = PixelLayout::kJpeg;
    if ((stream.node == OniNode::kDepth) != (pixels->depth_unit_m > 0)) return broken("pixels that do not belong to their stream");
    if (stream.formats.empty() || !(stream.formats.back() == node.format)) {
      if (stream.formats.size() == kMaxFormats) return broken("too many changes of format");
      stream.formats.push_back(node.format);
    }
    stream.frames.push_back({position_ + record.fields_size, record.payload_size, static_cast<std::uint32_t>(stream.formats.size() - 1),
                             static_cast<std::int64_t>(stamp_us)});
    return Status::ok();
  }

  static double plausible_fov(double radians) { return radians > 0.05 && radians < 3.1 ? radians : 0; }

  [[nodiscard]] Status broken(const std::string& why) const {
    return {ErrorCode::kCorrupt, name_ + ": record at byte " + std::to_string(position_) + ": " + why};
  }

  int fd_;
  const std::string& name_;
  std::uint64_t file_size_;
  std::uint64_t position_ = 0;
  std::size_t record_head_bytes_ = 28;
  std::vector<std::uint8_t> fields_;
  std::map<std::uint32_t, NodeState> nodes_;
  std::vector<OniStream> streams_;
};

}  // namespace

Result<OniFile> OniFile::open(const std::string& name) {
  // O_NONBLOCK: opening a named pipe must not hang.
  UniqueFd file(::open(name.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  if (!file.is_open()) {
    return Status(errno == ENOENT || errno == ENOTDIR ? ErrorCode::kNotFound : ErrorCode::kIo,
                  name + ": " + std::generic_category().message(errno));
  }
  struct stat info {};
  if (::fstat(file.get(), &info) != 0) return Status(ErrorCode::kIo, name + ": " + std::generic_category().message(errno));
  if (!S_ISREG(info.st_mode)) return Status(ErrorCode::kInvalid, name + ": is not a regular file");
  Scanner scanner(file.get(), name, static_cast<std::uint64_t>(info.st_size));
  if (Status status = scanner.read_file_head(); !status) return status;
  const Status scanned = scanner.scan();
  if (scanned.code() == ErrorCode::kUnsupported || scanned.code() == ErrorCode::kIo) return scanned;
  OniFile result(std::move(file), name);
  result.streams_ = scanner.take_streams();
  std::erase_if(result.streams_, [](const OniStream& stream) { return stream.frames.empty(); });
  if (result.streams_.empty()) return scanned ? Status(ErrorCode::kInvalid, name + ": a recording without a frame") : scanned;
  result.truncation_ = scanned;
  return result;
}

const OniStream* OniFile::find(OniNode node) const {
  const auto found = std::find_if(streams_.begin(), streams_.end(), [node](const OniStream& stream) { return stream.node == node; });
  return found == streams_.end() ? nullptr : &*found;
}

Status OniFile::read_payload(const OniFrameEntry& frame, std::vector<std::uint8_t>* bytes) const {
  bytes->resize(frame.size);
  return read_at(file_.get(), name_, frame.position, frame.size, bytes->data());
}

}  // namespace camloc::openni2
