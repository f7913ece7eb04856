// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The open map together with the localizer that reads it, exchanged as one. A new map is opened, validated and given a
// localizer before the old one goes; when any of that fails, the old one stays.
#pragma once

#include <sys/stat.h>

#include <memory>
#include <string>

#include "core/base/result.h"
#include "core/localize/localizer.h"
#include "core/map/map_view.h"

namespace camloc {

struct MapSlotOptions {
  std::string path;
  bool needs_datum = false;    ///< poses are wanted in `wcs`
  LocalizerOptions localizer;  ///< its pyramid is replaced by the one the map was made with
};

/// Belongs to one thread.
class MapSlot {
 public:
  /// Errors: those of MapView::open; kInvalid when a datum is wanted and the map has none. The slot is then unchanged.
  [[nodiscard]] Status load(const MapSlotOptions& options, const RgbdCamera& camera);
  void drop() { loaded_.reset(); }

  [[nodiscard]] bool is_loaded() const { return loaded_ != nullptr; }
  [[nodiscard]] const MapInfo& info() const { return loaded_->view.info(); }
  [[nodiscard]] bool knows_look_alikes() const { return !loaded_->view.section(map_format::kTwins).empty(); }
  [[nodiscard]] Localizer& localizer() { return *loaded_->localizer; }
  /// A page could not be read: the file was cut while mapped.
  [[nodiscard]] bool is_damaged() const { return loaded_->view.is_damaged(); }
  /// The mapped file itself was written to. A file renamed over it, as write_map() does, is another file and changes
  /// nothing until a reload.
  [[nodiscard]] bool was_overwritten() const;
  [[nodiscard]] const std::string& path() const { return loaded_->path; }

 private:
  struct Loaded {
    explicit Loaded(MapView map) : view(std::move(map)) {}
    MapView view;
    std::unique_ptr<Localizer> localizer;  // reads view: declared after it
    std::string path;
    struct stat file {};
  };

  [[nodiscard]] Status load_within_memory(const MapSlotOptions& options, const RgbdCamera& camera);

  std::unique_ptr<Loaded> loaded_;
};

}  // namespace camloc
