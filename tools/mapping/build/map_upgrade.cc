// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/mapping/build/map_upgrade.h"

#include <algorithm>

#include "core/map/map_unpack.h"
#include "core/map/map_writer.h"
#include "core/mapmaking/rival_search.h"

namespace camloc::mapping {

Status upgrade_map(const std::string& path, const std::string& out_path, WorkObserver& observer, MapUpgradeSummary* summary) {
  const auto map = MapView::open(path);
  if (!map) return map.status();
  MapData data = unpack_map(*map);
  const bool is_done = add_look_alikes(*map, &data, observer);
  if (!is_done) return {ErrorCode::kIo, "interrupted; the look-alikes of " + path + " are not known: run camloc map upgrade"};
  const MapWriteOptions options = write_options_of(*map);
  if (map->is_damaged()) return {ErrorCode::kCorrupt, path + ": was changed while it was read; try again"};
  if (Status status = write_map(data, out_path, options); !status) return status;
  if (summary == nullptr) return Status::ok();
  const std::vector<std::byte>& twins = data.extra_sections[map_format::kTwins].bytes;
  summary->num_landmarks = static_cast<std::uint32_t>(twins.size());
  summary->num_with_twins =
      static_cast<std::uint32_t>(twins.size()) - static_cast<std::uint32_t>(std::count(twins.begin(), twins.end(), std::byte{0}));
  const auto written = MapView::open(out_path);
  if (!written) return written.status();
  const LookAlikes look_alikes(*written);
  summary->num_keyframes = static_cast<std::uint32_t>(written->keyframes().size());
  for (std::uint32_t k = 0; k < summary->num_keyframes; ++k) summary->num_with_rivals += look_alikes.num_rivals(k) > 0 ? 1 : 0;
  return Status::ok();
}

}  // namespace camloc::mapping
