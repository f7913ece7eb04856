// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A recorded sequence through the localizer, frame by frame: what `localize` and `bench` share.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/localize/localizer.h"
#include "core/map/map_view.h"
#include "drivers/frame_source.h"
#include "tools/common/command_line.h"
#include "tools/common/frame_reading.h"
#include "tools/evaluation/coarse_asking.h"

namespace camloc::tools {

/// One change of the grey image.
struct Perturbation {
  void (*change)(double value, std::uint64_t sequence, Image<std::uint8_t>* gray);
  double value = 1;
};

/// "gamma=0.5": 255 (v / 255)^0.5; "contrast=0.6": 128 + 0.6 (v - 128); "exposure=0.4": 0.4 v; "noise=12": plus normal noise, sigma
/// 12 grey levels, seeded by the frame number; "blur=9": mean over 9 pixels along the row, which is horizontal motion.
[[nodiscard]] Result<Perturbation> parse_perturbation(const std::string& text);
/// In the order given.
void apply(const std::vector<Perturbation>& perturbations, std::uint64_t sequence, Image<std::uint8_t>* gray);

struct SequenceRunOptions {
  std::string map_path;
  std::string sequence_url;
  std::string camera_path;
  std::string frames;  ///< "start:stop:step[,...]", empty = all
  std::string exclude;
  bool is_single = false;  ///< every frame is a kidnapped robot
  bool use_depth = true;
  std::vector<std::string> perturbations;
  StageTimer::Clock clock = nullptr;  ///< of stage times; monotonic_ns where there is none
  std::string coarse_path;            ///< coarse model that is asked about lost frames, empty for none
  std::vector<std::string> numbers;   ///< "localizer.NAME=VALUE", for experiments
};

/// The files that a run reads, for check_outputs().
[[nodiscard]] std::vector<NamedPath> inputs_of(const SequenceRunOptions& options);

/// Map, camera and source, opened and checked against each other. Members are destroyed in reverse order.
struct SequenceRun {
  std::unique_ptr<MapView> map;
  RgbdCamera camera;
  std::unique_ptr<FrameSource> source;
  std::vector<Perturbation> perturbations;
  LocalizerOptions localizer_options;
  std::unique_ptr<Localizer> localizer;
  std::unique_ptr<CoarseAsking> coarse;  ///< where there is a model

  /// The localizer's answer for the next frame, with the help of the model.
  const Localization& localize(const Frame& frame);
};

/// Nanoseconds of a monotonic clock, for LocalizerOptions::now_ns.
[[nodiscard]] std::int64_t monotonic_ns();

[[nodiscard]] Result<SequenceRun> open_sequence_run(const SequenceRunOptions& options);

/// read_frames() with the perturbations applied. kCorrupt where not a single frame could be decoded.
[[nodiscard]] Result<FrameCounts> read_perturbed_frames(SequenceRun& run, const std::function<void(const Frame&)>& on_frame,
                                                        const WorkObserver& observer = WorkObserver::nobody());
/// "3 of 60 frames could not be read ..." on stderr, in the name of `program`; nothing where there were none.
void warn_of_corrupt_frames(const std::string& program, const FrameCounts& counts);

}  // namespace camloc::tools
