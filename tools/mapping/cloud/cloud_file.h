// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Point clouds of scanners from files: PLY, PCD, LAS, and text tables (XYZ, PTS, CSV). The kind is told from the content, the
// name only decides where the content does not say.
#pragma once

#include <istream>
#include <string>

#include "core/base/result.h"
#include "tools/mapping/cloud/cloud_input.h"
#include "tools/mapping/cloud/point_cloud.h"

namespace camloc::mapping {

/// Errors, all naming the file: kNotFound, kIo (unreadable, or stopped by `observer`), kUnsupported (LAZ, E57, an unknown kind, a
/// variant that is not read; says how to convert), kCorrupt (truncated, counts larger than the file, a line that is no
/// point), kInvalid (no points, none of them finite).
[[nodiscard]] Result<PointCloud> read_cloud(const std::string& path, const CloudOptions& options,
                                            WorkObserver& observer = WorkObserver::nobody());

/// The same from a stream; `name` also gives the extension.
[[nodiscard]] Result<PointCloud> read_cloud(std::istream& stream, const std::string& name, const CloudOptions& options,
                                            WorkObserver& observer = WorkObserver::nobody());

}  // namespace camloc::mapping
