#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace palpate::exporting {

/// A field of one of Foxglove's messages. Numbers in Protobuf follow the order, from 1.
struct FoxgloveField {
  enum class Kind { kDouble, kFixed32, kFlag, kText, kBytes, kTime, kDuration, kChoice, kMessage };
  const char* name;
  Kind kind;
  const char* message = nullptr;  // of kMessage: its name
  bool is_list = false;
};

/// One of Foxglove's messages that palpate writes, or a part of one.
struct FoxgloveMessage {
  const char* name;  // without "foxglove."
  std::vector<FoxgloveField> fields;
  const char* choice = nullptr;       // name of the enumeration of its field kChoice
  std::vector<const char*> values{};  // of that, numbered from 0
};

/// All of them, parts before wholes.
const std::vector<FoxgloveMessage>& foxglove_messages();

/// JSON schema of one of them by its full name, foxglove.X, as foxglove.hpp writes it. Throws
/// std::invalid_argument if there is none.
nlohmann::ordered_json foxglove_schema(const std::string& name);

}  // namespace palpate::exporting
