#pragma once

#include "tools/recordings/recording_table.hpp"

namespace palpate::recordings {

/// Whether a file is an LCM event log by its content: it begins with the sync word of an event.
/// False for one that cannot be read.
bool is_log(const std::string& path);

/// Reads columns named CHANNEL.field or CHANNEL.field[index] of an LCM event log, such as
/// BIOTAC_0.electrodes[3], FT_WRENCH.wrench[0] or ROBOT_STATE.twist[5]; channels of another arm
/// have its suffix. Each message on the channel of the first column gives a row, with the latest
/// values of every other channel; a gap of more than a second starts a new recording. `time`:
/// "sent" for the senders' time, "received" for that of the log. Throws std::runtime_error naming
/// file and column: another time or form of name, an unknown channel, field or index, a channel
/// missing in the log, a number that is not finite, decreasing time, a recording of fewer than two
/// rows.
std::vector<Table> read_log_tables(const std::string& path, const std::string& time,
                                   const std::vector<std::string>& columns);

}  // namespace palpate::recordings
