// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The plans. Seed 1 of the building is the one that published numbers are of; every other seed draws a building of its own, on which
// the same walks are possible: sides, offices and stretches move, and which stretches look alike is dealt anew.
#include "tools/camloc-sim/floor_plan.h"

#include <algorithm>
#include <array>
#include <numbers>

#include "tools/camloc-sim/noise.h"

namespace camloc::sim {
namespace {

constexpr double kPi = std::numbers::pi;

FloorPlan building_plan() {
  FloorPlan plan;
  plan.sides = {
      {{{0, 0}, 0}, 57, {{0, 2.2, 1}, {2.2, 10, 2}, {10, 22, 50}, {22, 30, 3}, {30, 38, 51}, {38, 46, 51}, {46, 57, 4}}},
      {{{57, 0}, 0.5 * kPi}, 40, {{0, 2.2, 5}, {2.2, 12, 6}, {12, 22, 7, true}, {22, 40, 8}}},
      {{{57, 40}, kPi}, 57, {{0, 2.2, 9}, {2.2, 10, 10}, {10, 22, 50}, {22, 36, 11}, {36, 45, 12, true}, {45, 57, 13}}},
      {{{0, 40}, 1.5 * kPi}, 40, {{0, 2.2, 14}, {2.2, 14, 15}, {14, 22, 51}, {22, 40, 16}}},
  };
  plan.offices = {{0, true, 3.5, 4.5, 5.0, 1},   {0, true, 23.5, 5.0, 4.6, 2}, {0, false, 47.5, 4.8, 5.0, 3},
                  {1, true, 4.0, 4.8, 5.0, 4},   {1, true, 28.0, 4.5, 4.8, 5}, {2, true, 3.5, 4.6, 5.0, 6},
                  {2, false, 26.0, 5.2, 4.8, 7}, {3, true, 5.0, 4.5, 5.0, 8},  {3, false, 27.0, 4.8, 5.0, 9}};
  return plan;
}

FloorPlan small_plan() {
  FloorPlan plan;
  plan.is_loop = false;
  plan.sides = {
      {{{0, 0}, 0}, 10, {{0, 7.8, 2}, {7.8, 10, 1}}},
      {{{10, 0}, 0.5 * kPi}, 8, {{0, 2.2, 5}, {2.2, 8, 6}}},
  };
  plan.offices = {{0, true, 3.0, 4.5, 4.6, 1}, {1, false, 3.0, 4.6, 4.6, 2}};
  return plan;
}

/// Numbers of one building, one after the other.
class Draw {
 public:
  explicit Draw(std::uint32_t seed) : seed_(seed) {}
  double between(double low, double high) { return range(next(), static_cast<float>(low), static_cast<float>(high)); }
  bool coin() { return next() % 2U == 0; }
  std::uint32_t next() { return hash32(seed_, 700, ++count_); }

 private:
  std::uint32_t seed_, count_ = 0;
};

/// Corners have looks of their own; the rest is cut into pieces of 6 to 13 m.
std::vector<Stretch> draw_stretches(double length, Draw* draw) {
  std::vector<Stretch> stretches{{0, kCorridorWidth, draw->next()}};
  while (length - stretches.back().to_s > 0) {
    const double from = stretches.back().to_s, rest = length - from;
    const double to = rest < 15 ? length : from + draw->between(6, 13);
    stretches.push_back({from, to, draw->next()});
  }
  return stretches;
}

/// Three stretches get one look, two another, two are blank.
void deal_looks(FloorPlan* plan, Draw* draw) {
  std::vector<std::pair<std::uint32_t, Stretch*>> order;
  for (CorridorSide& side : plan->sides) {
    for (std::size_t i = 1; i < side.stretches.size(); ++i) order.push_back({draw->next(), &side.stretches[i]});
  }
  std::sort(order.begin(), order.end());
  const std::uint32_t looks[] = {draw->next(), draw->next()};
  for (std::size_t i = 0; i < 5; ++i) order[i].second->look = looks[i < 3 ? 0 : 1];
  for (std::size_t i = 5; i < 7; ++i) order[i].second->is_blank = true;
}

FloorPlan draw_building(std::uint32_t seed) {
  Draw draw(seed);
  FloorPlan plan = building_plan();
  const double width = draw.between(51, 63), depth = draw.between(38, 46);
  const Placement corners[] = {{{0, 0}, 0}, {{width, 0}, 0.5 * kPi}, {{width, depth}, kPi}, {{0, depth}, 1.5 * kPi}};
  std::array<double, 4> scale{};
  for (std::size_t side = 0; side < 4; ++side) {
    const double length = side % 2 == 0 ? width : depth;
    scale[side] = length / plan.sides[side].length;
    plan.sides[side] = {corners[side], length, draw_stretches(length, &draw)};
  }
  deal_looks(&plan, &draw);
  for (std::size_t i = 0; i < plan.offices.size(); ++i) {
    Office& office = plan.offices[i];
    office.from_s = office.from_s * scale[static_cast<std::size_t>(office.side)] + draw.between(-0.4, 0.8);
    office.width = draw.between(4.4, 5.2);
    office.depth = draw.between(4.5, 5.3);
    const bool is_far_from_corners = i == 1 || i == 4 || i == 6;
    if (is_far_from_corners) office.is_outer = draw.coin();
  }
  return plan;
}

}  // namespace

FloorPlan floor_plan(SceneKind kind, std::uint32_t seed) {
  if (kind == SceneKind::kSmall) return small_plan();
  return seed == 1 ? building_plan() : draw_building(seed);
}

Placement office_place(const FloorPlan& plan, const Office& office) {
  const Placement& side = plan.sides[static_cast<std::size_t>(office.side)].place;
  if (office.is_outer) return side.child(office.from_s + office.width, -kWallThickness, kPi);
  return side.child(office.from_s, kCorridorWidth + kWallThickness, 0.0);
}

}  // namespace camloc::sim
