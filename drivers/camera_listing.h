// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What a driver says about the cameras that are plugged in, for people and for choosing one.
#pragma once

#include <string>
#include <vector>

namespace camloc {

/// A camera that is plugged in.
struct FoundCamera {
  std::string url;      ///< that opens it
  std::string name;     ///< for people
  std::string where;    ///< on which bus or node
  std::string problem;  ///< why it cannot be asked, one line; empty where it can
};

/// What there is of one kind of camera now. Nothing is opened for streaming.
struct CameraListing {
  std::vector<FoundCamera> cameras;
  std::string searched;  ///< what was looked at: "5 USB devices"
  std::string problem;   ///< why cameras may be missing here, one line; empty where nothing is wrong
  std::string advice;    ///< what to do when one is missing, with the command where there is one
};

}  // namespace camloc
