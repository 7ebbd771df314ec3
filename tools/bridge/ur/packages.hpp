#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

// Packages of RTDE, protocol version 2: size (uint16, with the header), type (uint8) and fields,
// all big-endian without padding. Reference: Universal Robots, Real-Time Data Exchange (RTDE)
// guide.

namespace palpate::ur_bridge {

enum class PackageType : std::uint8_t {
  kProtocolVersion = 'V',
  kControllerVersion = 'v',
  kTextMessage = 'M',
  kData = 'U',
  kSetupOutputs = 'O',
  kSetupInputs = 'I',
  kStart = 'S',
  kPause = 'P',
};

inline constexpr int kHeaderSize = 3;
inline constexpr int kMostPackage = 4096;  // bytes; longer ones are an error of the protocol

/// Appends the fields of one package.
class PackageWriter {
 public:
  explicit PackageWriter(PackageType type) { begin(type); }

  /// Begins another package, in the same memory.
  void begin(PackageType type);
  template <class Number>
  PackageWriter& put(Number value) {
    std::uint64_t bits = 0;
    if constexpr (sizeof(Number) == 8)
      std::memcpy(&bits, &value, sizeof(value));
    else
      bits = static_cast<std::uint64_t>(value);
    for (int i = static_cast<int>(sizeof(Number)) - 1; i >= 0; --i)
      bytes_.push_back(static_cast<std::uint8_t>(bits >> (8 * i)));
    return *this;
  }
  PackageWriter& put_text(const std::string& text);
  /// The whole package, with its size.
  const std::vector<std::uint8_t>& finish();

 private:
  std::vector<std::uint8_t> bytes_;
};

/// Reads the fields of one package. Past its end every field is zero or empty, and ok() is false.
class PackageReader {
 public:
  PackageReader(const std::uint8_t* data, int size) : data_(data), end_(data + size) {}

  template <class Number>
  Number get() {
    std::uint64_t bits = 0;
    if (remaining() < static_cast<int>(sizeof(Number))) {
      is_ok_ = false;
      data_ = end_;
      return Number();
    }
    for (std::size_t i = 0; i < sizeof(Number); ++i) bits = bits << 8 | *data_++;
    if constexpr (sizeof(Number) == 8) {
      Number value;
      std::memcpy(&value, &bits, sizeof(value));
      return value;
    } else {
      return static_cast<Number>(bits);
    }
  }
  /// The next `size` bytes, or all that remain if -1.
  std::string get_text(int size = -1);
  int remaining() const { return static_cast<int>(end_ - data_); }
  bool ok() const { return is_ok_; }
  /// All fields have been there, and nothing else.
  bool is_complete() const { return is_ok_ && remaining() == 0; }

 private:
  const std::uint8_t* data_;
  const std::uint8_t* end_;
  bool is_ok_ = true;
};

/// A field of the controller's data, by its name and type in the guide: DOUBLE, VECTOR6D, ...
struct Variable {
  std::string name, type;
};

/// Bytes of a type; 0 for one that does not exist.
int size_of(const std::string& type);
/// Bytes of all.
int size_of(const std::vector<Variable>& variables);
/// Names, separated by commas.
std::string names_of(const std::vector<Variable>& variables);
/// Compares what the controller has answered, types separated by commas, with what is expected.
/// Empty if they agree, otherwise what is wrong, with the variable's name.
std::string difference_of(const std::vector<Variable>& variables, const std::string& types);

}  // namespace palpate::ur_bridge
