#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tools/export/output_file.hpp"

namespace palpate::exporting {

/// Compression of the chunks of an MCAP file.
enum class Compression { kNone, kLz4, kZstd };

/// Name in MCAP's registry: "", "lz4", "zstd".
const char* name_of(Compression compression);

/// A complete frame of the given kind. Throws std::runtime_error.
std::string compress(Compression compression, std::string_view bytes);

/// Encoding of the messages of a schema.
enum class MessageEncoding { kJson, kProtobuf };

/// Writes an MCAP file (version 0 of its specification): chunks, each followed by an index of
/// messages, then a summary with schemas, channels, chunk index, metadata index and statistics,
/// each part protected by its CRC. Holds one chunk in memory, and a few numbers for each written.
class McapWriter {
 public:
  /// Chunks are closed once they hold `chunk_size` bytes. Throws std::runtime_error.
  McapWriter(const std::filesystem::path& file, Compression compression,
             std::int64_t chunk_size = 1 << 20);

  /// A JSON schema, or the descriptions of a Protobuf message; ids count from 1.
  std::uint16_t add_schema(const std::string& name, const std::string& schema,
                           MessageEncoding encoding = MessageEncoding::kJson);
  /// A channel of messages as its schema has them. Throws std::runtime_error beyond 65,535 of them.
  std::uint16_t add_channel(const std::string& topic, std::uint16_t schema,
                            const std::vector<std::pair<std::string, std::string>>& metadata = {});
  /// Metadata about the file as a whole. Call before the first message.
  void add_metadata(const std::string& name,
                    const std::vector<std::pair<std::string, std::string>>& texts);

  /// Times in ns.
  void add_message(std::uint16_t channel, std::uint32_t sequence, std::uint64_t log_time,
                   std::uint64_t publish_time, std::string_view data);

  const std::filesystem::path& path() const { return out_.path(); }
  std::uint64_t message_count() const { return message_count_; }
  std::int64_t written() const { return out_.written(); }

  /// Writes the summary and gives the file its final name. Nothing can be added afterwards.
  void finish();

 private:
  struct Span {
    std::uint64_t first = 0, last = 0;
    bool empty = true;
    void add(std::uint64_t time);
  };
  struct ChunkIndex {
    Span span;
    std::uint64_t start = 0, length = 0, index_length = 0, packed = 0, unpacked = 0;
    std::map<std::uint16_t, std::uint64_t> index_offsets;
  };
  struct MetadataIndex {
    std::uint64_t start = 0, length = 0;
    std::string name;
  };
  /// Position of a group of equal records of the summary.
  struct Group {
    std::uint8_t opcode = 0;
    std::uint64_t start = 0, length = 0;
  };

  void put(std::string_view bytes);
  void close_chunk();
  void write_summary();
  std::string summary_record(const ChunkIndex& chunk) const;
  std::string statistics() const;

  OutputFile out_;
  Compression compression_;
  std::int64_t chunk_size_;
  std::uint32_t crc_ = 0;  // of all bytes so far; restarts with the summary
  std::string chunk_;      // records that are not written yet
  Span chunk_span_, span_;
  std::map<std::uint16_t, std::vector<std::pair<std::uint64_t, std::uint64_t>>> chunk_messages_;
  std::vector<std::string> schemas_, channels_;  // complete records
  std::vector<MessageEncoding> encodings_;       // by schema
  std::vector<ChunkIndex> chunks_;
  std::vector<MetadataIndex> metadata_;
  std::vector<std::uint64_t> channel_messages_;  // by channel
  std::uint64_t message_count_ = 0;
};

}  // namespace palpate::exporting
