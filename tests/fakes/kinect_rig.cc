// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/fakes/kinect_rig.h"

#include <xxhash.h>

#include <cerrno>
#include <cinttypes>
#include <cstring>
#include <limits>

#include "core/io/text.h"

namespace camloc::fakes {
namespace {

std::string member(const std::string& name, std::uint64_t value) { return "\"" + name + "\": " + std::to_string(value); }

}  // namespace

Result<std::unique_ptr<KinectRig>> KinectRig::create(const RigOptions& options) {
  std::unique_ptr<KinectRig> rig(new KinectRig);
  if (options.replay.folder.empty()) {
    rig->show_ = std::make_unique<PatternShow>();
  } else {
    auto replay = ReplayShow::open(options.replay, options.kinect.calibration);
    if (!replay) return replay.status();
    rig->show_ = std::move(*replay);
  }
  rig->faults_ = std::make_unique<FaultInjector>(options.seed);
  for (const std::string& spec : options.faults)
    if (const Status status = rig->faults_->configure(spec); !status) return status;

  UsbDescriptors descriptors = camera_descriptors(options.kinect.model, options.kinect.serial);
  spoil(options.bad_descriptors, &descriptors);
  rig->camera_ = std::make_unique<KinectCamera>(options.kinect, std::move(descriptors), rig->show_.get());
  rig->camera_->set_reply_filter([faults = rig->faults_.get()](std::vector<std::uint8_t>* reply) { return faults->filter_reply(reply); });
  rig->motor_ = std::make_unique<KinectMotor>(motor_descriptors(options.kinect.model), options.level_counts);
  rig->served_folder_ = options.served_folder;
  if (!options.log_file.empty()) {
    rig->log_ = std::fopen(options.log_file.c_str(), "we");
    if (rig->log_ == nullptr) return {ErrorCode::kIo, options.log_file + ": " + std::strerror(errno)};
    ::setlinebuf(rig->log_);
  }
  return rig;
}

KinectRig::~KinectRig() {
  if (log_ != nullptr) std::fclose(log_);
}

UsbFunction& KinectRig::device(UsbDeviceId id) {
  if (id == UsbDeviceId::kMotor) return *motor_;
  return *camera_;
}

ControlReply KinectRig::control(UsbDeviceId id, const UsbSetup& setup, std::span<const std::uint8_t> data_out, std::int64_t now_ns) {
  if (id == UsbDeviceId::kCamera && setup.is_vendor() && faults_->refuses_control()) return {true, {}};
  return device(id).control(setup, data_out, now_ns);
}

void KinectRig::next_packet(StreamId stream, std::int64_t now_ns, bool is_wanted, IsoPacket* packet, bool* is_error) {
  StreamState& state = streams_[index_of(stream)];
  camera_->next_packet(stream, now_ns, packet);
  const bool is_last = packet->is_last;
  if (packet->size > 0) {
    ++state.num_packets;
    if (packet->is_first) state.is_damaged = false, state.began_ns = now_ns + monotonic_offset_ns_;
    state.sent = {packet->format, packet->show_index, packet->stamp_ticks};
    if (!is_wanted) {
      ++state.num_unwanted;
      state.is_damaged = true;
    } else if (now_ns < state.stalled_until_ns) {
      ++state.num_stalled;
      state.is_damaged = true;
      packet->size = 0;
    }
  }
  if (faults_->filter_packet(stream, camera_.get(), packet, is_error)) state.is_damaged = true;
  if (is_last) finish_frame(stream);
}

void KinectRig::finish_frame(StreamId stream) {
  StreamState& state = streams_[index_of(stream)];
  const SentFrame& sent = state.sent;
  ++state.num_frames;
  if (state.is_damaged) ++state.num_damaged;
  if (log_ == nullptr && served_folder_.empty()) return;
  const std::span<const std::uint8_t> bytes = show_->frame(sent.format, sent.show_index);
  if (!served_folder_.empty()) store_frame(stream, sent.show_index, bytes);
  if (log_ == nullptr) return;
  std::fprintf(log_, "%s %" PRIu64 " %" PRIu32 " %" PRId64 " %s %d %016" PRIx64 "\n", name_of(stream), sent.show_index, sent.stamp_ticks,
               state.began_ns, name_of(sent.format), state.is_damaged ? 1 : 0, std::uint64_t{XXH3_64bits(bytes.data(), bytes.size())});
}

void KinectRig::store_frame(StreamId stream, std::uint64_t index, std::span<const std::uint8_t> bytes) {
  if (!streams_[index_of(stream)].stored.insert(index).second) return;
  char name[64];
  std::snprintf(name, sizeof name, "/%s-%06" PRIu64 ".raw", name_of(stream), index);
  std::FILE* const file = std::fopen((served_folder_ + name).c_str(), "we");
  if (file == nullptr) return;
  std::fwrite(bytes.data(), 1, bytes.size(), file);
  std::fclose(file);
}

void KinectRig::power_cycle(std::int64_t now_ns) {
  camera_->reset(now_ns);
  motor_->reset(now_ns);
  ++num_power_cycles_;
}

Status KinectRig::stall(std::string_view which, std::string_view how_long, std::int64_t now_ns) {
  const auto milliseconds = parse_double(how_long);
  if (how_long != "forever" && (!milliseconds || !(*milliseconds >= 0 && *milliseconds < 1e9)))
    return {ErrorCode::kInvalid, "not milliseconds or 'forever': " + in_quotes(how_long)};
  if (which != "video" && which != "depth" && which != "both")
    return {ErrorCode::kInvalid, "not video, depth or both: " + in_quotes(which)};
  const std::int64_t until_ns = milliseconds && how_long != "forever" ? now_ns + static_cast<std::int64_t>(*milliseconds * 1e6)
                                                                      : std::numeric_limits<std::int64_t>::max();
  for (const StreamId stream : kBothStreams)
    if (which == "both" || which == name_of(stream)) streams_[index_of(stream)].stalled_until_ns = until_ns;
  return {};
}

std::string KinectRig::command(std::string_view line, std::int64_t now_ns) {
  const std::vector<std::string_view> words = split_fields(line, " \t\r\n");
  const auto says = [&](std::size_t size, std::string_view verb) { return words.size() == size && words[0] == verb; };
  Status status(ErrorCode::kInvalid, "unknown command " + in_quotes(line) + "; known: fault stall resume counts unplug replug");
  if (says(1, "counts")) return counts(now_ns);
  if (says(2, "fault")) status = faults_->configure(words[1]);
  if (says(3, "stall")) status = stall(words[1], words[2], now_ns);
  if (says(1, "resume")) status = stall("both", "0", now_ns);
  return status ? "ok" : "error: " + status.message();
}

std::string KinectRig::counts(std::int64_t now_ns) const {
  std::string text = "{" + member("bus_ms", static_cast<std::uint64_t>(now_ns / 1'000'000)) + ", " +
                     member("power_cycles", num_power_cycles_) + ", " + member("commands", camera_->num_commands()) + ", " +
                     member("bad_commands", camera_->num_bad_commands()) + ", " + member("led", static_cast<std::uint64_t>(motor_->led()));
  for (const StreamId stream : kBothStreams) {
    const StreamState& state = streams_[index_of(stream)];
    text += std::string(", \"") + name_of(stream) + "\": {" + member("frames", state.num_frames) + ", " +
            member("damaged", state.num_damaged) + ", " + member("packets", state.num_packets) + ", " +
            member("unwanted", state.num_unwanted) + ", " + member("stalled", state.num_stalled) + "}";
  }
  text += ", \"faults\": {";
  for (std::size_t i = 0; i < kNumFaults; ++i) {
    const auto fault = static_cast<Fault>(i);
    text += (i == 0 ? "" : ", ") + member(name_of(fault), faults_->count(fault));
  }
  text += "}";
  if (extra_counts_) text += ", " + extra_counts_();
  return text + "}";
}

}  // namespace camloc::fakes
