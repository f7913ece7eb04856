// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A recording from its first frame to its last: the one loop over a frame source that the programs share, and the text that
// selects some of its frames.
#pragma once

#include <cstdint>
#include <functional>
#include <set>
#include <string>

#include "core/base/result.h"
#include "core/base/work_observer.h"
#include "drivers/frame_source.h"

namespace camloc::tools {

struct FrameCounts {
  std::uint64_t num_frames = 0;   ///< that were read, broken ones included
  std::uint64_t num_corrupt = 0;  ///< of them could not be decoded
  std::string first_corrupt;      ///< what was wrong with the first of those

  [[nodiscard]] bool are_all_corrupt() const { return num_frames > 0 && num_corrupt == num_frames; }
};

/// Called with every decoded frame, whose buffer it may change; an error ends the reading and becomes its result.
using FrameVisitor = std::function<Status(FrameBuffer&)>;

/// Reads until the source ends or `observer` wants to stop, which is asked before each frame; nothing is shown to it. Broken frames are
/// counted and left out; what is wrong with the source as a whole is an error.
[[nodiscard]] Result<FrameCounts> read_frames(FrameSource& source, const FrameVisitor& on_frame,
                                              const WorkObserver& observer = WorkObserver::nobody());

/// kCorrupt, with what to do about it.
[[nodiscard]] Status all_frames_corrupt(const FrameCounts& counts);

/// The source URL with a selection of frames added; empty texts select nothing and add nothing.
[[nodiscard]] std::string with_selection(const std::string& url, const std::string& frames, const std::string& exclude = "");

/// "start:stop[,...]" of these frames, each with up to `num_before` frames that lead to it.
[[nodiscard]] std::string selection_of(const std::set<std::uint64_t>& frames, std::uint64_t num_before = 0);

}  // namespace camloc::tools
