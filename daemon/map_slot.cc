// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/map_slot.h"

#include <new>
#include <utility>

namespace camloc {

Status MapSlot::load(const MapSlotOptions& options, const RgbdCamera& camera) {
  try {
    return load_within_memory(options, camera);
  } catch (const std::bad_alloc&) {  // the old map stays
    return {ErrorCode::kIo, options.path + ": not enough memory for this map; is a limit set (ulimit -v, LimitAS=)?"};
  }
}

Status MapSlot::load_within_memory(const MapSlotOptions& options, const RgbdCamera& camera) {
  struct stat file {};
  ::stat(options.path.c_str(), &file);  // before opening: a write in between is then noticed, if for nothing
  Result<MapView> view = MapView::open(options.path);
  if (!view) return view.status();
  const MapInfo& info = view->info();
  if (options.needs_datum && !info.wcs) {
    return {ErrorCode::kInvalid, options.path + ": map has no site datum but publish.frame is wcs; fit one with 'camloc map georef'"};
  }
  LocalizerOptions localizer_options = options.localizer;
  localizer_options.orb.scale_factor = info.orb_scale_factor;
  localizer_options.orb.num_levels = static_cast<int>(info.orb_num_levels);

  auto loaded = std::make_unique<Loaded>(std::move(view).value());
  loaded->path = options.path;
  loaded->file = file;
  loaded->localizer = std::make_unique<Localizer>(loaded->view, camera, localizer_options);
  loaded_ = std::move(loaded);
  return Status::ok();
}

bool MapSlot::was_overwritten() const {
  struct stat now {};
  if (::stat(loaded_->path.c_str(), &now) != 0) return false;  // removed: the mapping lives on
  const struct stat& then = loaded_->file;
  const bool is_same_file = now.st_dev == then.st_dev && now.st_ino == then.st_ino;
  return is_same_file &&
         (now.st_size != then.st_size || now.st_mtim.tv_sec != then.st_mtim.tv_sec || now.st_mtim.tv_nsec != then.st_mtim.tv_nsec);
}

}  // namespace camloc
