// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/kinect/kinect_options.h"

#include <span>
#include <utility>

namespace camloc::kinect {

namespace {

using Choice = std::pair<const char*, int>;
constexpr Choice kDepthModes[] = {{"registered", static_cast<int>(DepthMode::kRegistered)},
                                  {"raw", static_cast<int>(DepthMode::kRaw)},
                                  {"off", static_cast<int>(DepthMode::kOff)}};
constexpr Choice kSwitch[] = {{"0", 0}, {"1", 1}};
constexpr Choice kWhiteBalances[] = {{"auto", 1}, {"manual", 0}};
constexpr int kLedStatus = -1, kLedKeep = -2;
constexpr Choice kLeds[] = {{"status", kLedStatus},
                            {"keep", kLedKeep},
                            {"off", static_cast<int>(Led::kOff)},
                            {"green", static_cast<int>(Led::kGreen)},
                            {"red", static_cast<int>(Led::kRed)},
                            {"yellow", static_cast<int>(Led::kYellow)},
                            {"blink", static_cast<int>(Led::kBlinkGreen)}};

/// nullopt: not given, or none of `choices`.
std::optional<int> choice(const SourceUrl& url, const std::string& key, std::span<const Choice> choices, OptionReader* reader) {
  if (!reader->has(key)) return std::nullopt;
  std::string known;
  for (const auto& [name, value] : choices) {
    if (url.options.at(key) == name) return value;
    known += std::string(known.empty() ? "" : ", ") + name;
  }
  reader->fail(key, "expected one of " + known);
  return std::nullopt;
}

}  // namespace

Result<KinectOptions> parse_kinect_options(const SourceUrl& url) {
  if (Status status = url.check_options({"depth", "auto_exposure", "exposure_us", "gain", "white_balance", "led", "tilt_deg"}); !status)
    return status;
  OptionReader reader(url);
  KinectOptions options;
  options.selector = url.path;
  if (const auto depth = choice(url, "depth", kDepthModes, &reader)) options.depth = static_cast<DepthMode>(*depth);
  if (const auto is_auto = choice(url, "auto_exposure", kSwitch, &reader)) options.color.auto_exposure = *is_auto != 0;
  if (const auto is_auto = choice(url, "white_balance", kWhiteBalances, &reader)) options.color.auto_white_balance = *is_auto != 0;
  if (const auto led = choice(url, "led", kLeds, &reader)) {
    options.is_led_status = *led == kLedStatus;
    if (*led >= 0) options.fixed_led = static_cast<Led>(*led);
  }
  if (const auto exposure_us = reader.given_number("exposure_us", 100, 33'000)) options.color.exposure_us = static_cast<int>(*exposure_us);
  options.color.gain = reader.given_number("gain", 1, 16);
  options.tilt_deg = reader.given_number("tilt_deg", -kMaxTiltDeg, kMaxTiltDeg);
  if (!reader.status()) return reader.status();
  if (options.color.auto_exposure.value_or(false) && (options.color.exposure_us || options.color.gain)) {
    return Status(ErrorCode::kInvalid, url.text + ": auto_exposure=1 contradicts exposure_us= and gain=, which are for manual exposure");
  }
  return options;
}

}  // namespace camloc::kinect
