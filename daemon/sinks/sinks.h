// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The table of sinks. camlocd's check of publish.lcm_url and the opening of what it names follow from it.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "core/base/result.h"
#include "daemon/sinks/pose_sink.h"

namespace camloc {

struct SinkEntry {
  const char* scheme;
  /// Errors are of the configuration; what may come later is connect()'s.
  Result<std::unique_ptr<PoseSink>> (*open)(const SinkOptions& options);
  const char* help;  ///< an example of a URL, two blanks, what it is
};
using SinkTable = std::span<const SinkEntry>;

/// All of this build.
[[nodiscard]] SinkTable pose_sinks();
/// By the scheme of `url`. kInvalid: there is no scheme, or none of these; the message has an example.
[[nodiscard]] Result<const SinkEntry*> find_sink(const std::string& url, SinkTable sinks = pose_sinks());
[[nodiscard]] Result<std::unique_ptr<PoseSink>> open_pose_sink(const SinkOptions& options, SinkTable sinks = pose_sinks());

}  // namespace camloc
