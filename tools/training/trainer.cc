// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Every epoch draws from generators that are seeded by the epoch alone, so a training that is resumed sees what an uninterrupted one
// would have seen.
#include "tools/training/trainer.h"

#include <torch/autograd.h>
#include <torch/optim/adamw.h>
#include <torch/optim/sgd.h>
#include <torch/serialize.h>
#include <torch/utils.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <numeric>
#include <random>
#include <sstream>
#include <utility>

#include "core/base/mix_bits.h"
#include "core/base/order_statistics.h"
#include "core/io/file_bytes.h"
#include "tools/common/text_format.h"
#include "tools/training/onnx_export.h"
#include "tools/training/planned_network.h"

namespace camloc::training {
namespace {

constexpr int kWarmUpEpochs = 3;
constexpr double kLastRateShare = 0.01, kWeightDecay = 1e-2, kMomentum = 0.9;
constexpr int kEpochsPerCut = 80;
constexpr double kCut = 0.1;
/// Of the heads that help training, against the last one.
constexpr double kHelpingWeight = 0.3;
/// Logarithms of position's and rotation's variance, to begin with.
constexpr float kFirstLogPosition = 0.0F, kFirstLogRotation = -3.0F;
constexpr std::size_t kMaxCheckpointBytes = std::size_t{2} << 30;

PositionScale scale_of(const TrainingSet& set, const std::vector<std::size_t>& shown) {
  PositionScale scale;
  for (const std::size_t index : shown) scale.mean_m += set.views()[index].T_map_camera.translation / static_cast<double>(shown.size());
  double sum = 0;
  for (const std::size_t index : shown) sum += (set.views()[index].T_map_camera.translation - scale.mean_m).squaredNorm();
  scale.deviation_m = std::max(0.01, std::sqrt(sum / (3.0 * static_cast<double>(shown.size()))));
  return scale;
}

/// q and -q are one rotation: all on the side of the first view.
Eigen::Quaterniond on_one_side(const Eigen::Quaterniond& rotation, const Eigen::Quaterniond& side) {
  return rotation.dot(side) < 0 ? Eigen::Quaterniond(-rotation.coeffs()) : rotation;
}

struct Batch {
  torch::Tensor images, positions_m, rotations;
};

struct Losses {
  torch::Tensor position_m, rotation;
};

Losses losses_of(const torch::Tensor& pose, const Batch& batch, const PositionScale& scale) {
  const torch::Tensor mean = torch::tensor({scale.mean_m.x(), scale.mean_m.y(), scale.mean_m.z()}).to(torch::kFloat32);
  const torch::Tensor position_m = pose.slice(1, 0, 3) * scale.deviation_m + mean;
  const torch::Tensor rotation = pose.slice(1, 3, 7);
  const torch::Tensor unit = rotation / rotation.norm(2, 1, true).clamp_min(1e-6);
  return {(position_m - batch.positions_m).norm(2, 1).mean(), (unit - batch.rotations).norm(2, 1).mean()};
}

}  // namespace

struct Trainer::State {
  const TrainingSet* set;
  std::vector<std::size_t> shown, held_out;
  TrainingOptions options;
  PositionScale scale;
  Eigen::Quaterniond side;
  PlannedNetwork network, best;
  torch::Tensor log_position, log_rotation;  ///< learned weights of the practical recipe
  std::unique_ptr<torch::optim::Optimizer> optimizer;
  std::vector<EpochRecord> epochs;
  std::optional<std::size_t> best_epoch;

  State(const NetworkPlan& plan, const TrainingSet& views, std::vector<std::size_t> to_show, std::vector<std::size_t> to_hold_out,
        const TrainingOptions& with)
      : set(&views),
        shown(std::move(to_show)),
        held_out(std::move(to_hold_out)),
        options(with),
        scale(scale_of(views, shown)),
        side(views.views()[shown.front()].T_map_camera.rotation),
        network(nullptr),
        best(nullptr) {
    torch::set_num_threads(options.num_threads);
    torch::manual_seed(options.seed);
    network = PlannedNetwork(plan);
    best = PlannedNetwork(plan);
    log_position = torch::full({1}, kFirstLogPosition, torch::requires_grad());
    log_rotation = torch::full({1}, kFirstLogRotation, torch::requires_grad());
    start_heads_at_mean();
    make_optimizer();
  }

  /// The heads begin with the mean pose and not with a quaternion of nearly no length.
  void start_heads_at_mean() {
    const torch::NoGradGuard no_gradients;
    for (const int head : network->plan().heads) {
      const Eigen::Vector4d wxyz(side.w(), side.x(), side.y(), side.z());
      for (int i = 0; i < 4; ++i) network->linears.at(head)->bias[3 + i] = wxyz[i];
    }
  }

  void make_optimizer() {
    std::vector<torch::Tensor> learned;
    for (const auto& [index, module] : network->convolutions)
      if (!is_frozen(index)) append(&learned, module->parameters());
    for (const auto& [index, module] : network->norms)
      if (!is_frozen(index)) append(&learned, module->parameters());
    for (const auto& [index, module] : network->linears) append(&learned, module->parameters());
    if (options.recipe == Recipe::kPaper) {
      optimizer = std::make_unique<torch::optim::SGD>(learned, torch::optim::SGDOptions(options.learning_rate).momentum(kMomentum));
      return;
    }
    append(&learned, {log_position, log_rotation});
    optimizer =
        std::make_unique<torch::optim::AdamW>(learned, torch::optim::AdamWOptions(options.learning_rate).weight_decay(kWeightDecay));
  }
  [[nodiscard]] bool is_frozen(int layer) const { return options.is_trunk_frozen && layer < network->plan().num_trunk_layers; }
  static void append(std::vector<torch::Tensor>* all, const std::vector<torch::Tensor>& more) {
    all->insert(all->end(), more.begin(), more.end());
  }

  [[nodiscard]] double learning_rate(std::size_t epoch) const {
    const auto done = static_cast<double>(epoch);
    if (options.recipe == Recipe::kPaper) return options.learning_rate * std::pow(kCut, std::floor(done / kEpochsPerCut));
    if (done < kWarmUpEpochs) return options.learning_rate * (done + 1) / (kWarmUpEpochs + 1);
    const double share = (done - kWarmUpEpochs) / std::max(1.0, static_cast<double>(options.num_epochs) - kWarmUpEpochs);
    return options.learning_rate * (kLastRateShare + (1 - kLastRateShare) * 0.5 * (1 + std::cos(M_PI * share)));
  }

  [[nodiscard]] std::mt19937_64 generator(std::size_t epoch) const { return std::mt19937_64(mix_bits(options.seed * 1000003 + epoch)); }

  [[nodiscard]] Batch draw(std::span<const std::size_t> indices, const AugmentationLimits& limits, std::mt19937_64* random) const {
    const auto size = static_cast<std::int64_t>(indices.size());
    const LayerShape& in = network->plan().input;
    Batch batch{torch::empty({size, in.channels, in.height, in.width}), torch::empty({size, 3}), torch::empty({size, 4})};
    for (std::int64_t i = 0; i < size; ++i) {
      float* const image = batch.images.data_ptr<float>() + i * in.size();
      const Rigid3 pose = set->draw(indices[static_cast<std::size_t>(i)], limits, random, {image, static_cast<std::size_t>(in.size())});
      const Eigen::Quaterniond q = on_one_side(pose.rotation, side);
      Eigen::Map<Eigen::Vector3f>(batch.positions_m.data_ptr<float>() + 3 * i) = pose.translation.cast<float>();
      Eigen::Map<Eigen::Vector4f>(batch.rotations.data_ptr<float>() + 4 * i) = Eigen::Vector4d(q.w(), q.x(), q.y(), q.z()).cast<float>();
    }
    return batch;
  }

  [[nodiscard]] torch::Tensor loss_of(const std::vector<torch::Tensor>& poses, const Batch& batch) const {
    torch::Tensor total = torch::zeros({1});
    for (std::size_t head = 0; head < poses.size(); ++head) {
      const Losses losses = losses_of(poses[head], batch, scale);
      const double weight = head + 1 == poses.size() ? 1 : kHelpingWeight;
      total = total + weight * (options.recipe == Recipe::kPaper
                                    ? losses.position_m + options.beta * losses.rotation
                                    : losses.position_m * torch::exp(-log_position) + losses.rotation * torch::exp(-log_rotation));
    }
    return options.recipe == Recipe::kPaper ? total : total + log_position + log_rotation;
  }

  /// With its trunk frozen a network's norms keep what they were given.
  void set_training() {
    network->train();
    for (auto& [index, norm] : network->norms)
      if (is_frozen(index)) norm->eval();
  }

  [[nodiscard]] HeldOutError evaluate() {
    const torch::NoGradGuard no_gradients;
    network->eval();
    std::mt19937_64 unused(1);
    const AugmentationLimits as_it_is{0, 0, 0, 0, 0, 0};
    std::vector<double> metres, radians;
    for (const std::size_t index : held_out) {
      const Batch batch = draw({&index, 1}, as_it_is, &unused);
      const Rigid3 pose = pose_of(network->forward(batch.images).back());
      const Rigid3& truth = set->views()[index].T_map_camera;
      metres.push_back((pose.translation - truth.translation).norm());
      radians.push_back(rotation_distance_rad(pose.rotation, truth.rotation));
    }
    return summary_of(metres, radians);
  }

  [[nodiscard]] Rigid3 pose_of(const torch::Tensor& output) const {
    const float* const v = output.data_ptr<float>();
    const Eigen::Vector3d position(v[0], v[1], v[2]);
    return {Eigen::Quaterniond(v[3], v[4], v[5], v[6]).normalized(), scale.mean_m + scale.deviation_m * position};
  }

  static HeldOutError summary_of(const std::vector<double>& metres, const std::vector<double>& radians) {
    constexpr double kDegrees = 180 / M_PI;
    const auto count = static_cast<double>(metres.size());
    const auto mean = [&](const std::vector<double>& v) { return std::accumulate(v.begin(), v.end(), 0.0) / count; };
    const auto rms = [&](const std::vector<double>& v) {
      return std::sqrt(std::inner_product(v.begin(), v.end(), v.begin(), 0.0) / count);
    };
    HeldOutError error{.mean_m = mean(metres), .mean_deg = kDegrees * mean(radians), .rms_m = rms(metres), .rms_rad = rms(radians)};
    error.median_m = upper_median(metres);
    error.median_deg = kDegrees * upper_median(radians);
    return error;
  }

  /// What makes one epoch better than another: both parts of the error, a turn as far as the camera's scatter.
  [[nodiscard]] double badness(const HeldOutError& error) const { return error.mean_m / scale.deviation_m + error.mean_deg * M_PI / 180; }

  void keep_as_best() {
    const torch::NoGradGuard no_gradients;
    const auto copy = [](const auto& from, auto&& to) {
      for (const auto& item : from) to[item.key()].copy_(item.value());
    };
    copy(network->named_parameters(), best->named_parameters());
    copy(network->named_buffers(), best->named_buffers());
    best->eval();
    best_epoch = epochs.size() - 1;
  }

  /// Of what makes two trainings the same.
  [[nodiscard]] std::vector<double> identity() const {
    double sum = 0;
    for (const TrainingView& view : set->views()) sum += view.T_map_camera.translation.sum() + static_cast<double>(view.frame);
    return {static_cast<double>(options.recipe),
            static_cast<double>(options.num_epochs),
            static_cast<double>(options.batch_size),
            options.learning_rate,
            options.beta,
            static_cast<double>(options.is_trunk_frozen),
            static_cast<double>(options.seed),
            static_cast<double>(shown.size()),
            static_cast<double>(held_out.size()),
            static_cast<double>(network->plan().layers.size()),
            static_cast<double>(network->plan().input.size()),
            sum};
  }
};

namespace {

constexpr int kRecordValues = 8;

torch::Tensor tensor_of(const std::vector<EpochRecord>& epochs) {
  std::vector<double> values;
  for (const EpochRecord& of : epochs) {
    const HeldOutError& error = of.held_out;
    for (const double value :
         {of.loss, of.seconds, error.median_m, error.median_deg, error.mean_m, error.mean_deg, error.rms_m, error.rms_rad})
      values.push_back(value);
  }
  return torch::tensor(values, torch::kFloat64);
}

std::vector<EpochRecord> records_of(const torch::Tensor& tensor) {
  const auto* v = tensor.data_ptr<double>();
  std::vector<EpochRecord> epochs(static_cast<std::size_t>(tensor.numel() / kRecordValues));
  for (EpochRecord& of : epochs) {
    of = {v[0], {v[2], v[3], v[4], v[5], v[6], v[7]}, v[1]};
    v += kRecordValues;
  }
  return epochs;
}

}  // namespace

Trainer::Trainer(const NetworkPlan& plan, const TrainingSet& set, std::vector<std::size_t> shown, std::vector<std::size_t> held_out,
                 const TrainingOptions& options)
    : state_(std::make_unique<State>(plan, set, std::move(shown), std::move(held_out), options)) {}
Trainer::~Trainer() = default;

Status Trainer::initialize(const OnnxModel& model) { return initialize_trunk(model, &state_->network); }
const std::vector<EpochRecord>& Trainer::epochs() const { return state_->epochs; }
std::optional<std::size_t> Trainer::best_epoch() const { return state_->best_epoch; }
OnnxModel Trainer::best_model() { return to_onnx(state_->best, state_->scale); }

std::vector<float> Trainer::best_output(std::span<const float> input) {
  const torch::NoGradGuard no_gradients;
  const LayerShape& in = state_->best->plan().input;
  torch::Tensor image = torch::empty({1, in.channels, in.height, in.width});
  std::copy(input.begin(), input.end(), image.data_ptr<float>());
  const torch::Tensor output = state_->best->forward(image).back().contiguous();
  std::vector<float> values(output.data_ptr<float>(), output.data_ptr<float>() + output.numel());
  for (int axis = 0; axis < 3; ++axis) {
    float& value = values[static_cast<std::size_t>(axis)];
    value = static_cast<float>(value * state_->scale.deviation_m + state_->scale.mean_m[axis]);
  }
  return values;
}

Status Trainer::run(const std::string& checkpoint, WorkObserver* observer) {
  State& my = *state_;
  const auto num_batches =
      (my.shown.size() + static_cast<std::size_t>(my.options.batch_size) - 1) / static_cast<std::size_t>(my.options.batch_size);
  const std::uint64_t total = num_batches * static_cast<std::uint64_t>(my.options.num_epochs);
  std::string note;
  while (static_cast<int>(my.epochs.size()) < my.options.num_epochs) {
    const std::size_t epoch = my.epochs.size();
    const auto start = std::chrono::steady_clock::now();
    std::mt19937_64 random = my.generator(epoch);
    torch::manual_seed(mix_bits(my.options.seed + epoch) >> 1);
    for (auto& group : my.optimizer->param_groups()) group.options().set_lr(my.learning_rate(epoch));
    std::vector<std::size_t> order = my.shown;
    for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random() % i]);
    my.set_training();
    double sum = 0;
    for (std::size_t batch = 0; batch < num_batches; ++batch) {
      if (!observer->on_progress("batch", epoch * num_batches + batch, total, note)) return Status::ok();
      const std::size_t first = batch * static_cast<std::size_t>(my.options.batch_size);
      const std::size_t count = std::min(order.size() - first, static_cast<std::size_t>(my.options.batch_size));
      if (count < 2 && num_batches > 1) continue;  // norms need two
      const Batch drawn = my.draw(std::span(order).subspan(first, count), my.options.augmentation, &random);
      my.optimizer->zero_grad();
      const torch::Tensor loss = my.loss_of(my.network->forward(drawn.images), drawn);
      loss.backward();
      my.optimizer->step();
      sum += loss.item<double>() / static_cast<double>(num_batches);
    }
    if (!std::isfinite(sum))
      return {ErrorCode::kInvalid,
              "the loss is no number any more after " + std::to_string(epoch + 1) + " epochs; try a smaller --learning-rate"};
    const HeldOutError error = my.evaluate();
    my.epochs.push_back({sum, error, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count()});
    if (!my.best_epoch || my.badness(error) < my.badness(my.epochs[*my.best_epoch].held_out)) my.keep_as_best();
    note = tools::text_of("epoch %zu: loss %.3f, held out %.2f m %.1f deg", epoch + 1, sum, error.median_m, error.median_deg);
    if (Status status = save(checkpoint); !status) return status;
  }
  observer->show("", 0, 0, "");
  return Status::ok();
}

Status Trainer::save(const std::string& path) const {
  const State& my = *state_;
  torch::serialize::OutputArchive archive, optimizer;
  for (const auto& [name, network] : {std::pair{"network", &my.network}, {"best", &my.best}}) {
    torch::serialize::OutputArchive part;
    (*network)->save(part);
    archive.write(name, part);
  }
  my.optimizer->save(optimizer);
  archive.write("optimizer", optimizer);
  archive.write("log_position", my.log_position);
  archive.write("log_rotation", my.log_rotation);
  archive.write("identity", torch::tensor(my.identity(), torch::kFloat64));
  archive.write("epochs", tensor_of(my.epochs));
  archive.write("best_epoch", torch::tensor(static_cast<std::int64_t>(my.best_epoch.value_or(0))));
  std::ostringstream bytes;
  archive.save_to(bytes);
  return replace_file(path, bytes.view());
}

Status Trainer::resume(const std::string& path) {
  State& my = *state_;
  std::vector<std::uint8_t> bytes;
  if (Status status = read_file_bytes(path, kMaxCheckpointBytes, &bytes); !status) return status;
  try {
    const torch::NoGradGuard no_gradients;
    torch::serialize::InputArchive archive;
    archive.load_from(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    torch::Tensor identity, epochs, best_epoch, log_position, log_rotation;
    archive.read("identity", identity);
    if (!torch::equal(identity, torch::tensor(my.identity(), torch::kFloat64)))
      return {ErrorCode::kInvalid,
              path + " belongs to another training: other frames or other options; give the same ones or leave --resume out"};
    for (const auto& [name, network] : {std::pair{"network", &my.network}, {"best", &my.best}}) {
      torch::serialize::InputArchive part;
      archive.read(name, part);
      (*network)->load(part);
    }
    torch::serialize::InputArchive optimizer;
    archive.read("optimizer", optimizer);
    my.optimizer->load(optimizer);
    archive.read("log_position", log_position);
    archive.read("log_rotation", log_rotation);
    my.log_position.copy_(log_position);
    my.log_rotation.copy_(log_rotation);
    archive.read("epochs", epochs);
    archive.read("best_epoch", best_epoch);
    my.epochs = records_of(epochs);
    if (!my.epochs.empty()) my.best_epoch = static_cast<std::size_t>(best_epoch.item<std::int64_t>());
    my.best->eval();
  } catch (const std::exception&) { return {ErrorCode::kCorrupt, path + " is no checkpoint of a training, or a damaged one"}; }
  return Status::ok();
}

}  // namespace camloc::training
