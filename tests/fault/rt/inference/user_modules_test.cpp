// Modules supplied by users: other networks than palpate's run unchanged, and defects of a module
// are reported at configuration.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "rt/inference/model_file.hpp"
#include "tests/support/torch_script/torch_script.hpp"

namespace palpate::inference {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using torch_script::forward;
using torch_script::Tensor;

class UserModule : public ::testing::Test {
 protected:
  UserModule()
      : folder_(fs::temp_directory_path() / ("palpate-users-" + std::to_string(getpid()))),
        path_((folder_ / "mine.pt").string()) {
    fs::create_directories(folder_);
    card_.name = "mine";
    card_.rate = 100;
    card_.states = 2;
    card_.inputs = {{"a", "N"}, {"b", "N"}, {"c", "N"}};
    card_.outputs = {{"fx", "N"}, {"fy", "N"}};
  }
  ~UserModule() override { fs::remove_all(folder_); }

  std::unique_ptr<Executor> make(const std::string& bytes,
                                 ExecutorKind kind = ExecutorKind::kTorch) {
    torch_script::write(path_, bytes, card_);
    TorchExecutorOptions options;
    options.wait = options.patience = 10;
    return make_executor(read_model_file(path_), kind, options);
  }

  std::string complaint(const std::string& source, ExecutorKind kind = ExecutorKind::kTorch) {
    try {
      make(torch_script::module(source), kind);
    } catch (const ModelError& error) {
      EXPECT_THAT(error.what(), HasSubstr(path_));
      return error.what();
    }
    return "";
  }

  fs::path folder_;
  std::string path_;
  ModelCard card_;
};

TEST_F(UserModule, APerceptronWithoutMemoryRuns) {
  const auto executor =
      make(torch_script::module(forward("return torch.relu(x).matmul(self.w.t()) + self.b, state"),
                                {{"w", {2, 3}, {1, 2, 3, -1, 0, 0.5f}}, {"b", {2}, {10, 20}}}));
  EXPECT_STREQ(executor->kind(), "torch");
  const float input[3] = {1, -5, 2};
  float output[2] = {};
  for (int k = 0; k < 3; ++k) {
    ASSERT_EQ(executor->step(input, output), Answer::kFresh);
    EXPECT_FLOAT_EQ(output[0], 1 + 6 + 10);
    EXPECT_FLOAT_EQ(output[1], -1 + 1 + 20);
  }
}

TEST_F(UserModule, AGatedRecurrentUnitCarriesItsState) {
  const auto executor = make(torch_script::module(
      forward("h = torch.gru_cell(x, state, self.w, self.u, None, None)\n"
              "return h, h"),
      {{"w", {6, 3}, std::vector<float>(18, 0.1f)}, {"u", {6, 2}, std::vector<float>(12, 0.2f)}}));
  const float input[3] = {1, 2, 3};
  float output[2] = {};
  // Cho et al. 2014: with all rows of the weights equal, both cells are equal.
  double h = 0;
  for (int k = 0; k < 5; ++k) {
    ASSERT_EQ(executor->step(input, output), Answer::kFresh);
    const double gate = 1 / (1 + std::exp(-(0.6 + 0.4 * h)));  // reset and update gate
    const double candidate = std::tanh(0.6 + gate * 0.4 * h);
    h = (1 - gate) * candidate + gate * h;
    EXPECT_NEAR(output[0], h, 1e-6);
    EXPECT_NEAR(output[1], h, 1e-6);
  }
}

TEST_F(UserModule, RunsInLibtorchOnly) {
  EXPECT_THAT(complaint(forward("return x[:, 0:2], state"), ExecutorKind::kCompiled),
              HasSubstr("architecture 'user' runs with `executor: torch` only"));
}

TEST_F(UserModule, CallingItselfPalpatesItHasNotItsParameters) {
  torch_script::write(path_, torch_script::module(forward("return x[:, 0:2], state")), card_);
  ModelFile file = read_model_file(path_);
  file.card.architecture = kRecurrentNetwork;
  try {
    make_executor(file, ExecutorKind::kCompiled);
    FAIL();
  } catch (const ModelError& error) {
    EXPECT_THAT(error.what(), HasSubstr("it has no parameter 'unit_mask'"));
  }
}

TEST_F(UserModule, WrongSignaturesAreNamed) {
  EXPECT_THAT(complaint("def run(self, x: Tensor) -> Tensor:\n    return x\n"),
              HasSubstr("no method forward(x, state)"));
  EXPECT_THAT(complaint("def forward(self, x: Tensor) -> Tensor:\n    return x\n"),
              HasSubstr("must take two arguments, (x, state), not 1"));
  EXPECT_THAT(complaint("def forward(self, x: Tensor, s: Tensor) -> Tensor:\n    return x\n"),
              HasSubstr("must return (y, next_state)"));
  EXPECT_THAT(complaint(forward("return x, state")),
              HasSubstr("y is Float[1, 3], must be Float[1, 2]"));
  EXPECT_THAT(complaint(forward("return x[:, 0:2].double(), state")),
              HasSubstr("y is Double[1, 2], must be Float[1, 2]"));
}

TEST_F(UserModule, AnEndlessLoopIsRefused) {
  EXPECT_THAT(
      complaint(forward("while bool(x.sum() < 1):\n    x = x - 1\nreturn x[:, 0:2], state")),
      ::testing::ContainsRegex("libtorch .* within [0-9]+"));
}

TEST_F(UserModule, WhatFailsOrFillsTheMemoryIsRefused) {
  EXPECT_THAT(
      complaint(forward("assert bool(x.sum() > 1), \"not today\"\nreturn x[:, 0:2], state")),
      HasSubstr("not today"));
  EXPECT_THAT(complaint(forward("big = torch.zeros([1 << 20, 1 << 20])\n"
                                "return x[:, 0:2] + big[0, 0:2], state")),
              HasSubstr("fails"));
  EXPECT_THAT(complaint(forward("return x[:, 0:2] / 0, state")), HasSubstr("not finite"));
  // With the size of the state; zeros would be sufficient.
  EXPECT_THAT(complaint(forward("return x[:, 0:2] + torch.exp(state * 10), state + 1")),
              HasSubstr("on zeros fails or gives a number that is not finite"));
  EXPECT_THAT(complaint(forward("return torch.rand([1, 2]), state")), HasSubstr("differently"));
}

TEST_F(UserModule, SizesBeyondReasonAreRefusedByTheCard) {
  const std::string bytes = torch_script::module(forward("return x[:, 0:2], state"));
  card_.states = 2'000'000'000;
  torch_script::write(path_, bytes, card_);
  try {
    read_model_file(path_);
    FAIL();
  } catch (const ModelError& error) {
    EXPECT_THAT(error.what(),
                HasSubstr("states: '2000000000' is out of range; allowed: 0 to 8192"));
  }
}

TEST_F(UserModule, AnArchiveThatLiesOnSizesIsRefused) {
  std::string bytes =
      torch_script::module(forward("return x[:, 0:2] + self.w, state"), {{"w", {1, 2}, {1, 2}}});
  ASSERT_NO_THROW(make(bytes));
  // In each entry of the archive's directory: sizes as stored and as unpacked.
  int entries = 0;
  for (std::size_t place = 0; (place = bytes.find("PK\x01\x02", place)) != std::string::npos;
       ++place) {
    bytes.replace(place + 20, 8, "\xf0\xff\xff\x7f\xf0\xff\xff\x7f", 8);
    ++entries;
  }
  ASSERT_GT(entries, 3);
  try {
    make(bytes);
    FAIL();
  } catch (const ModelError& error) {
    EXPECT_THAT(error.what(), HasSubstr(path_));
    EXPECT_THAT(error.what(), HasSubstr("libtorch"));
  }
}

}  // namespace
}  // namespace palpate::inference
