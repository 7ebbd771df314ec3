#pragma once

#include "rt/bus/message_bus.hpp"
#include "rt/config/node.hpp"

// Keys of the section `bus` that several programs read.

namespace palpate::config {

/// Mapping `channels: {FT_WRENCH: LEFT_FT}` of a section `bus`: palpate's name of a channel, with
/// the number of an arm or finger, and its name on the bus. Throws Error for a name that palpate
/// does not know, one that is no channel name, and one that another channel has.
bus::ChannelNames read_channel_names(const Node& bus);

/// `largest_message`: of those that are received in several fragments, bytes; 0: none. 65000 if
/// absent, which is all that a subscription takes. Throws Error.
int read_largest_message(const Node& bus);

}  // namespace palpate::config
