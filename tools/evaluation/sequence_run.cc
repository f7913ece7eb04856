// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What does not fit together is refused before the first frame: camera and images by size, texts that become part of a URL by syntax.
#include "tools/evaluation/sequence_run.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <random>

#include "core/io/camera_file.h"
#include "core/io/sequence.h"
#include "drivers/sources.h"
#include "tools/common/command_line.h"
#include "tools/common/text_format.h"

namespace camloc::tools {
namespace {

std::uint8_t to_gray(double value) { return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 255.0))); }

/// `Tone` of the value and a grey level.
template <auto Tone>
void change_tone(double value, std::uint64_t /*sequence*/, Image<std::uint8_t>* gray) {
  std::array<std::uint8_t, 256> table{};
  for (int v = 0; v < 256; ++v) table[static_cast<std::size_t>(v)] = to_gray(Tone(value, v));
  for (std::uint8_t& pixel : gray->pixels) pixel = table[pixel];
}

double gamma(double value, double v) { return 255.0 * std::pow(v / 255.0, value); }
double contrast(double value, double v) { return 128.0 + value * (v - 128.0); }
double exposure(double value, double v) { return value * v; }

void add_noise(double sigma, std::uint64_t sequence, Image<std::uint8_t>* gray) {
  std::mt19937_64 random(sequence * 0x9E3779B97F4A7C15ULL + 1);
  std::normal_distribution<double> noise(0.0, sigma);
  for (std::uint8_t& pixel : gray->pixels) pixel = to_gray(pixel + noise(random));
}

void blur(double value, std::uint64_t /*sequence*/, Image<std::uint8_t>* gray) {
  const int length = static_cast<int>(std::lround(value));
  std::vector<std::uint8_t> source(static_cast<std::size_t>(gray->width));
  for (int y = 0; y < gray->height; ++y) {
    std::uint8_t* row = gray->row(y);
    std::copy(row, row + gray->width, source.begin());
    for (int x = 0; x < gray->width; ++x) {
      int sum = 0;
      for (int k = 0; k < length; ++k) sum += source[static_cast<std::size_t>(std::clamp(x + k - length / 2, 0, gray->width - 1))];
      row[x] = static_cast<std::uint8_t>((sum + length / 2) / length);
    }
  }
}

struct Entry {
  const char* name;
  decltype(Perturbation::change) change;
  double min, max;
};

constexpr std::array<Entry, 5> kEntries{{
    {"gamma", change_tone<gamma>, 0.05, 20},
    {"contrast", change_tone<contrast>, 0, 10},
    {"exposure", change_tone<exposure>, 0, 20},
    {"noise", add_noise, 0, 128},
    {"blur", blur, 1, 101},
}};

Status check_size(const char* kind, const Intrinsics& camera, int width, int height, const std::string& camera_path) {
  if (width == 0 || (width == camera.width && height == camera.height)) return Status::ok();  // a live source tells with its first frame
  return {ErrorCode::kInvalid,
          text_of("%s: is for %dx%d %s images, the sequence has %dx%d: use the camera file of the camera that recorded it",
                  camera_path.c_str(), camera.width, camera.height, kind, width, height)};
}

/// "localizer.NAME=VALUE" into the numbers that the localizer weighs by.
Status set_localizer_number(const std::string& assignment, LocalizerNumbers* numbers) {
  constexpr std::string_view kGroup = "localizer.";
  const bool is_ours = assignment.starts_with(kGroup);
  const Status status = is_ours ? set_number(localizer_number_table(), std::string_view(assignment).substr(kGroup.size()), numbers)
                                : Status(ErrorCode::kInvalid, assignment + ": is not localizer.NAME=VALUE");
  return status.with_context("--set");
}

/// The text becomes part of a URL, so anything but slices must end here.
Status check_selection(const std::string& option, const std::string& text) {
  return text.empty() ? Status::ok() : select_frames(text, "", 1).status().with_context(option);
}

}  // namespace

Result<Perturbation> parse_perturbation(const std::string& text) {
  const std::size_t equals = text.find('=');
  for (const Entry& entry : kEntries) {
    if (equals == std::string::npos || text.substr(0, equals) != entry.name) continue;
    const std::string number = text.substr(equals + 1);
    char* end = nullptr;
    const double value = std::strtod(number.c_str(), &end);
    if (number.empty() || *end != '\0' || !(value >= entry.min && value <= entry.max)) break;
    return Perturbation{entry.change, value};
  }
  return {ErrorCode::kInvalid,
          "--perturb " + text + ": expected gamma=0.05..20, contrast=0..10, exposure=0..20, noise=0..128 or blur=1..101"};
}

void apply(const std::vector<Perturbation>& perturbations, std::uint64_t sequence, Image<std::uint8_t>* gray) {
  for (const Perturbation& perturbation : perturbations) perturbation.change(perturbation.value, sequence, gray);
}

std::int64_t monotonic_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::vector<NamedPath> inputs_of(const SequenceRunOptions& options) {
  return {{"--map", options.map_path}, {"--sequence", options.sequence_url}, {"--camera", options.camera_path}};
}

Result<SequenceRun> open_sequence_run(const SequenceRunOptions& options) {
  SequenceRun run;
  for (const std::string& text : options.perturbations) {
    auto perturbation = parse_perturbation(text);
    if (!perturbation) return perturbation.status();
    run.perturbations.push_back(*perturbation);
  }
  for (const std::string& assignment : options.numbers) {
    if (Status status = set_localizer_number(assignment, &run.localizer_options.numbers); !status) return status;
  }
  if (Status status = check_selection("--frames", options.frames); !status) return status;
  if (Status status = check_selection("--exclude", options.exclude); !status) return status;
  auto camera = read_camera_file(options.camera_path);
  if (!camera) return camera.status();
  run.camera = std::move(camera).value();
  auto map = MapView::open(options.map_path);
  if (!map) return map.status();
  run.map = std::make_unique<MapView>(std::move(map).value());
  auto source = open_frame_source(with_selection(options.sequence_url, options.frames, options.exclude));
  if (!source) return source.status();
  run.source = std::move(source).value();
  const FrameSourceInfo& info = run.source->info();
  Status size = check_size("colour", run.camera.color, info.color_width, info.color_height, options.camera_path);
  if (size && info.color_width != 0) size = check_size("depth", run.camera.depth, info.depth_width, info.depth_height, options.camera_path);
  if (!size) return size;

  run.localizer_options.use_tracking = !options.is_single;
  run.localizer_options.use_depth = options.use_depth;
  run.localizer_options.now_ns = options.clock != nullptr ? options.clock : monotonic_ns;
  run.localizer = std::make_unique<Localizer>(*run.map, run.camera, run.localizer_options);
  if (options.coarse_path.empty()) return run;
  auto coarse = CoarseAsking::open(options.coarse_path, *run.map, run.camera);
  if (!coarse) return coarse.status();
  run.coarse = std::move(*coarse);
  return run;
}

const Localization& SequenceRun::localize(const Frame& frame) {
  if (!coarse) return localizer->process(frame);
  return localizer_options.use_tracking ? coarse->process(frame, localizer.get()) : coarse->process_single(frame, localizer.get());
}

Result<FrameCounts> read_perturbed_frames(SequenceRun& run, const std::function<void(const Frame&)>& on_frame,
                                          const WorkObserver& observer) {
  auto counts = read_frames(
      *run.source,
      [&](FrameBuffer& frame) {
        apply(run.perturbations, frame.sequence, &frame.gray);
        on_frame(frame.view());
        return Status::ok();
      },
      observer);
  if (counts && counts->are_all_corrupt()) return all_frames_corrupt(*counts);
  return counts;
}

void warn_of_corrupt_frames(const std::string& program, const FrameCounts& counts) {
  if (counts.num_corrupt == 0) return;
  print_error(program, std::to_string(counts.num_corrupt) + " of " + std::to_string(counts.num_frames) +
                           " frames could not be read and count as not localized, the first: " + counts.first_corrupt);
}

}  // namespace camloc::tools
