// Damaged model files and cards: each is rejected with a reason that names the file, or is intact
// in everything that matters; none ends, blocks or bloats the program.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iostream>
#include <sstream>

#include "rt/inference/model_file.hpp"
#include "rt/loop/sanitizer.hpp"
#include "tests/fuzz/mutation.hpp"

namespace palpate::inference {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

const long kRounds = fuzz::setting("PALPATE_FUZZ_ROUNDS", 1000);
const auto kSeed = static_cast<std::uint64_t>(fuzz::setting("PALPATE_FUZZ_SEED", 1));
/// A file that libtorch itself reads costs far more than one rejected by its hash.
const long kVouchedRounds = std::max(1L, kRounds / 20);

/// 0 in builds with a sanitizer, which delays the release of freed memory.
long resident_kilobytes() {
  if (loop::kSanitized) return 0;
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss;
}

std::string read(const std::string& path) {
  std::ostringstream bytes;
  bytes << std::ifstream(path, std::ios::binary).rdbuf();
  return bytes.str();
}

void write(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

class DamagedModel : public ::testing::Test {
 protected:
  DamagedModel()
      : folder_(fs::temp_directory_path() / ("palpate-fuzz-" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
    path_ = (folder_ / "sample.pt").string();
    sensing::RecurrentWeights weights = sensing::RecurrentWeights::zero(6, 2, {15, 10});
    weights.layers[0].input.setConstant(0.1f);
    weights.linear.setConstant(0.2f);
    ModelCard card;
    card.name = "sample";
    card.rate = 100;
    for (int i = 0; i < 6; ++i) card.inputs.push_back({"e" + std::to_string(i), "count"});
    card.outputs = {{"fx", "N"}, {"tx", "N m"}};
    card.training["errors"] = std::vector<double>{0.1, 0.2};
    write_model_file(path_, weights, card);
    bytes_ = read(path_);
    card_ = read(card_path(path_));
    whole_ = read_model_file(path_).card;
  }
  ~DamagedModel() override { fs::remove_all(folder_); }

  std::string complaint() {
    try {
      read_model_file(path_);
    } catch (const ModelError& error) {
      return error.what();
    }
    return "";
  }

  /// Error text for a module whose card has the matching hash.
  std::string complaint_of_vouched(const std::string& bytes) {
    ModelFile file{path_, bytes, whole_};
    file.card.sha256 = sha256_of(bytes);
    try {
      make_executor(file, ExecutorKind::kTorch);
    } catch (const ModelError& error) {
      return error.what();
    }
    return "";
  }

  fs::path folder_;
  std::string path_, bytes_, card_;
  ModelCard whole_;
};

TEST_F(DamagedModel, IsAlwaysCaughtByItsHash) {
  for (long round = 0; round < kRounds; ++round) {
    write(path_, fuzz::damaged(bytes_, kSeed * 1000003 + static_cast<std::uint64_t>(round)));
    const std::string error = complaint();
    ASSERT_THAT(error, HasSubstr(path_ + ": its SHA-256 is")) << "round " << round;
    ASSERT_THAT(error, HasSubstr("the file is damaged or not the card's"));
  }
}

TEST_F(DamagedModel, ADamagedCardIsRefusedByNameOrStillOfTheSameModule) {
  const long before = resident_kilobytes();
  long refused = 0;
  for (long round = 0; round < kRounds; ++round) {
    write(card_path(path_),
          fuzz::damaged(card_, kSeed * 7000003 + static_cast<std::uint64_t>(round)));
    const std::string error = complaint();
    if (error.empty()) {
      const ModelSizes sizes = read_model_file(path_).card.sizes();
      ASSERT_LE(sizes.inputs, 256);
      ASSERT_LE(sizes.outputs, 64);
    } else {
      ASSERT_THAT(error, HasSubstr("sample.yaml")) << "round " << round;
      ASSERT_GT(error.size(), card_path(path_).size() + 4) << "no reason: " << error;
      ++refused;
    }
  }
  EXPECT_GT(refused, kRounds / 2);
  EXPECT_LT(refused, kRounds) << "damage to the notes of the training is no reason";
  EXPECT_LT(resident_kilobytes() - before, 64 * 1024) << "kB";
}

/// Seeds of the damaged modules that crash libtorch, or on which it does not terminate, each tested
/// in a child process that may end.
std::vector<std::uint64_t> find_deadly(const std::string& bytes, const ModelSizes& sizes) {
  std::vector<std::uint64_t> deadly;
  for (long next = 0; next < kVouchedRounds;) {
    int ends[2];
    if (pipe(ends) != 0) throw std::runtime_error("no pipe");
    const pid_t child = fork();
    if (child == 0) {
      const rlimit none{0, 0};
      setrlimit(RLIMIT_CORE, &none);
      const rlimit memory{std::size_t{6} << 30, std::size_t{6} << 30};
      setrlimit(RLIMIT_AS, &memory);
      for (long round = next; round < kVouchedRounds; ++round) {
        alarm(5);
        try {
          load_torch_module(fuzz::damaged(bytes, kSeed * 13 + static_cast<std::uint64_t>(round)),
                            sizes);
        } catch (const std::exception&) {
        }
        if (::write(ends[1], "", 1) != 1) _exit(1);
      }
      _exit(0);
    }
    close(ends[1]);
    char done = 0;
    while (::read(ends[0], &done, 1) == 1) ++next;
    close(ends[0]);
    int status = 0;
    waitpid(child, &status, 0);
    if (WIFEXITED(status) && WEXITSTATUS(status) == 0) break;
    deadly.push_back(kSeed * 13 + static_cast<std::uint64_t>(next++));
  }
  return deadly;
}

TEST_F(DamagedModel, WhatKillsLibtorchIsRefusedWhereItsCardVouchesForIt) {
  if (loop::kSanitized) GTEST_SKIP() << "reports what libtorch does, and maps above the limit";
  torch_version();  // loaded once, before the children
  std::vector<std::uint64_t> deadly = find_deadly(bytes_, whole_.sizes());
  std::cout << deadly.size() << " of " << kVouchedRounds << " damaged modules kill libtorch\n";
  deadly.push_back(358);  // which libtorch 1.13 reads endlessly
  for (const std::uint64_t seed : deadly) {
    const std::string error = complaint_of_vouched(fuzz::damaged(bytes_, seed));
    EXPECT_THAT(error, HasSubstr(path_)) << seed;
    EXPECT_THAT(error, HasSubstr("libtorch")) << seed;
    std::cout << seed << ": " << error << "\n";
  }
  // It is valid, and so is the undamaged one.
  EXPECT_EQ(complaint_of_vouched(bytes_), "");
}

}  // namespace
}  // namespace palpate::inference
