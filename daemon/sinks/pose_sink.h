// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A way for poses out of the daemon. Which there are is in sinks.h.
#pragma once

#include <string>

#include "core/base/result.h"
#include "daemon/pose_report.h"

namespace camloc {

/// What the section [publish] of the configuration says. A sink takes from it what it knows.
struct SinkOptions {
  std::string url;
  std::string pose_channel, status_channel;
  std::string bot_core_channel;  ///< empty: not published
};

/// Belongs to the daemon's main thread. publish() neither waits nor, after the first messages, allocates.
class PoseSink {
 public:
  virtual ~PoseSink() = default;

  /// Asked every second until it succeeds, and never again. kUnavailable: not yet, with the reason in one line for the log.
  [[nodiscard]] virtual Status connect() = 0;
  [[nodiscard]] virtual bool is_connected() const = 0;

  /// False when it could not be sent, also while not connected; the next one is tried anew.
  virtual bool publish(const PoseReport& report) = 0;
  virtual bool publish(const DaemonStatus& status) = 0;
};

}  // namespace camloc
