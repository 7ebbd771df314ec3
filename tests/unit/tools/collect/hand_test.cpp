// A hand that follows the presses.

#include "tools/collect/hand.hpp"

#include <gtest/gtest.h>

#include <palpate/hand_command_t.hpp>
#include <stdexcept>
#include <vector>

#include "tests/support/scratch_folder.hpp"

namespace palpate::collect {
namespace {

/// Commands received by a hand in one short trial, in which it sends nothing.
std::vector<hand_command_t> commands(const std::optional<bus::Key>& key) {
  const support::ScratchFolder folder;
  const auto hub = bus::make_memory_hub();
  const auto bus = bus::make_memory_bus(hub);
  std::vector<bus::Published> published;
  bus::record(*hub, &published);
  HandProtocol protocol;
  protocol.trials = 1;
  protocol.rest = protocol.hold = protocol.release = 0.01;
  EXPECT_THROW(collect_from_hand(*bus, protocol, "probe", folder.path() / "presses.log", key),
               std::runtime_error);
  bus::record(*hub, nullptr);
  std::vector<hand_command_t> heard;
  for (const bus::Published& p : published) {
    EXPECT_EQ(p.channel, "HAND_COMMAND");
    heard.emplace_back();
    heard.back().decode(p.data.data(), 0, static_cast<int>(p.data.size()));
  }
  return heard;
}

int obeyed(const std::vector<hand_command_t>& heard, const std::optional<bus::Key>& key) {
  bus::ReplayGuard admission("HAND_COMMAND", {key, 1});
  int count = 0;
  for (const hand_command_t& command : heard)
    count += admission.judge(command) == bus::Admitted::kFresh ? 1 : 0;
  return count;
}

TEST(CollectFromHand, AHandWithAKeyObeysWhoHasItAlone) {
  bus::Key key{}, other{};
  key[0] = 1, other[0] = 2;
  const std::vector<hand_command_t> sealed = commands(key), open = commands({});
  ASSERT_EQ(sealed.size(), 4u);  // open, hold, open, and open once more at the end
  EXPECT_EQ(sealed[1].action, hand_command_t::HOLD);
  EXPECT_EQ(sealed.back().action, hand_command_t::OPEN);
  EXPECT_EQ(obeyed(sealed, key), 4);
  EXPECT_EQ(obeyed(sealed, other), 0);
  EXPECT_EQ(obeyed(open, key), 0);
  EXPECT_EQ(obeyed(open, {}), 4);
}

}  // namespace
}  // namespace palpate::collect
