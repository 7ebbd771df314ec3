#include "tools/mesh/vtu_array.hpp"

#include <zlib.h>

#include <charconv>
#include <cstdint>
#include <cstring>
#include <functional>
#include <map>
#include <sstream>
#include <stdexcept>

#include "tools/common/base64.hpp"

namespace palpate::mesh_tool {
namespace {

// Of one array; more is treated as damage.
constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 33;

std::vector<double> parse_ascii(const std::string& text) {
  std::vector<double> numbers;
  std::istringstream stream(text);
  for (std::string word; stream >> word;) {
    double number = 0;
    const auto [rest, error] = std::from_chars(word.data(), word.data() + word.size(), number);
    if (error != std::errc() || rest != word.data() + word.size()) {
      throw std::runtime_error("'" + word + "' is not a number");
    }
    numbers.push_back(number);
  }
  return numbers;
}

template <typename Number>
std::vector<double> convert(const std::string& bytes) {
  std::vector<double> numbers(bytes.size() / sizeof(Number));
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    Number number;
    std::memcpy(&number, &bytes[i * sizeof number], sizeof number);
    numbers[i] = static_cast<double>(number);
  }
  return numbers;
}

std::vector<double> convert(const std::string& bytes, const std::string& type) {
  static const std::map<std::string, std::vector<double> (*)(const std::string&)> kTypes{
      {"Float32", convert<float>},      {"Float64", convert<double>},
      {"Int8", convert<std::int8_t>},   {"UInt8", convert<std::uint8_t>},
      {"Int16", convert<std::int16_t>}, {"UInt16", convert<std::uint16_t>},
      {"Int32", convert<std::int32_t>}, {"UInt32", convert<std::uint32_t>},
      {"Int64", convert<std::int64_t>}, {"UInt64", convert<std::uint64_t>}};
  const auto found = kTypes.find(type);
  if (found == kTypes.end()) throw std::runtime_error("numbers of type '" + type + "'");
  return found->second(bytes);
}

/// Bytes of one array, header first, from base64 or raw storage that may be followed by other data.
class Block {
 public:
  Block(const std::string& storage, std::size_t from, bool is_raw) : storage_(storage), at_(from) {
    if (!is_raw) {
      // Header and data are encoded separately, or together: decoding whatever is present handles
      // both.
      const std::size_t end = storage.find_first_not_of(
          "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/= \t\r\n", from);
      decoded_ =
          common::from_base64(storage.substr(from, end == std::string::npos ? end : end - from));
      bytes_ = &decoded_;
      at_ = 0;
    }
  }
  std::uint64_t length(bool wide) {
    std::uint64_t value = 0;
    std::memcpy(&value, take(wide ? 8 : 4).data(), wide ? 8 : 4);
    if (value > kMostBytes) throw std::runtime_error("a length that cannot be");
    return value;
  }
  std::string take(std::uint64_t count) {
    if (at_ > bytes_->size() || bytes_->size() - at_ < count) {
      throw std::runtime_error("the data end too early");
    }
    at_ += count;
    return bytes_->substr(at_ - count, count);
  }

 private:
  const std::string& storage_;
  std::string decoded_;
  const std::string* bytes_ = &storage_;
  std::size_t at_;
};

std::string unpack(Block& block, const VtuStorage& storage) {
  const bool wide = storage.has_wide_header;
  if (!storage.is_compressed) return block.take(block.length(wide));
  const std::uint64_t blocks = block.length(wide), size = block.length(wide),
                      last = block.length(wide);
  if (blocks > kMostBytes / (size + 1)) throw std::runtime_error("a length that cannot be");
  std::vector<std::uint64_t> lengths;
  for (std::uint64_t b = 0; b < blocks; ++b) lengths.push_back(block.length(wide));
  std::string bytes;
  for (std::uint64_t b = 0; b < blocks; ++b) {
    const std::string packed = block.take(lengths[b]);
    std::string plain(b + 1 == blocks && last > 0 ? last : size, '\0');
    // zlib compresses by a factor of at most a thousand: a larger size is damage, for which no
    // memory is allocated.
    if (plain.size() > 2000 * packed.size() + 1000) throw std::runtime_error("a length that lies");
    uLongf count = plain.size();
    if (uncompress(reinterpret_cast<Bytef*>(plain.data()), &count,
                   reinterpret_cast<const Bytef*>(packed.data()), packed.size()) != Z_OK ||
        count != plain.size()) {
      throw std::runtime_error("data that zlib cannot unpack");
    }
    bytes += plain;
  }
  return bytes;
}

}  // namespace

std::vector<double> read_vtu_array(const boost::property_tree::ptree& array,
                                   const VtuStorage& storage) {
  const auto format = array.get<std::string>("<xmlattr>.format", "ascii");
  const auto type = array.get<std::string>("<xmlattr>.type", "");
  if (format == "ascii") return parse_ascii(array.data());
  if (format == "binary") {
    const std::string text = array.data();
    const std::size_t first = text.find_first_not_of(" \t\r\n");
    if (first == std::string::npos) return {};
    // Compressed data begin as a new block after the header's padding, which the decoder continues
    // with.
    Block block(text, first, false);
    return convert(unpack(block, storage), type);
  }
  if (format != "appended") throw std::runtime_error("format '" + format + "'");
  const auto offset = array.get<std::uint64_t>("<xmlattr>.offset", 0);
  if (offset > storage.appended.size()) throw std::runtime_error("an offset behind the file's end");
  Block block(storage.appended, offset, storage.appended_is_raw);
  return convert(unpack(block, storage), type);
}

}  // namespace palpate::mesh_tool
