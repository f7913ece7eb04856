// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// See kinect_options.h.
#include "drivers/kinect/kinect_options.h"

#include <span>

namespace camloc::kinect {

namespace {

struct Choice {
  const char* name;
  int value;
};
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

/// nullopt: not given.
Result<std::optional<int>> choice(const SourceUrl& url, const std::string& key, std::span<const Choice> choices) {
  const auto option = url.options.find(key);
  if (option == url.options.end()) return std::optional<int>();
  std::string known;
  for (const Choice& candidate : choices) {
    if (option->second == candidate.name) return std::optional<int>(candidate.value);
    known += std::string(known.empty() ? "" : ", ") + candidate.name;
  }
  return Status(ErrorCode::kInvalid, url.text + ": option " + key + "=" + option->second + ": expected one of " + known);
}

Result<std::optional<double>> number(const SourceUrl& url, const std::string& key, double low, double high) {
  if (url.options.count(key) == 0) return std::optional<double>();
  const Result<double> value = url.number_option(key, 0, low, high);
  if (!value) return value.status();
  return std::optional<double>(*value);
}

}  // namespace

Result<KinectOptions> parse_kinect_options(const SourceUrl& url) {
  if (Status status = url.check_options({"depth", "auto_exposure", "exposure_us", "gain", "white_balance", "led", "tilt_deg"}); !status)
    return status;
  const auto depth = choice(url, "depth", kDepthModes), auto_exposure = choice(url, "auto_exposure", kSwitch);
  const auto white_balance = choice(url, "white_balance", kWhiteBalances), led = choice(url, "led", kLeds);
  const auto exposure_us = number(url, "exposure_us", 100, 33'000), gain = number(url, "gain", 1, 16),
             tilt_deg = number(url, "tilt_deg", -kMaxTiltDeg, kMaxTiltDeg);
  for (const auto* option : {&depth, &auto_exposure, &white_balance, &led}) {
    if (!*option) return option->status();
  }
  for (const auto* option : {&exposure_us, &gain, &tilt_deg}) {
    if (!*option) return option->status();
  }
  KinectOptions options;
  options.selector = url.path;
  if (*depth) options.depth = static_cast<DepthMode>(**depth);
  if (*auto_exposure) options.color.auto_exposure = **auto_exposure != 0;
  if (*white_balance) options.color.auto_white_balance = **white_balance != 0;
  if (*exposure_us) options.color.exposure_us = static_cast<int>(**exposure_us);
  options.color.gain = *gain;
  options.tilt_deg = *tilt_deg;
  if (*led) {
    options.is_led_status = **led == kLedStatus;
    if (**led >= 0) options.fixed_led = static_cast<Led>(**led);
  }
  if (options.color.auto_exposure.value_or(false) && (options.color.exposure_us || options.color.gain)) {
    return Status(ErrorCode::kInvalid, url.text + ": auto_exposure=1 contradicts exposure_us= and gain=, which are for manual exposure");
  }
  return options;
}

}  // namespace camloc::kinect
