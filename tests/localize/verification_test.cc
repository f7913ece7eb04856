// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Each reason is reached from good evidence by one changed figure, on both sides of its limit.
#include "core/localize/verification.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

namespace camloc {
namespace {

PoseEvidence good() {
  PoseEvidence h;
  h.is_found = true;
  h.covariance = 1e-4 * Matrix6d::Identity();
  h.num_matches = 200;
  h.num_inliers = 150;
  h.num_visible = 400;
  h.spread = 0.6;
  h.num_with_depth = 100;
  h.depth_agreement = 0.9;
  h.num_map_depth = 250;
  h.map_depth_agreement = 0.9;
  h.focal_scale = 1.002;
  h.focal_scale_sigma = 0.004;
  h.has_focal_scale = true;
  return h;
}

struct Figures {
  PoseEvidence evidence = good();
  double margin = 0.8, lead = 20;
  bool is_tracked = false;
};

Reason verdict(const std::function<void(Figures*)>& change) {
  Figures figures;
  change(&figures);
  return verify(figures.evidence, Standing{figures.margin, figures.lead}, figures.is_tracked, LocalizerNumbers{});
}

TEST(Verification, GoodEvidenceIsVerified) {
  EXPECT_EQ(verdict([](Figures*) {}), Reason::kNone);
  EXPECT_EQ(verdict([](Figures* f) { f->is_tracked = true; }), Reason::kNone);
}

TEST(Verification, EveryFigureHasItsReason) {
  struct Case {
    Reason reason;
    std::function<void(Figures*)> good, bad;  ///< just inside and just outside the limit
  };
  const LocalizerNumbers o;
  const auto inliers = [](std::uint32_t count) {
    return [count](Figures* f) {
      f->evidence.num_inliers = count;
      f->evidence.num_matches = count + 5;
    };
  };
  const auto without_depth = [&](std::uint32_t count) {
    return [count, &inliers](Figures* f) {
      inliers(count)(f);
      f->evidence.num_map_depth = 29;
    };
  };
  const auto tracked = [&](std::uint32_t count) {
    return [count, &inliers](Figures* f) {
      inliers(count)(f);
      f->is_tracked = true;
    };
  };
  const auto focal = [](double scale, double sigma) {
    return [=](Figures* f) {
      f->evidence.focal_scale = scale;
      f->evidence.focal_scale_sigma = sigma;
    };
  };
  const Case cases[] = {
      {Reason::kFewMatches, inliers(o.min_inliers), [](Figures* f) { f->evidence.num_matches = f->evidence.num_inliers = 19; }},
      {Reason::kFewInliers, [](Figures*) {}, [](Figures* f) { f->evidence.is_found = false; }},
      {Reason::kFewInliers, inliers(o.min_inliers), inliers(o.min_inliers - 1)},
      {Reason::kFewInliers, without_depth(o.min_inliers_no_depth), without_depth(o.min_inliers_no_depth - 1)},
      {Reason::kFewInliers, tracked(o.min_tracked_inliers), tracked(o.min_tracked_inliers - 1)},
      {Reason::kLowInlierRatio, [](Figures* f) { f->evidence.num_matches = 374; }, [](Figures* f) { f->evidence.num_matches = 376; }},
      {Reason::kPoorSpread, [](Figures* f) { f->evidence.spread = 5.0 / 48; }, [](Figures* f) { f->evidence.spread = 4.0 / 48; }},
      {Reason::kAmbiguous, [](Figures* f) { f->margin = LocalizerNumbers{}.min_margin + 0.01; },
       [](Figures* f) { f->margin = LocalizerNumbers{}.min_margin - 0.01; }},
      {Reason::kAmbiguous, [](Figures* f) { f->lead = LocalizerNumbers{}.min_lead + 0.01; },
       [](Figures* f) { f->lead = LocalizerNumbers{}.min_lead - 0.01; }},
      {Reason::kDepthInconsistent, [](Figures* f) { f->evidence.depth_agreement = LocalizerNumbers{}.min_depth_agreement + 0.01; },
       [](Figures* f) { f->evidence.depth_agreement = LocalizerNumbers{}.min_depth_agreement - 0.01; }},
      {Reason::kDepthInconsistent, [](Figures* f) { f->evidence.map_depth_agreement = LocalizerNumbers{}.min_map_depth_agreement + 0.01; },
       [](Figures* f) { f->evidence.map_depth_agreement = LocalizerNumbers{}.min_map_depth_agreement - 0.01; }},
      {Reason::kCalibrationMismatch, focal(1.04, 0.004), focal(1.06, 0.004)},
      {Reason::kCalibrationMismatch, focal(0.96, 0.004), focal(0.94, 0.004)},
      {Reason::kCalibrationMismatch, focal(1.1, 0.026), focal(1.1, 0.024)},
      {Reason::kUncertain, [](Figures* f) { f->evidence.covariance(1, 1) = 0.14 * 0.14; },
       [](Figures* f) { f->evidence.covariance(1, 1) = 0.16 * 0.16; }},
      {Reason::kUncertain, [](Figures* f) { f->evidence.covariance(5, 5) = 0.055 * 0.055; },
       [](Figures* f) { f->evidence.covariance(5, 5) = 0.065 * 0.065; }},
      {Reason::kUncertain, [](Figures*) {},
       [](Figures* f) { f->evidence.covariance.setConstant(std::numeric_limits<double>::quiet_NaN()); }},
      {Reason::kUncertain, [](Figures*) {}, [](Figures* f) { f->evidence.covariance(4, 4) = std::numeric_limits<double>::infinity(); }},
  };
  int number = 0;
  for (const Case& c : cases) {
    EXPECT_EQ(verdict(c.good), Reason::kNone) << "case " << number << ": " << to_string(c.reason);
    EXPECT_EQ(verdict(c.bad), c.reason) << "case " << number << ": " << to_string(c.reason);
    ++number;
  }
}

TEST(Verification, LandmarksThatShouldBeSeenAndAreNotSpeakAgainstAGlobalFix) {
  const auto with = [](std::uint32_t num_found, bool is_tracked) {
    return verdict([=](Figures* f) {
      f->evidence.num_distinct_visible = 2000;
      f->evidence.num_distinct_inliers = num_found;
      f->is_tracked = is_tracked;
    });
  };
  EXPECT_EQ(with(31, false), Reason::kNone);
  EXPECT_EQ(with(29, false), Reason::kFewInliers);
  EXPECT_EQ(with(29, true), Reason::kNone) << "where it is was known before";
}

TEST(Verification, FlatEvidenceMustBeTwiceAsMuchOrComplete) {
  const LocalizerNumbers o;
  const auto with = [](std::uint32_t num_inliers, double thickness_m, double found_share) {
    return verdict([=](Figures* f) {
      f->evidence.num_inliers = num_inliers;
      f->evidence.num_matches = num_inliers + 5;
      f->evidence.thickness_m = thickness_m;
      f->evidence.num_distinct_visible = 1000;
      f->evidence.num_distinct_inliers = static_cast<std::uint32_t>(1000 * found_share);
    });
  };
  EXPECT_EQ(with(2 * o.min_inliers - 1, 0.01, 0.05), Reason::kFewInliers);
  EXPECT_EQ(with(2 * o.min_inliers, 0.01, 0.05), Reason::kNone);
  EXPECT_EQ(with(2 * o.min_inliers - 1, 0.03, 0.05), Reason::kNone) << "not flat";
  EXPECT_EQ(with(2 * o.min_inliers - 1, 0.01, 0.11), Reason::kNone) << "all that should be seen is";
}

TEST(Verification, ThinEvidenceNeedsDepthToConfirmIt) {
  const LocalizerNumbers o;
  const auto with = [&](std::uint32_t num_inliers, double inliers_agree, double map_agrees) {
    return verdict([=](Figures* f) {
      f->evidence.num_inliers = num_inliers;
      f->evidence.num_matches = num_inliers + 5;
      f->evidence.depth_agreement = inliers_agree;
      f->evidence.map_depth_agreement = map_agrees;
    });
  };
  EXPECT_EQ(with(o.strong_inliers, o.min_depth_agreement_thin - 0.01, 0.9), Reason::kNone);
  EXPECT_EQ(with(o.strong_inliers - 1, o.min_depth_agreement_thin - 0.01, 0.9), Reason::kDepthInconsistent);
  EXPECT_EQ(with(o.strong_inliers, 0.9, o.min_map_depth_agreement_thin - 0.01), Reason::kNone);
  EXPECT_EQ(with(o.strong_inliers - 1, 0.9, o.min_map_depth_agreement_thin - 0.01), Reason::kDepthInconsistent);
  EXPECT_EQ(with(o.strong_inliers - 1, o.min_depth_agreement_thin + 0.01, o.min_map_depth_agreement_thin + 0.01), Reason::kNone);
}

TEST(Verification, TooFewDepthsSayNothing) {
  EXPECT_EQ(verdict([](Figures* f) {
              f->evidence.num_with_depth = 11;
              f->evidence.depth_agreement = 0;
            }),
            Reason::kNone);
  EXPECT_EQ(verdict([](Figures* f) {
              f->evidence.num_map_depth = 29;
              f->evidence.map_depth_agreement = 0;
            }),
            Reason::kNone);
}

TEST(Verification, AnUnmeasuredFocalLengthIsNoMismatch) {
  PoseEvidence h = good();
  h.focal_scale = 1.5;
  EXPECT_TRUE(is_calibration_mismatch(h, LocalizerNumbers{}));
  h.has_focal_scale = false;
  EXPECT_FALSE(is_calibration_mismatch(h, LocalizerNumbers{}));
}

TEST(Verification, NoEvidenceFails) { EXPECT_EQ(verify(PoseEvidence{}, {}, true, LocalizerNumbers{}), Reason::kFewMatches); }

TEST(Quality, GrowsWithEveryFigureAndStaysInRange) {
  const int base = quality_of(good(), 0.8);
  EXPECT_GT(base, 40);
  EXPECT_LT(base, 100);
  PoseEvidence h = good();
  h.num_inliers = 60;
  EXPECT_LT(quality_of(h, 0.8), base);
  h = good();
  h.spread = 0.2;
  EXPECT_LT(quality_of(h, 0.8), base);
  h = good();
  h.num_matches = 400;
  EXPECT_LT(quality_of(h, 0.8), base);
  EXPECT_LT(quality_of(good(), 0.4), base);
  EXPECT_EQ(quality_of(good(), -3), 0);
  EXPECT_EQ(quality_of(PoseEvidence{}, 1), 0);
  h = good();
  h.num_inliers = h.num_matches = 5000;
  h.spread = 1;
  EXPECT_EQ(quality_of(h, 1), 100);
}

}  // namespace
}  // namespace camloc
