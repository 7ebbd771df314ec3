#include "tools/export/mcap_writer.hpp"

#include <lz4frame.h>
#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <functional>
#include <stdexcept>

namespace palpate::exporting {
namespace {

constexpr int kZstdLevel = 3;

std::string lz4_frame(std::string_view bytes) {
  LZ4F_preferences_t preferences{};
  preferences.frameInfo.contentSize = bytes.size();
  std::string packed(LZ4F_compressFrameBound(bytes.size(), &preferences), '\0');
  const std::size_t size =
      LZ4F_compressFrame(packed.data(), packed.size(), bytes.data(), bytes.size(), &preferences);
  if (LZ4F_isError(size)) throw std::runtime_error(std::string("lz4: ") + LZ4F_getErrorName(size));
  packed.resize(size);
  return packed;
}

std::string zstd_frame(std::string_view bytes) {
  std::string packed(ZSTD_compressBound(bytes.size()), '\0');
  const std::size_t size =
      ZSTD_compress(packed.data(), packed.size(), bytes.data(), bytes.size(), kZstdLevel);
  if (ZSTD_isError(size)) throw std::runtime_error(std::string("zstd: ") + ZSTD_getErrorName(size));
  packed.resize(size);
  return packed;
}

constexpr std::string_view kMagic{"\x89MCAP0\r\n", 8};

enum Opcode : std::uint8_t {
  kHeader = 1,
  kFooter = 2,
  kSchema = 3,
  kChannel = 4,
  kMessage = 5,
  kChunk = 6,
  kMessageIndex = 7,
  kChunkIndex = 8,
  kStatistics = 11,
  kMetadata = 12,
  kMetadataIndex = 13,
  kSummaryOffset = 14,
  kDataEnd = 15
};

/// Numbers in little-endian order, texts with a length prefix.
class Bytes {
 public:
  template <class Number>
  Bytes& number(Number value) {
    for (std::size_t i = 0; i < sizeof value; ++i)
      text_ += static_cast<char>(static_cast<std::uint64_t>(value) >> (8 * i) & 0xff);
    return *this;
  }
  Bytes& raw(std::string_view bytes) {
    text_ += bytes;
    return *this;
  }
  Bytes& text(std::string_view bytes) {
    return number(static_cast<std::uint32_t>(bytes.size())).raw(bytes);
  }
  Bytes& texts(const std::vector<std::pair<std::string, std::string>>& map) {
    Bytes inner;
    for (const auto& [key, value] : map) inner.text(key).text(value);
    return text(inner.text_);
  }
  const std::string& get() const { return text_; }

 private:
  std::string text_;
};

std::string record(Opcode opcode, std::string_view content) {
  Bytes head;
  head.number(static_cast<std::uint8_t>(opcode))
      .number(static_cast<std::uint64_t>(content.size()))
      .raw(content);
  return head.get();
}

std::string record(Opcode opcode, const Bytes& content) { return record(opcode, content.get()); }

std::uint32_t crc_of(std::string_view bytes, std::uint32_t before = 0) {
  // crc32() takes at most 32 bits of length at a time.
  while (!bytes.empty()) {
    const std::size_t part = std::min<std::size_t>(bytes.size(), 1U << 30);
    before = static_cast<std::uint32_t>(
        crc32(before, reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uInt>(part)));
    bytes.remove_prefix(part);
  }
  return before;
}

}  // namespace

const char* name_of(Compression compression) {
  constexpr const char* kNames[] = {"", "lz4", "zstd"};
  return kNames[static_cast<std::size_t>(compression)];
}

std::string compress(Compression compression, std::string_view bytes) {
  return compression == Compression::kLz4    ? lz4_frame(bytes)
         : compression == Compression::kZstd ? zstd_frame(bytes)
                                             : std::string(bytes);
}

void McapWriter::Span::add(std::uint64_t time) {
  first = empty ? time : std::min(first, time);
  last = empty ? time : std::max(last, time);
  empty = false;
}

McapWriter::McapWriter(const std::filesystem::path& file, Compression compression,
                       std::int64_t chunk_size)
    : out_(file), compression_(compression), chunk_size_(chunk_size) {
  put(kMagic);
  put(record(kHeader, Bytes().text("").text("palpate-export " PALPATE_VERSION)));
}

void McapWriter::put(std::string_view bytes) {
  crc_ = crc_of(bytes, crc_);
  out_.write(bytes);
}

std::uint16_t McapWriter::add_schema(const std::string& name, const std::string& schema,
                                     MessageEncoding encoding) {
  const auto id = static_cast<std::uint16_t>(schemas_.size() + 1);
  const char* kind = encoding == MessageEncoding::kProtobuf ? "protobuf" : "jsonschema";
  schemas_.push_back(record(kSchema, Bytes().number(id).text(name).text(kind).text(schema)));
  encodings_.push_back(encoding);
  chunk_ += schemas_.back();
  return id;
}

std::uint16_t McapWriter::add_channel(
    const std::string& topic, std::uint16_t schema,
    const std::vector<std::pair<std::string, std::string>>& metadata) {
  if (channels_.size() >= 65535) throw std::runtime_error("an MCAP file holds 65535 channels");
  const auto id = static_cast<std::uint16_t>(channels_.size());
  const char* encoding =
      encodings_.at(schema - 1U) == MessageEncoding::kProtobuf ? "protobuf" : "json";
  channels_.push_back(record(
      kChannel, Bytes().number(id).number(schema).text(topic).text(encoding).texts(metadata)));
  channel_messages_.push_back(0);
  chunk_ += channels_.back();
  return id;
}

void McapWriter::add_metadata(const std::string& name,
                              const std::vector<std::pair<std::string, std::string>>& texts) {
  const std::string bytes = record(kMetadata, Bytes().text(name).texts(texts));
  metadata_.push_back(
      {static_cast<std::uint64_t>(out_.written()), static_cast<std::uint64_t>(bytes.size()), name});
  put(bytes);
}

void McapWriter::add_message(std::uint16_t channel, std::uint32_t sequence, std::uint64_t log_time,
                             std::uint64_t publish_time, std::string_view data) {
  chunk_messages_[channel].emplace_back(log_time, chunk_.size());
  chunk_ += record(
      kMessage,
      Bytes().number(channel).number(sequence).number(log_time).number(publish_time).raw(data));
  chunk_span_.add(log_time);
  span_.add(log_time);
  ++channel_messages_.at(channel);
  ++message_count_;
  if (static_cast<std::int64_t>(chunk_.size()) >= chunk_size_) close_chunk();
}

void McapWriter::close_chunk() {
  if (chunk_.empty()) return;
  const std::string packed = compress(compression_, chunk_);
  ChunkIndex index;
  index.span = chunk_span_;
  index.start = static_cast<std::uint64_t>(out_.written());
  index.packed = packed.size();
  index.unpacked = chunk_.size();
  const std::string bytes = record(kChunk, Bytes()
                                               .number(chunk_span_.first)
                                               .number(chunk_span_.last)
                                               .number(static_cast<std::uint64_t>(chunk_.size()))
                                               .number(crc_of(chunk_))
                                               .text(name_of(compression_))
                                               .number(static_cast<std::uint64_t>(packed.size()))
                                               .raw(packed));
  index.length = bytes.size();
  put(bytes);
  for (auto& [channel, messages] : chunk_messages_) {
    index.index_offsets[channel] = static_cast<std::uint64_t>(out_.written());
    std::stable_sort(messages.begin(), messages.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    Bytes places;
    for (const auto& [time, place] : messages) places.number(time).number(place);
    const std::string entry = record(kMessageIndex, Bytes().number(channel).text(places.get()));
    index.index_length += entry.size();
    put(entry);
  }
  chunks_.push_back(std::move(index));
  chunk_.clear();
  chunk_messages_.clear();
  chunk_span_ = {};
}

std::string McapWriter::summary_record(const ChunkIndex& chunk) const {
  Bytes offsets;
  for (const auto& [channel, place] : chunk.index_offsets) offsets.number(channel).number(place);
  return record(kChunkIndex, Bytes()
                                 .number(chunk.span.first)
                                 .number(chunk.span.last)
                                 .number(chunk.start)
                                 .number(chunk.length)
                                 .text(offsets.get())
                                 .number(chunk.index_length)
                                 .text(name_of(compression_))
                                 .number(chunk.packed)
                                 .number(chunk.unpacked));
}

std::string McapWriter::statistics() const {
  Bytes counts;
  for (std::size_t i = 0; i < channel_messages_.size(); ++i)
    counts.number(static_cast<std::uint16_t>(i)).number(channel_messages_[i]);
  return record(kStatistics, Bytes()
                                 .number(message_count_)
                                 .number(static_cast<std::uint16_t>(schemas_.size()))
                                 .number(static_cast<std::uint32_t>(channels_.size()))
                                 .number(std::uint32_t{0})  // attachments
                                 .number(static_cast<std::uint32_t>(metadata_.size()))
                                 .number(static_cast<std::uint32_t>(chunks_.size()))
                                 .number(span_.first)
                                 .number(span_.last)
                                 .text(counts.get()));
}

void McapWriter::write_summary() {
  crc_ = 0;
  const auto begin = static_cast<std::uint64_t>(out_.written());
  std::vector<Group> groups;
  const auto group = [&](Opcode opcode, const std::function<void()>& write) {
    const auto start = static_cast<std::uint64_t>(out_.written());
    write();
    const auto length = static_cast<std::uint64_t>(out_.written()) - start;
    if (length > 0) groups.push_back({opcode, start, length});
  };
  group(kSchema, [this] {
    for (const std::string& schema : schemas_) put(schema);
  });
  group(kChannel, [this] {
    for (const std::string& channel : channels_) put(channel);
  });
  group(kStatistics, [this] { put(statistics()); });
  group(kChunkIndex, [this] {
    for (const ChunkIndex& chunk : chunks_) put(summary_record(chunk));
  });
  group(kMetadataIndex, [this] {
    for (const MetadataIndex& entry : metadata_)
      put(record(kMetadataIndex,
                 Bytes().number(entry.start).number(entry.length).text(entry.name)));
  });
  const auto offsets = static_cast<std::uint64_t>(out_.written());
  for (const Group& entry : groups)
    put(record(kSummaryOffset,
               Bytes().number(entry.opcode).number(entry.start).number(entry.length)));

  // The footer's own CRC covers everything before it: opcode, length and the two offsets included.
  constexpr std::uint64_t kFooterLength = 20;
  put(Bytes()
          .number(static_cast<std::uint8_t>(kFooter))
          .number(kFooterLength)
          .number(begin)
          .number(offsets)
          .get());
  put(Bytes().number(crc_).get());
}

void McapWriter::finish() {
  close_chunk();
  put(record(kDataEnd, Bytes().number(crc_)));
  write_summary();
  put(kMagic);
  out_.finish();
}

}  // namespace palpate::exporting
