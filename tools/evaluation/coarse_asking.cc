// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/evaluation/coarse_asking.h"

#include <utility>

namespace camloc::tools {

Result<std::unique_ptr<CoarseAsking>> CoarseAsking::open(const std::string& model_path, const MapView& map, const RgbdCamera& camera) {
  const Result<CoarseModel> model = read_coarse_model(model_path);
  if (!model) return model.status();
  if (Status status = check_coarse_map(model->info, map.info().map_id); !status) return status.with_context(model_path);
  Result<CoarseNetwork> network = CoarseNetwork::load(*model, camera);
  if (!network) return network.status().with_context(model_path);
  return std::unique_ptr<CoarseAsking>(new CoarseAsking(std::move(*network)));
}

void CoarseAsking::ask(const Frame& frame, Localizer* localizer) {
  if (asked_ != frame.sequence) {
    asked_ = frame.sequence;
    hint_.reset();
    if (const Result<CoarsePose> pose = network_.locate(frame)) hint_ = CoarseHint{pose->stamp_ns, pose->T_map_camera, pose->covariance};
  }
  if (hint_) localizer->coarse_hint(*hint_);
}

const Localization& CoarseAsking::process(const Frame& frame, Localizer* localizer) {
  const Localization& result = localizer->process(frame);
  if (result.state == State::kLost || result.state == State::kCoarse) ask(frame, localizer);
  return result;
}

const Localization& CoarseAsking::process_single(const Frame& frame, Localizer* localizer) {
  ask(frame, localizer);
  return localizer->process(frame);
}

}  // namespace camloc::tools
