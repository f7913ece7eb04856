// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Surveys with known errors: what is found, what is named, and that nothing wrong is believed.
#include "tools/mapping/site/georef_fit.h"

#include <gtest/gtest.h>

#include <random>

#include "core/geometry/symmetric_system.h"
#include "tests/geometry/generated.h"
#include "tools/mapping/site/consensus.h"

namespace camloc::mapping {
namespace {

using testing::random_vector;

/// A floor of rooms: 20 x 12 m, points between 0.3 and 2.5 m high, site coordinates of a national grid.
struct Survey {
  Rigid3 T_wcs_map;
  std::vector<GeorefPoint> points;
};

Survey make_survey(int count, double sigma_m = 0.01, std::uint32_t seed = 1) {
  std::mt19937 rng(seed);
  Survey survey;
  survey.T_wcs_map = {exp_so3({0.01, -0.02, 0.7}), {456789.123, 5432109.876, 345.6}};
  for (int i = 0; i < count; ++i) {
    const double angle = 2.4 * i;  // the golden angle: no pattern
    const Eigen::Vector3d p_map(10 * std::cos(angle), 6 * std::sin(angle), 0.3 + 2.2 * (i * 37 % 11) / 10.0);
    GeorefPoint& point = survey.points.emplace_back();
    point.name = "P" + std::to_string(i);
    point.pair = {survey.T_wcs_map * p_map + random_vector(rng, sigma_m), p_map, sigma_m};
  }
  return survey;
}

GeorefOptions with_up() {
  GeorefOptions options;
  options.up_map = Eigen::Vector3d(0.05, -0.02, 1).normalized();
  return options;
}

GeorefOptions with_tolerance(double tolerance_m) {
  GeorefOptions options;
  options.tolerance_m = tolerance_m;
  return options;
}

void flatten(Survey* survey) {
  for (GeorefPoint& point : survey->points) {
    point.pair.p_a -= survey->T_wcs_map.rotation * Eigen::Vector3d(0, 0, point.pair.p_b.z());
    point.pair.p_b.z() = 0;
  }
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST(GeorefFit, FindsTheDatumWithItsCovariance) {
  const Survey survey = make_survey(8);
  const GeorefFit fit = fit_georef(survey.points, with_up());
  EXPECT_EQ(fit.problem, "");
  EXPECT_TRUE(fit.warnings.empty()) << fit.warnings[0];
  const Vector6d error = pose_error(survey.T_wcs_map, fit.datum.T_wcs_map);
  EXPECT_LT(error.head<3>().norm(), 0.02);
  EXPECT_LT(error.tail<3>().norm(), 0.003);
  EXPECT_LT(squared_mahalanobis(error, fit.datum.covariance), 22.46);
  EXPECT_NEAR(fit.similarity.scale, 1, 0.003);
  EXPECT_GT(fit.rms_leave_one_out_m, fit.rigid.rms_m);
  for (const GeorefPoint& point : fit.points) EXPECT_EQ(point.verdict, PointVerdict::kGood);
}

// The covariance holds what the sigmas do not know.
TEST(GeorefFit, CovarianceStaysHonestWhenTheSigmasAreTooSmall) {
  double nees = 0;
  constexpr int kTrials = 300;
  for (std::uint32_t seed = 1; seed <= kTrials; ++seed) {
    Survey survey = make_survey(10, 0.02, seed);
    for (GeorefPoint& point : survey.points) point.pair.sigma_m = 0.004;
    const GeorefFit fit = fit_georef(survey.points, with_tolerance(0.3));
    EXPECT_EQ(fit.problem, "");
    EXPECT_GT(fit.covariance_factor, 4);
    const Vector6d error = pose_error(survey.T_wcs_map, fit.datum.T_wcs_map);
    nees += squared_mahalanobis(error, fit.datum.covariance) / kTrials;
  }
  EXPECT_NEAR(nees, 6, 1.5);  // a little above: the factor is itself estimated
}

TEST(GeorefFit, NamesATypoOfAMetre) {
  for (const int count : {5, 6, 9, 20, 60}) {
    for (int axis = 0; axis < 3; ++axis) {
      Survey survey = make_survey(count);
      survey.points[3].pair.p_a[axis] += 1;
      const GeorefFit fit = fit_georef(survey.points, with_up());
      EXPECT_TRUE(contains(fit.problem, "P3 is ")) << fit.problem;
      EXPECT_TRUE(contains(fit.problem, std::string("d") + "xyz"[axis] + " +")) << fit.problem;
      for (const GeorefPoint& point : fit.points) EXPECT_EQ(point.verdict == PointVerdict::kSuspect, point.name == "P3") << point.name;
    }
  }
}

TEST(GeorefFit, NamesSeveralWrongPoints) {
  Survey survey = make_survey(12);
  survey.points[2].pair.p_a.x() += 1;
  survey.points[5].pair.p_a.z() -= 10;
  std::swap(survey.points[7].pair.p_a, survey.points[8].pair.p_a);  // two names exchanged
  const GeorefFit fit = fit_georef(survey.points, with_up());
  for (std::size_t i = 0; i < 12; ++i) {
    const bool is_wrong = i == 2 || i == 5 || i == 7 || i == 8;
    EXPECT_EQ(fit.points[i].verdict == PointVerdict::kSuspect, is_wrong) << i;
  }
  EXPECT_NE(fit.problem, "");
}

TEST(GeorefFit, ExcludesSuspectsOnlyWhenToldTo) {
  Survey survey = make_survey(7);
  survey.points[1].pair.p_a.y() -= 1;
  GeorefOptions options = with_up();
  EXPECT_NE(fit_georef(survey.points, options).problem, "");
  options.is_excluding_suspects = true;
  const GeorefFit fit = fit_georef(survey.points, options);
  EXPECT_EQ(fit.problem, "");
  EXPECT_EQ(fit.points[1].verdict, PointVerdict::kExcluded);
  EXPECT_NEAR(fit.points[1].residual_m.y(), -1, 0.05);
  EXPECT_LT(pose_error(survey.T_wcs_map, fit.datum.T_wcs_map).head<3>().norm(), 0.03);
}

// Four points on a floor and a wrong height: each of them could be the wrong one.
TEST(GeorefFit, DoesNotAccuseWhereItCannotBeTold) {
  Survey survey = make_survey(4);
  flatten(&survey);
  survey.points[2].pair.p_a.z() += 1;
  GeorefOptions options = with_up();
  options.is_excluding_suspects = true;
  const GeorefFit fit = fit_georef(survey.points, options);
  EXPECT_NE(fit.problem, "");
  for (const GeorefPoint& point : fit.points) {
    EXPECT_NE(point.verdict, PointVerdict::kSuspect) << point.name;
    EXPECT_NE(point.verdict, PointVerdict::kExcluded) << point.name;
  }
}

TEST(GeorefFit, ThreePointsThatContradictEachOtherAreRefused) {
  Survey survey = make_survey(3);
  survey.points[1].pair.p_a.x() += 1;
  const GeorefFit fit = fit_georef(survey.points, with_up());
  EXPECT_TRUE(contains(fit.problem, "contradict each other")) << fit.problem;
  EXPECT_TRUE(contains(fit.problem, "in the site and")) << fit.problem;
  for (const GeorefPoint& point : fit.points) EXPECT_EQ(point.verdict, PointVerdict::kUnclear);
}

TEST(GeorefFit, ThreeGoodPointsAreTakenWithAWarning) {
  const GeorefFit fit = fit_georef(make_survey(3).points, with_up());
  EXPECT_EQ(fit.problem, "");
  ASSERT_EQ(fit.warnings.size(), 1U);
  EXPECT_TRUE(contains(fit.warnings[0], "measure a fourth one"));
  for (const GeorefPoint& point : fit.points) EXPECT_FALSE(point.left_out.is_determined);
}

TEST(GeorefFit, SwappedAxes) {
  const struct {
    int a, b;
    const char* part;
  } cases[] = {{0, 1, "x and y swapped"}, {0, 2, "x and z swapped"}, {1, 2, "y and z swapped"}};
  for (const auto& one : cases) {
    Survey survey = make_survey(7);
    for (GeorefPoint& point : survey.points) std::swap(point.pair.p_a[one.a], point.pair.p_a[one.b]);
    const GeorefFit fit = fit_georef(survey.points, with_up());
    EXPECT_TRUE(contains(fit.problem, one.part)) << fit.problem;
    EXPECT_TRUE(contains(fit.problem, "the residuals drop from")) << fit.problem;
  }
  Survey survey = make_survey(7);
  for (GeorefPoint& point : survey.points) point.pair.p_a.z() *= -1;
  EXPECT_TRUE(contains(fit_georef(survey.points, with_up()).problem, "z turned over"));
  EXPECT_TRUE(contains(fit_georef(survey.points, {}).problem, "two axes swapped or one of them turned over"));
}

TEST(GeorefFit, SwappedAxesAndATypo) {
  Survey survey = make_survey(9);
  for (GeorefPoint& point : survey.points) std::swap(point.pair.p_a.x(), point.pair.p_a.y());
  survey.points[4].pair.p_a.x() += 1;
  EXPECT_TRUE(contains(fit_georef(survey.points, with_up()).problem, "x and y swapped"));
}

// In a plane the mirror image fits, with the building on its head.
TEST(GeorefFit, SwappedAxesOfPointsInAPlane) {
  Survey survey = make_survey(6);
  flatten(&survey);
  EXPECT_EQ(fit_georef(survey.points, with_up()).problem, "");
  for (GeorefPoint& point : survey.points) std::swap(point.pair.p_a.x(), point.pair.p_a.y());
  EXPECT_TRUE(contains(fit_georef(survey.points, with_up()).problem, "upside down"));
}

// A right-handed order of axes is a legal site, but an unusual one.
TEST(GeorefFit, WarnsWhereZIsNotUp) {
  Survey survey = make_survey(6);
  for (GeorefPoint& point : survey.points) {
    const Eigen::Vector3d p = point.pair.p_a;
    point.pair.p_a = {p.y(), p.z(), p.x()};
  }
  const GeorefFit fit = fit_georef(survey.points, with_up());
  EXPECT_EQ(fit.problem, "");
  ASSERT_EQ(fit.warnings.size(), 1U);
  EXPECT_TRUE(contains(fit.warnings[0], "up in the map is +y")) << fit.warnings[0];
}

TEST(GeorefFit, NamesTheUnit) {
  const struct {
    double scale;
    const char* part;
  } cases[] = {{1000, "millimetres"}, {100, "centimetres"}, {3.28084, "feet"}, {2, "divided by 2"}};
  for (const auto& one : cases) {
    Survey survey = make_survey(6);
    for (GeorefPoint& point : survey.points) point.pair.p_a *= one.scale;
    const std::string problem = fit_georef(survey.points, with_up()).problem;
    EXPECT_TRUE(contains(problem, one.part)) << problem;
  }
}

TEST(GeorefFit, WarnsOfAScaleThatIsOff) {
  Survey survey = make_survey(8, 0.002);
  for (GeorefPoint& point : survey.points) point.pair.p_b /= 1.015;
  const GeorefFit fit = fit_georef(survey.points, with_tolerance(0.5));
  EXPECT_EQ(fit.problem, "");
  ASSERT_EQ(fit.warnings.size(), 1U);
  EXPECT_TRUE(contains(fit.warnings[0], "1.5 % larger")) << fit.warnings[0];
}

TEST(GeorefFit, RefusesWhatDoesNotDetermineAMotion) {
  EXPECT_TRUE(contains(fit_georef({}, {}).problem, "0 common control points; at least 3"));
  EXPECT_TRUE(contains(fit_georef(make_survey(2).points, {}).problem, "2 common control points"));
  EXPECT_TRUE(contains(fit_georef(make_survey(2001).points, {}).problem, "at most 2000"));
  Survey line = make_survey(5);
  for (std::size_t i = 0; i < 5; ++i) {
    const Eigen::Vector3d p_map(2.0 * static_cast<double>(i), 1, 1);
    line.points[i].pair.p_b = p_map;
    line.points[i].pair.p_a = line.T_wcs_map * p_map;
  }
  EXPECT_TRUE(contains(fit_georef(line.points, {}).problem, "lie on a line")) << fit_georef(line.points, {}).problem;
  // Within the accuracy of the points.
  for (std::size_t i = 0; i < 5; ++i) line.points[i].pair.p_b.z() += i % 2 == 0 ? 0.02 : -0.02;
  EXPECT_TRUE(contains(fit_georef(line.points, {}).problem, "lie on a line"));
  Survey heap = make_survey(4);
  for (GeorefPoint& point : heap.points) point.pair = heap.points[0].pair;
  EXPECT_TRUE(contains(fit_georef(heap.points, {}).problem, "in one place"));
}

// Excluding must not leave a line.
TEST(GeorefFit, RefusesWhenTheRestIsALine) {
  Survey survey = make_survey(5);
  for (std::size_t i = 0; i < 4; ++i) {
    survey.points[i].pair.p_b = {2.0 * static_cast<double>(i), 1, 1};
    survey.points[i].pair.p_a = survey.T_wcs_map * survey.points[i].pair.p_b;
  }
  survey.points[4].pair.p_a += survey.T_wcs_map.rotation * Eigen::Vector3d(9, 0, 0);
  GeorefOptions options;
  options.is_excluding_suspects = true;
  const GeorefFit fit = fit_georef(survey.points, options);
  EXPECT_NE(fit.problem, "");
}

TEST(MatchPoints, InTheOrderOfThePointsWithBothSigmas) {
  const std::vector<ControlPoint> points = {{"A", {1, 2, 3}, 0.03, 1}, {"B", {4, 5, 6}, 0.01, 2}, {"C", {7, 8, 9}, 0.01, 3}};
  const std::vector<ObservedPoint> observed = {
      {"C", {1, 1, 1}, 0.01, 0, 1, ""}, {"X", {0, 0, 0}, 0.01, 0, 1, ""}, {"A", {2, 2, 2}, 0.04, 0.1, 3, ""}};
  const std::vector<GeorefPoint> matched = match_points(points, observed);
  ASSERT_EQ(matched.size(), 2U);
  EXPECT_EQ(matched[0].name, "A");
  EXPECT_NEAR(matched[0].pair.sigma_m, 0.05, 1e-12);
  EXPECT_EQ(matched[0].pair.p_b, Eigen::Vector3d(2, 2, 2));
  EXPECT_EQ(matched[0].num_measurements, 3U);
  EXPECT_EQ(matched[1].name, "C");
}

}  // namespace
}  // namespace camloc::mapping
