// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The part of the service that opens, exchanges and drops maps.
#include "daemon/clock.h"
#include "daemon/service.h"
#include "daemon/service_setup.h"

namespace camloc {

Status Service::reload() {
  notifier_.reloading();
  const Status status = apply_new_config();
  if (status) {
    ++board_.counters().map_reloads;
    log_.write(LogLevel::kInfo, "reloaded");
  } else {
    ++board_.counters().map_reload_failures;
    log_.write(LogLevel::kWarning, "reload failed, everything stays as it was: %s", status.message().c_str());
  }
  publish_status();
  notifier_.ready(board_.get().state_text.c_str());
  return status;
}

// All or nothing: the new map is open before any new setting is taken over.
Status Service::apply_new_config() {
  const Result<Config> config = in_.reload_config();
  if (!config) return config.status();
  if (camera_) {
    if (const Status status = map_.load(map_slot_options(*config), *camera_); !status) return status;
  }
  const std::string ignored = changes_that_need_restart(in_.config, *config);
  if (!ignored.empty()) log_.write(LogLevel::kWarning, "these settings need a restart: %s", ignored.c_str());
  for (const Setting& setting : settings()) {
    if (!setting.is_reloadable) continue;
    if (const Status status = assign(setting, value_of(setting, *config), &in_.config); !status) return status;
  }
  log_.set_level(in_.config.parsed_log_level());
  if (map_.is_loaded()) announce_map();
  return Status::ok();
}

// At start, and every second while there is no map.
void Service::retry_map() {
  if (map_.is_loaded() || !camera_) return;
  const Status status = map_.load(map_slot_options(in_.config), *camera_);
  if (status) return announce_map();
  if (map_trouble_.is_new(status.message())) log_.write(LogLevel::kWarning, "no map: %s", status.message().c_str());
}

// A file written in place is another map, or half of one: take it when it is whole, or have none. A file renamed over
// the old one, as maps are written, changes nothing until a reload.
void Service::check_map_file() {
  if (map_.is_damaged()) return drop_map("a part of the map file is gone: it was truncated while in use");
  if (map_.was_overwritten()) drop_map("the map file was written to while in use");
}

void Service::announce_map() {
  map_trouble_.clear();
  no_map_.reason = Reason::kNotStarted;
  reset_offset_ += num_resets_ + 1;  // another map, another frame of reference: poses may jump
  num_resets_ = 0;
  hint_.reset();
  const MapInfo& info = map_.info();
  board_.set_map(map_.path(), info.map_id);
  log_.write(LogLevel::kInfo, "map open: %s, id %016llx, %u landmarks, %u keyframes", map_.path().c_str(),
             static_cast<unsigned long long>(info.map_id), info.num_landmarks, info.num_keyframes);
  if (!map_.knows_look_alikes())
    log_.write(LogLevel::kWarning, "the map does not know its look-alikes, and a pose may be at one: camloc map upgrade %s",
               map_.path().c_str());
  start_coarse();
}

// Poses of a network are poses in one map; another map or another camera has a worker of its own.
void Service::start_coarse() {
  coarse_.reset();
  coarse_trouble_.clear();
  if (in_.config.coarse_cnn.empty()) return;
  coarse_ = std::make_unique<CoarseWorker>(coarse_worker_options(in_.config.coarse_cnn, map_.info().map_id, *camera_));
}

// Without the network the map is asked by words alone, as it is where none is configured.
void Service::check_coarse() {
  if (!coarse_ || coarse_->phase() != CoarsePhase::kFailed) return;
  const std::string problem = coarse_->problem();
  if (coarse_trouble_.is_new(problem)) log_.write(LogLevel::kWarning, "no coarse model: %s", problem.c_str());
}

void Service::drop_map(const std::string& why) {
  log_.write(LogLevel::kError, "map dropped: %s", why.c_str());
  no_map_.reason = Reason::kMapDamaged;
  coarse_.reset();
  map_.drop();
  board_.set_map(in_.config.map_path, 0);
}

}  // namespace camloc
