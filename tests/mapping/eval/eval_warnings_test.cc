// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Each warning where there is reason for it, and none where there is not.
#include <gtest/gtest.h>

#include <functional>

#include "tools/mapping/eval/evaluation.h"

namespace camloc::mapping {
namespace {

Evaluation good() {
  Evaluation e;
  e.num_landmarks = e.num_used = 100;
  e.start = AlignStart::kSearch;
  e.search = SearchOutcome{0.02, 0.2, false, 6};
  e.registration.emplace();
  e.registration->is_converged = true;
  e.registration->weakest_share = 0.2;
  e.scale = 1.001;
  e.distances.map_extent_m = e.distances.cloud_extent_m = {8, 5, 2.6};
  return e;
}

TEST(EvalWarnings, AGoodEvaluationHasNone) { EXPECT_TRUE(warnings_of(good()).empty()); }

TEST(EvalWarnings, EachFaultHasItsWord) {
  const struct {
    const char* word;
    std::function<void(Evaluation*)> spoil;
  } cases[] = {
      {"SCALE: by ICP", [](Evaluation* e) { e->scale = 1.02; }},
      {"SCALE: by the control points", [](Evaluation* e) { e->points_scale = 0.98; }},
      {"SCALE: by the camera positions", [](Evaluation* e) { e->poses_scale = 1.03; }},
      {"VOLUME",
       [](Evaluation* e) {
         e->distances.map_extent_m = {1, 1, 1};
       }},
      {"VOLUME",
       [](Evaluation* e) {
         e->distances.cloud_extent_m = {1, 1, 1};
       }},
      {"POINTS: control point B is off by 0.300 m",
       [](Evaluation* e) {
         e->residuals = {{"A", 0.01, {0, 0, 0.01}, {}}, {"B", 0.01, {0.3, 0, 0}, {}}};
       }},
      {"START", [](Evaluation* e) { e->search->rival_score_m = 0.024; }},
      {"OVERLAP", [](Evaluation* e) { e->distances.num_outside = 21; }},
      {"POINTS: the surfaces put the map 0.20 m away",
       [](Evaluation* e) { e->start = AlignStart::kPoints, e->search.reset(), e->moved_m = 0.2; }},
      {"SLIDING", [](Evaluation* e) { e->registration->weakest_share = 0.005; }},
      {"ICP", [](Evaluation* e) { e->registration->is_converged = false; }},
  };
  for (const auto& c : cases) {
    Evaluation e = good();
    c.spoil(&e);
    const auto warnings = warnings_of(e);
    ASSERT_EQ(warnings.size(), 1U) << c.word;
    EXPECT_EQ(warnings[0].rfind(c.word, 0), 0U) << warnings[0];
  }
}

TEST(EvalWarnings, LimitsAreThoseThatTheyName) {
  Evaluation e = good();
  e.search->rival_score_m = 0.026;  // 1.25 times as far
  e.points_scale = 1.04;
  e.points_scale_tolerance = 0.05;
  e.distances.num_outside = 20;
  e.residuals = {{"A", 0.1, {0.4, 0, 0}, {1, 0, 0}}};  // within five sigmas; what ICP did is not its fault
  EXPECT_TRUE(warnings_of(e).empty()) << warnings_of(e)[0];
  e.search = SearchOutcome{0.02, 0.02, true, 6};  // in its own frame a map needs no proof
  EXPECT_TRUE(warnings_of(e).empty());
}

}  // namespace
}  // namespace camloc::mapping
