// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/localize/localization.h"

namespace camloc {

const char* to_string(State state) {
  switch (state) {
    case State::kNoCamera: return "NO_CAMERA";
    case State::kNoMap: return "NO_MAP";
    case State::kLost: return "LOST";
    case State::kCoarse: return "COARSE";
    case State::kLocalized: return "LOCALIZED";
    case State::kCoasting: return "COASTING";
  }
  return "UNKNOWN";
}

const char* to_string(Reason reason) {
  switch (reason) {
    case Reason::kNone: return "";
    case Reason::kNotStarted: return "not started";
    case Reason::kNoImage: return "no image, or of another size than the camera file says";
    case Reason::kFewFeatures: return "too few features in the image";
    case Reason::kNoCandidates: return "no mapped view looks alike";
    case Reason::kFewMatches: return "too few matches with the map";
    case Reason::kFewInliers: return "too few matches agree on one pose";
    case Reason::kLowInlierRatio: return "too many matches disagree with the pose";
    case Reason::kPoorSpread: return "matches cover too little of the image";
    case Reason::kAmbiguous: return "another place explains the image nearly as well";
    case Reason::kDepthInconsistent: return "measured depth contradicts the pose";
    case Reason::kCalibrationMismatch: return "image and depth fit the map only with another focal length";
    case Reason::kImplausibleMotion: return "pose jumps farther than a camera can move";
    case Reason::kUncertain: return "pose is too uncertain";
    case Reason::kMapDamaged: return "map file was damaged while in use";
    case Reason::kNoParallax: return "without depth it may be a picture of the place; move sideways";
  }
  return "unknown";
}

const char* to_string(Stage stage) {
  switch (stage) {
    case Stage::kExtract: return "extract";
    case Stage::kCandidates: return "candidates";
    case Stage::kMatch: return "match";
    case Stage::kEstimate: return "estimate";
    case Stage::kVerify: return "verify";
    case Stage::kTotal: return "total";
  }
  return "unknown";
}

}  // namespace camloc
