#include "tools/lab/studies/shard.hpp"

#include <gtest/gtest.h>

#include <map>
#include <stdexcept>

#include "tools/lab/studies/study_scheduler.hpp"

namespace palpate::studies {
namespace {

std::vector<Task> some_tasks(int count) {
  std::vector<Task> tasks;
  for (int i = 0; i < count; ++i) tasks.push_back({"task " + std::to_string(i), {}, {}, ""});
  return tasks;
}

TEST(Shard, AllTogetherHoldEachTaskOnce) {
  const std::vector<Task> tasks = some_tasks(23);
  for (const std::size_t count : {1u, 2u, 5u, 23u, 40u}) {
    std::map<std::string, int> seen;
    std::size_t fewest = tasks.size(), most = 0;
    for (std::size_t index = 1; index <= count; ++index) {
      const std::vector<Task> part = shard_of(tasks, {index, count});
      for (const Task& task : part) ++seen[task.name];
      fewest = std::min(fewest, part.size());
      most = std::max(most, part.size());
    }
    EXPECT_EQ(seen.size(), tasks.size()) << count;
    for (const auto& [name, times] : seen) EXPECT_EQ(times, 1) << name;
    EXPECT_LE(most - fewest, 1u) << count;
  }
}

TEST(Shard, IsReadAsOneNumberOfAnother) {
  const Shard shard = read_shard("3/16");
  EXPECT_EQ(shard.index, 3u);
  EXPECT_EQ(shard.count, 16u);
  for (const char* wrong : {"", "3", "/", "0/4", "5/4", "-1/4", "1/0", "1/4x", "a/b", "1 of 4"})
    EXPECT_THROW(read_shard(wrong), std::invalid_argument) << wrong;
}

}  // namespace
}  // namespace palpate::studies
