// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/evaluation/perturbation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <random>

namespace camloc::tools {
namespace {

struct Entry {
  const char* name;
  Perturbation::Kind kind;
  double min, max;
};

constexpr std::array<Entry, 5> kEntries{{
    {"gamma", Perturbation::Kind::kGamma, 0.05, 20},
    {"contrast", Perturbation::Kind::kContrast, 0, 10},
    {"exposure", Perturbation::Kind::kExposure, 0, 20},
    {"noise", Perturbation::Kind::kNoise, 0, 128},
    {"blur", Perturbation::Kind::kBlur, 1, 101},
}};

std::uint8_t to_gray(double value) { return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 255.0))); }

double tone(const Perturbation& perturbation, double v) {
  switch (perturbation.kind) {
    case Perturbation::Kind::kGamma: return 255.0 * std::pow(v / 255.0, perturbation.value);
    case Perturbation::Kind::kContrast: return 128.0 + perturbation.value * (v - 128.0);
    case Perturbation::Kind::kExposure: return perturbation.value * v;
    default: return v;
  }
}

void apply_tone(const Perturbation& perturbation, Image<std::uint8_t>* gray) {
  std::array<std::uint8_t, 256> table{};
  for (int v = 0; v < 256; ++v) table[static_cast<std::size_t>(v)] = to_gray(tone(perturbation, v));
  for (std::uint8_t& pixel : gray->pixels) pixel = table[pixel];
}

void apply_noise(double sigma, std::uint64_t sequence, Image<std::uint8_t>* gray) {
  std::mt19937_64 random(sequence * 0x9E3779B97F4A7C15ULL + 1);
  std::normal_distribution<double> noise(0.0, sigma);
  for (std::uint8_t& pixel : gray->pixels) pixel = to_gray(pixel + noise(random));
}

void apply_blur(int length, Image<std::uint8_t>* gray) {
  std::vector<std::uint8_t> source(static_cast<std::size_t>(gray->width));
  for (int y = 0; y < gray->height; ++y) {
    std::uint8_t* row = gray->row(y);
    std::copy(row, row + gray->width, source.begin());
    for (int x = 0; x < gray->width; ++x) {
      int sum = 0;
      for (int k = 0; k < length; ++k) sum += source[static_cast<std::size_t>(std::clamp(x + k - length / 2, 0, gray->width - 1))];
      row[x] = static_cast<std::uint8_t>((sum + length / 2) / length);
    }
  }
}

}  // namespace

Result<Perturbation> parse_perturbation(const std::string& text) {
  const std::size_t equals = text.find('=');
  for (const Entry& entry : kEntries) {
    if (equals == std::string::npos || text.substr(0, equals) != entry.name) continue;
    const std::string number = text.substr(equals + 1);
    char* end = nullptr;
    const double value = std::strtod(number.c_str(), &end);
    if (number.empty() || *end != '\0' || !(value >= entry.min && value <= entry.max)) break;
    return Perturbation{entry.kind, value};
  }
  return {ErrorCode::kInvalid,
          "--perturb " + text + ": expected gamma=0.05..20, contrast=0..10, exposure=0..20, noise=0..128 or blur=1..101"};
}

void apply(const std::vector<Perturbation>& perturbations, std::uint64_t sequence, Image<std::uint8_t>* gray) {
  for (const Perturbation& perturbation : perturbations) {
    switch (perturbation.kind) {
      case Perturbation::Kind::kNoise: apply_noise(perturbation.value, sequence, gray); break;
      case Perturbation::Kind::kBlur: apply_blur(static_cast<int>(std::lround(perturbation.value)), gray); break;
      default: apply_tone(perturbation, gray); break;
    }
  }
}

}  // namespace camloc::tools
