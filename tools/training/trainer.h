// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Teaches a network the poses of a training set, epoch by epoch, and keeps the weights that did best on frames it was not shown.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/base/work_observer.h"
#include "core/coarse/onnx_file.h"
#include "tools/training/network_plan.h"
#include "tools/training/training_set.h"

namespace camloc::training {

enum class Recipe {
  kPractical,  ///< AdamW, cosine schedule, weights of position and rotation learned (Kendall and Cipolla, "Geometric loss functions for
               ///< camera pose regression with deep learning", 2017)
  kPaper,  ///< stochastic gradient descent, momentum 0.9, rate cut by 90 % every 80 epochs, rotation weighed by `beta` ("PoseNet", 2015)
};

struct TrainingOptions {
  Recipe recipe = Recipe::kPractical;
  int num_epochs = 120;
  int batch_size = 16;
  double learning_rate = 1e-3;
  double beta = 250;             ///< of the paper's recipe: what a rotation counts beside a metre
  bool is_trunk_frozen = false;  ///< only the heads learn
  std::uint64_t seed = 1;
  int num_threads = 1;  ///< one: the same bits on every run
  AugmentationLimits augmentation;
};

/// Errors on the frames that were held out.
struct HeldOutError {
  double median_m = 0, median_deg = 0, mean_m = 0, mean_deg = 0;
  double rms_m = 0, rms_rad = 0;  ///< root mean square of the distance and of the angle
};

struct EpochRecord {
  double loss = 0;  ///< mean over the epoch
  HeldOutError held_out;
  double seconds = 0;
};

/// Not thread-safe.
class Trainer {
 public:
  /// `held_out` and `shown` are indices of the set's views. The set outlives the trainer.
  Trainer(const NetworkPlan& plan, const TrainingSet& set, std::vector<std::size_t> shown, std::vector<std::size_t> held_out,
          const TrainingOptions& options);
  ~Trainer();

  /// Weights of another model for the trunk; errors of initialize_trunk().
  [[nodiscard]] Status initialize(const OnnxModel& model);
  /// Goes on where save() was called, to the bit. kInvalid: it was another training; kCorrupt; kIo.
  [[nodiscard]] Status resume(const std::string& path);
  /// All that the training is, as a whole file or not at all.
  [[nodiscard]] Status save(const std::string& path) const;

  /// Up to the last epoch, saving to `checkpoint` after each; an observer that wants to stop ends it after the batch at hand. An error:
  /// the checkpoint cannot be written, or the loss is no number any more.
  [[nodiscard]] Status run(const std::string& checkpoint, WorkObserver* observer);

  [[nodiscard]] const std::vector<EpochRecord>& epochs() const;
  /// Index of the epoch whose weights best_model() has; none before the first is over.
  [[nodiscard]] std::optional<std::size_t> best_epoch() const;
  /// Without metadata.
  [[nodiscard]] OnnxModel best_model();
  /// What the best weights make of an input of the network: 7 values, as the ONNX model's output.
  [[nodiscard]] std::vector<float> best_output(std::span<const float> input);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace camloc::training
