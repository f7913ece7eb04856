// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/training/trainer.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "tests/training/views.h"

namespace camloc::training {
namespace {

constexpr int kNumViews = 44;

/// Wants to stop at a batch.
class Impatient : public WorkObserver {
 public:
  explicit Impatient(std::uint64_t last) : last_(last) {}
  void show(const std::string&, std::uint64_t done, std::uint64_t, const std::string&) override { done_ = done; }
  [[nodiscard]] bool should_stop() const override { return done_ >= last_; }

 private:
  std::uint64_t last_, done_ = 0;
};

class TrainerTest : public ::testing::Test {
 protected:
  TrainerTest() {
    std::filesystem::create_directory(folder_);
    for (std::size_t i = 0; i < kNumViews; ++i) (i % 11 == 10 ? held_out_ : shown_).push_back(i);
  }
  ~TrainerTest() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] Trainer trainer(const TrainingOptions& options) const {
    return {*plan_network({"resnet", false}), set_, shown_, held_out_, options};
  }
  [[nodiscard]] std::string path(const char* name) const { return (folder_ / name).string(); }

  std::filesystem::path folder_ = std::filesystem::temp_directory_path() / ("camloc-trainer-" + std::to_string(getpid()));
  TrainingSet set_ = walk_before_wall(kNumViews);
  std::vector<std::size_t> shown_, held_out_;
};

TrainingOptions options_of(int num_epochs) {
  return {.num_epochs = num_epochs, .batch_size = 8, .learning_rate = 3e-3, .augmentation = {}};
}

std::vector<float> weights_of(Trainer& trainer) {
  std::vector<float> all;
  for (const OnnxTensor& tensor : trainer.best_model().weights) all.insert(all.end(), tensor.values.begin(), tensor.values.end());
  return all;
}

TEST_F(TrainerTest, LearnsWhereTheCameraIs) {
  TrainingOptions options = options_of(25);
  options.augmentation = {0, 0, 0, 0, 0, 0};
  Trainer learner = trainer(options);
  ASSERT_TRUE(learner.run(path("c"), &WorkObserver::nobody()));
  const auto& epochs = learner.epochs();
  ASSERT_EQ(epochs.size(), 25U);
  const HeldOutError& best = epochs[*learner.best_epoch()].held_out;
  // The mean of all poses is 0.46 m off.
  EXPECT_LT(best.mean_m, 0.23);
  EXPECT_LT(best.mean_deg, 6);
  EXPECT_LT(epochs.back().loss, epochs.front().loss);
}

TEST_F(TrainerTest, ResumedIsUninterruptedToTheBit) {
  Trainer whole = trainer(options_of(4));
  ASSERT_TRUE(whole.run(path("whole"), &WorkObserver::nobody()));

  Impatient in_third_epoch(12);
  Trainer first = trainer(options_of(4));
  ASSERT_TRUE(first.run(path("parted"), &in_third_epoch));
  EXPECT_EQ(first.epochs().size(), 2U);
  EXPECT_TRUE(first.best_epoch());

  Trainer second = trainer(options_of(4));
  ASSERT_TRUE(second.resume(path("parted")));
  ASSERT_TRUE(second.run(path("parted"), &WorkObserver::nobody()));
  EXPECT_EQ(weights_of(whole), weights_of(second));
  EXPECT_EQ(whole.epochs().back().loss, second.epochs().back().loss);
}

TEST_F(TrainerTest, TheModelIsWhatTheBestWeightsSay) {
  Trainer learner = trainer(options_of(2));
  ASSERT_TRUE(learner.run(path("c"), &WorkObserver::nobody()));
  std::vector<float> input(set_.input_size(), 0.1F);
  const std::vector<float> output = learner.best_output(input);
  ASSERT_EQ(output.size(), 7U);
  EXPECT_LT(std::abs(output[0]), 2);
}

TEST_F(TrainerTest, ACheckpointOfAnotherTrainingOrNoneIsRefused) {
  Trainer learner = trainer(options_of(1));
  ASSERT_TRUE(learner.run(path("c"), &WorkObserver::nobody()));
  Trainer other = trainer(options_of(2));
  EXPECT_EQ(other.resume(path("c")).code(), ErrorCode::kInvalid);
  EXPECT_EQ(other.resume(path("missing")).code(), ErrorCode::kNotFound);
  std::filesystem::resize_file(path("c"), std::filesystem::file_size(path("c")) / 2);
  EXPECT_EQ(learner.resume(path("c")).code(), ErrorCode::kCorrupt);
  std::ofstream(path("text")) << "no checkpoint";
  EXPECT_EQ(learner.resume(path("text")).code(), ErrorCode::kCorrupt);
}

TEST_F(TrainerTest, NoRoomForACheckpointEndsIt) {
  Trainer learner = trainer(options_of(2));
  EXPECT_EQ(learner.run("/dev/full/checkpoint", &WorkObserver::nobody()).code(), ErrorCode::kIo);
}

TEST_F(TrainerTest, AFrozenTrunkStays) {
  TrainingOptions options = options_of(1);
  options.is_trunk_frozen = true;
  Trainer frozen = trainer(options);
  ASSERT_TRUE(frozen.run(path("c"), &WorkObserver::nobody()));
  Trainer free = trainer(options_of(1));
  ASSERT_TRUE(free.run(path("d"), &WorkObserver::nobody()));
  options.num_epochs = 2;
  Trainer longer = trainer(options);
  ASSERT_TRUE(longer.run(path("e"), &WorkObserver::nobody()));
  const auto stem = [](Trainer& of) { return of.best_model().weights.front().values; };
  EXPECT_EQ(stem(frozen), stem(longer));
  EXPECT_NE(stem(frozen), stem(free));
}

TEST_F(TrainerTest, ALossThatIsNoNumberEndsIt) {
  TrainingOptions options = options_of(30);
  options.recipe = Recipe::kPaper;
  options.learning_rate = 1e6;
  Trainer learner = trainer(options);
  const Status status = learner.run(path("c"), &WorkObserver::nobody());
  EXPECT_EQ(status.code(), ErrorCode::kInvalid);
  EXPECT_NE(status.message().find("--learning-rate"), std::string::npos);
}

}  // namespace
}  // namespace camloc::training
