// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/v4l2/v4l2_controls.h"

#include <gtest/gtest.h>

#include "tests/drivers/fake_v4l2.h"

namespace camloc {
namespace {

using testing::FakeNode;
using testing::FakeV4l2;
using Values = std::map<std::string, std::string>;

class V4l2Controls : public ::testing::Test {
 protected:
  V4l2Controls() {
    node_.controls = {{0x980900, V4L2_CTRL_TYPE_INTEGER, 0, "Brightness", -64, 64, {}},
                      {0x98090c, V4L2_CTRL_TYPE_BOOLEAN, 0, "White Balance, Automatic", 0, 1, {}},
                      {0x980913, V4L2_CTRL_TYPE_INTEGER, V4L2_CTRL_FLAG_READ_ONLY, "Temperature", 0, 100, {}},
                      {0x9a0900, V4L2_CTRL_TYPE_CTRL_CLASS, V4L2_CTRL_FLAG_READ_ONLY, "Camera Controls", 0, 0, {}},
                      {0x9a0901, V4L2_CTRL_TYPE_MENU, 0, "Exposure, Auto", 0, 3, {"", "Manual Mode", "", "Aperture Priority Mode"}},
                      {0x9a0902, V4L2_CTRL_TYPE_INTEGER, V4L2_CTRL_FLAG_INACTIVE, "Exposure (Absolute)", 3, 2047, {}},
                      {0x9a0903, V4L2_CTRL_TYPE_INTEGER, V4L2_CTRL_FLAG_DISABLED, "Gone", 0, 1, {}}};
  }
  Status set(const Values& values) {
    const Result<V4l2Device> device = V4l2Device::open(io_, "/dev/video0");
    return device ? set_v4l2_controls(*device, values) : device.status();
  }
  FakeV4l2 io_;
  FakeNode& node_ = io_.add("/dev/video0");
};

TEST(V4l2ControlName, IsThatOfV4l2Ctl) {
  EXPECT_EQ(control_name("Exposure, Auto"), "exposure_auto");
  EXPECT_EQ(control_name("Exposure (Absolute)"), "exposure_absolute");
  EXPECT_EQ(control_name("  Gain 2\t"), "gain_2");
  EXPECT_EQ(control_name("\xC3\xA4!"), "");
}

TEST_F(V4l2Controls, SwitchesAndMenusComeBeforeNumbers) {
  ASSERT_TRUE(
      set({{"exposure_absolute", "100"}, {"exposure_auto", "manual_mode"}, {"brightness", "-5"}, {"white_balance_automatic", "off"}}));
  const std::vector<std::pair<std::string, int>> expected{
      {"Exposure, Auto", 1}, {"White Balance, Automatic", 0}, {"Brightness", -5}, {"Exposure (Absolute)", 100}};
  EXPECT_EQ(node_.controls_set, expected);
}

TEST_F(V4l2Controls, UnknownOnesListWhatThereIs) {
  const Status status = set({{"brightness", "1"}, {"sharpness", "3"}});
  EXPECT_EQ(status.code(), ErrorCode::kInvalid);
  EXPECT_EQ(status.message(),
            "/dev/video0: no control 'sharpness'; 'Fake Camera' has brightness, white_balance_automatic, exposure_auto, exposure_absolute");
  EXPECT_TRUE(node_.controls_set.empty()) << "nothing is set when something is wrong";
  EXPECT_EQ(set({{"gone", "0"}}).code(), ErrorCode::kInvalid) << "disabled";
}

TEST_F(V4l2Controls, ValuesOutOfRange) {
  for (const Values& values : {Values{{"brightness", "65"}},
                               {{"brightness", "1.5"}},
                               {{"brightness", ""}},
                               {{"exposure_auto", "4"}},
                               {{"exposure_auto", "Shutter Priority"}},
                               {{"temperature", "3"}},
                               {{"white_balance_automatic", "2"}},
                               {{"brightness", "99999999999999999999"}}}) {
    const Status status = set(values);
    EXPECT_EQ(status.code(), ErrorCode::kInvalid) << values.begin()->second;
    EXPECT_NE(status.message().find(values.begin()->first), std::string::npos);
  }
  EXPECT_TRUE(node_.controls_set.empty());
}

TEST_F(V4l2Controls, AListThatNeverEnds) {
  node_.faults.never_stops_listing = true;
  EXPECT_EQ(set({{"sharpness", "3"}}).code(), ErrorCode::kInvalid);
}

}  // namespace
}  // namespace camloc
