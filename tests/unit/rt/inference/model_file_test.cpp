#ifndef PALPATE_WITHOUT_TORCH

#include "rt/inference/model_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>

#include "rt/config/node.hpp"
#include "rt/inference/compiled_executor.hpp"

namespace palpate::inference {
namespace {

using ::testing::HasSubstr;

sensing::RecurrentWeights random_weights(unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<float> normal(0, 0.3f);
  const auto fill = [&](auto& part) {
    for (Eigen::Index i = 0; i < part.size(); ++i) part.data()[i] = normal(random);
  };
  sensing::RecurrentWeights w = sensing::RecurrentWeights::zero(6, 2, {15, 10});
  w.unit_mask << 1, 1, 1, 0, 0, 0;
  fill(w.input_mean);
  w.input_deviation.array() = 3;
  for (sensing::LstmWeights& layer : w.layers) {
    fill(layer.input);
    fill(layer.hidden);
    fill(layer.bias);
  }
  fill(w.dense);
  fill(w.linear);
  fill(w.offset);
  w.output_deviation << 0.5f, 20;
  return w;
}

ModelCard sample_card() {
  ModelCard card;
  card.name = "sample";
  card.rate = 100;
  card.average = 0.1;
  for (int i = 0; i < 6; ++i) card.inputs.push_back({"e" + std::to_string(i), "count"});
  card.outputs = {{"fx", "N"}, {"tx", "N m"}};
  card.payload = sensing::PayloadParameters{};
  card.payload->mass = 1.15;
  card.payload->first_moment = {0, 0.01, 0.12};
  const auto places = static_cast<Eigen::Index>(card.inputs.size());
  card.domain.deviation = Eigen::VectorXd::LinSpaced(places, 1, 2);
  card.domain.points = Eigen::MatrixXd::Identity(places, 3) / 3;
  card.domain.near = 1.5;
  card.domain.far = 3;
  card.delays = {{"inertial", 0.004}};
  card.training["seed"] = 7;
  return card;
}

std::string read(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  std::ostringstream bytes;
  bytes << stream.rdbuf();
  return bytes.str();
}

void write(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

class ModelFileTest : public ::testing::Test {
 protected:
  ModelFileTest()
      : folder_(std::filesystem::temp_directory_path() /
                ("palpate-model-" + std::to_string(getpid()))) {
    std::filesystem::create_directories(folder_);
    path_ = (folder_ / "sample.pt").string();
    write_model_file(path_, random_weights(1), sample_card());
    bytes_ = read(path_);
    card_ = read(card_path(path_));
  }
  ~ModelFileTest() override { std::filesystem::remove_all(folder_); }

  /// Puts `bytes` in place of the module, with a card that contains their hash.
  void vouch(const std::string& bytes, ModelCard card) {
    write(path_, bytes);
    card.sha256 = sha256_of(bytes);
    write_card(card, card_path(path_));
  }

  /// Error text when the file is read and made into an executor of both kinds; "" if it is
  /// accepted.
  std::string complaint(ExecutorKind kind = ExecutorKind::kTorch) {
    try {
      make_executor(read_model_file(path_), kind);
    } catch (const ModelError& error) {
      return error.what();
    }
    return "";
  }

  std::filesystem::path folder_;
  std::string path_, bytes_, card_;
};

TEST_F(ModelFileTest, ComesBackAsItWasWritten) {
  const ModelFile file = read_model_file(path_);
  EXPECT_EQ(file.card.name, "sample");
  EXPECT_EQ(file.card.architecture, kRecurrentNetwork);
  EXPECT_EQ(file.card.states, 50);
  EXPECT_EQ(file.card.average, 0.1);
  EXPECT_EQ(file.card.inputs.size(), 6u);
  EXPECT_EQ(file.card.outputs[1].unit, "N m");
  EXPECT_EQ(file.card.payload->mass, 1.15);
  EXPECT_EQ(file.card.domain.near, 1.5);
  EXPECT_EQ(file.card.domain.far, 3);
  EXPECT_EQ(file.card.domain.points.cols(), 3);
  EXPECT_TRUE(
      file.card.domain.points.isApprox(Eigen::MatrixXd::Identity(file.card.sizes().inputs, 3) / 3));
  EXPECT_EQ(file.card.delays[0].stream, "inertial");
  EXPECT_EQ(file.card.training["seed"].as<int>(), 7);
  const sensing::RecurrentWeights weights = read_recurrent_weights(file.bytes);
  EXPECT_EQ(weights.layers[1].hidden, random_weights(1).layers[1].hidden);
  EXPECT_EQ(weights.linear, random_weights(1).linear);
}

TEST_F(ModelFileTest, BothExecutorsGiveTheSameNumbers) {
  const ModelFile file = read_model_file(path_);
  TorchExecutorOptions options;
  options.wait = 10;
  options.patience = 50;
  const auto torch = make_executor(file, ExecutorKind::kTorch, options);
  const auto compiled = make_executor(file, ExecutorKind::kCompiled);
  EXPECT_STREQ(torch->kind(), "torch");
  EXPECT_STREQ(compiled->kind(), "compiled");
  std::mt19937 random(2);
  std::normal_distribution<float> normal(0, 6);
  std::vector<float> x(6), a(2), b(2);
  for (int k = 0; k < 100; ++k) {
    for (float& v : x) v = normal(random);
    ASSERT_EQ(torch->step(x.data(), a.data()), Answer::kFresh);
    ASSERT_EQ(compiled->step(x.data(), b.data()), Answer::kFresh);
    EXPECT_NEAR(a[0], b[0], 1e-5 * 0.5);
    EXPECT_NEAR(a[1], b[1], 1e-5 * 20);
  }
}

TEST_F(ModelFileTest, AgreementIsReallyMeasured) {
  sensing::RecurrentWeights other = random_weights(1);
  other.layers[0].bias[3] += 1e-3f;
  CompiledModel compiled(other);
  const auto torch = make_torch_model(read_model_file(path_));
  EXPECT_GT(largest_difference(compiled, *torch), kAgreement);
}

TEST_F(ModelFileTest, FlippedBitsAreRefusedBeforeLibtorchSeesThem) {
  std::mt19937 random(11);
  for (int trial = 0; trial < 150; ++trial) {
    const bool in_card = trial % 3 == 0;
    std::string damaged = in_card ? card_ : bytes_;
    damaged[random() % damaged.size()] ^= static_cast<char>(1u << random() % 8);
    write(in_card ? card_path(path_) : path_, damaged);
    if (in_card) {
      // A card may contain other well-formed values; the only error must be a ModelError.
      complaint();
    } else {
      EXPECT_THAT(complaint(), HasSubstr("SHA-256")) << trial;
    }
    write(path_, bytes_);
    write(card_path(path_), card_);
  }
  EXPECT_EQ(complaint(), "");
}

TEST_F(ModelFileTest, TruncatedAndEmptyFilesAreRefused) {
  for (const std::size_t size :
       {std::size_t{0}, std::size_t{1}, bytes_.size() / 2, bytes_.size() - 1}) {
    write(path_, bytes_.substr(0, size));
    EXPECT_THAT(complaint(), HasSubstr("SHA-256"));
    if (size % 2 == 1) continue;  // libtorch takes its time
    ModelCard card = sample_card();
    card.architecture = kRecurrentNetwork;
    card.states = 50;
    vouch(bytes_.substr(0, size), card);
    EXPECT_THAT(complaint(), HasSubstr("libtorch cannot read it"));
    write(card_path(path_), card_);
  }
  write(path_, bytes_);
  write(card_path(path_), card_.substr(0, card_.size() / 3));
  EXPECT_NE(complaint(), "");
}

TEST_F(ModelFileTest, HugeFilesAreRefusedUnread) {
  std::filesystem::resize_file(path_, kLargestModule + 1);  // sparse
  EXPECT_THAT(complaint(), HasSubstr("allowed: at most 67108864"));
}

TEST_F(ModelFileTest, AbsentFilesAreNamed) {
  std::filesystem::remove(card_path(path_));
  EXPECT_THAT(complaint(), HasSubstr("sample.yaml: is not a file"));
  std::filesystem::remove(path_);
  EXPECT_THAT(complaint(), HasSubstr("sample.pt: is not a file"));
}

TEST_F(ModelFileTest, WhatIsNoFileIsNamed) {
  std::filesystem::remove(path_);
  std::filesystem::create_directory(path_);
  EXPECT_THAT(complaint(), HasSubstr("sample.pt: is not a file"));
  std::filesystem::remove(path_);
  ASSERT_EQ(mkfifo(path_.c_str(), 0600), 0);
  EXPECT_THAT(complaint(), HasSubstr("sample.pt: is not a file"));
  std::filesystem::remove(path_);
  write(path_, bytes_);
  std::filesystem::permissions(path_, std::filesystem::perms::none);
  if (geteuid() != 0) {
    EXPECT_THAT(complaint(), HasSubstr("sample.pt: cannot be read"));
  }
  std::filesystem::permissions(path_, std::filesystem::perms::owner_all);
  std::filesystem::remove(card_path(path_));
  std::filesystem::create_directory(card_path(path_));
  EXPECT_THAT(complaint(), HasSubstr("sample.yaml: is not a file"));
}

TEST_F(ModelFileTest, CardsThatGrowAreRefusedBeforeTheyDo) {
  // Ten aliases on each of twelve lines expand to 10^12 texts.
  std::string bomb = "training:\n  a0: &a0 lol\n";
  for (int i = 1; i <= 12; ++i) {
    const std::string below = "*a" + std::to_string(i - 1);
    bomb += "  a" + std::to_string(i) + ": &a" + std::to_string(i) + " [" + below;
    for (int k = 1; k < 10; ++k) bomb += ", " + below;
    bomb += "]\n";
  }
  const auto said = [&](const std::string& text) {
    write(card_path(path_), text);
    return complaint();
  };
  EXPECT_THAT(said(bomb), HasSubstr("sample.yaml:3: the card has an alias"));
  EXPECT_THAT(said("training: " + std::string(30, '[') + std::string(30, ']')),
              HasSubstr("sample.yaml:1: the card is nested more than 20 deep"));
  EXPECT_THAT(said("training: " + std::string(100000, '[')), HasSubstr("sample.yaml:1: "));
  EXPECT_THAT(said("training: " + std::string(100000, '{')), HasSubstr("sample.yaml:1: "));
  EXPECT_THAT(said(std::string(100000, '-')), HasSubstr("sample.yaml"));
  std::string many = "training: [0";
  for (int i = 0; i < 200000; ++i) many += ",0";
  EXPECT_THAT(said(many + "]"), HasSubstr("the card has more than 100000 items"));
  EXPECT_THAT(said(std::string((1 << 20) + 1, '#')), HasSubstr("has more than 1048576 bytes"));
  EXPECT_THAT(said(""), HasSubstr("format: is missing"));
  EXPECT_THAT(said("- a\n- b\n"), HasSubstr("not a mapping"));
  EXPECT_THAT(said(card_ + "---\nmore: 1\n"), HasSubstr("more than one YAML document"));
}

TEST_F(ModelFileTest, WrongSizesAreRefused) {
  ModelCard card = read_model_file(path_).card;
  card.inputs.pop_back();
  card.domain = {};
  vouch(bytes_, card);
  EXPECT_THAT(complaint(), HasSubstr("fails"));
  EXPECT_THAT(complaint(ExecutorKind::kCompiled), HasSubstr("forward(x[1, 5], state[1, 50])"));
  card = sample_card();
  card.outputs.push_back({"more", "N"});
  card.states = 50;
  card.architecture = kRecurrentNetwork;
  vouch(bytes_, card);
  EXPECT_THAT(complaint(), HasSubstr("y is Float[1, 2], must be Float[1, 3]"));
}

TEST_F(ModelFileTest, WeightsThatAreNotFiniteAreRefused) {
  // write_torch_module rejects them, so a weight is changed to NaN in the file itself, which stores
  // tensors uncompressed.
  const sensing::RecurrentWeights weights = random_weights(1);
  const float value = weights.layers[0].bias[5];
  const std::string needle(reinterpret_cast<const char*>(&value), sizeof(value));
  const float nan = std::nanf("");
  std::string spoilt = bytes_;
  const std::size_t place = spoilt.find(needle);
  ASSERT_NE(place, std::string::npos);
  spoilt.replace(place, sizeof(nan), reinterpret_cast<const char*>(&nan), sizeof(nan));
  vouch(spoilt, read_model_file(path_).card);
  EXPECT_NE(complaint(ExecutorKind::kTorch), "");
  EXPECT_NE(complaint(ExecutorKind::kCompiled), "");
}

TEST_F(ModelFileTest, AnUnknownArchitectureRunsInLibtorchOnly) {
  ModelCard card = read_model_file(path_).card;
  card.architecture = "mine";
  vouch(bytes_, card);
  EXPECT_EQ(complaint(ExecutorKind::kTorch), "");
  EXPECT_THAT(complaint(ExecutorKind::kCompiled), HasSubstr("runs with `executor: torch` only"));
}

TEST_F(ModelFileTest, CardsAreReadStrictly) {
  const auto said = [&](const std::string& from, const std::string& to) -> std::string {
    std::string text = card_;
    const std::size_t place = text.find(from);
    EXPECT_NE(place, std::string::npos) << from;
    write(card_path(path_), text.replace(place, from.size(), to));
    return complaint();
  };
  EXPECT_THAT(said("format: 1", "format: 2"), HasSubstr("this version reads 1"));
  EXPECT_THAT(said("rate: 100", "rate: -1"), HasSubstr("rate"));
  EXPECT_THAT(said("states: 50", "states: 100000"), HasSubstr("states"));
  EXPECT_THAT(said("name: e1", "name: e0"), HasSubstr("'e0' comes twice"));
  EXPECT_THAT(said("average", "averag"), HasSubstr("is not a key of a model card"));
  EXPECT_THAT(said("sha256: ", "sha256: 0"), HasSubstr("64 digits"));
  EXPECT_THAT(said("states: 50", "states: 2147483648"), HasSubstr("states"));
  EXPECT_THAT(said("states: 50", "states: fifty"), HasSubstr("is not a whole number"));
  EXPECT_THAT(said("rate: 100", "rate: .nan"), HasSubstr("is not a finite number"));
  EXPECT_THAT(said("rate: 100\n", ""), HasSubstr("rate: is missing"));
  EXPECT_THAT(said("inputs:", "inputs: 7\nignored:"), HasSubstr("ignored"));
  EXPECT_THAT(said("seed: 7", "seed: *other"), HasSubstr("anchor is not defined"));
}

}  // namespace
}  // namespace palpate::inference

#endif
