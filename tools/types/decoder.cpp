#include "tools/types/decoder.hpp"

#include <cstring>
#include <vector>

namespace palpate::types {
namespace {

constexpr int kMostNested = 64;
constexpr std::int64_t kMostEmpty = 1'000'000;  // elements

class Walk {
 public:
  Walk(const void* data, int size, Handler* handler)
      : data_(static_cast<const std::uint8_t*>(data)),
        size_(size),
        left_(kMostEmpty + size),
        handler_(handler) {}

  bool message(const Struct& type) {
    std::uint64_t fingerprint = 0;
    if (!number(8, fingerprint) || static_cast<std::int64_t>(fingerprint) != type.fingerprint)
      return false;
    return structure(type, 0) && at_ == size_;
  }

 private:
  bool structure(const Struct& type, int depth) {
    if (depth > kMostNested) return false;
    const std::size_t base = lengths_.size();
    lengths_.resize(base + type.members.size());
    if (handler_ != nullptr) handler_->begin_struct(type);
    for (std::size_t i = 0; i < type.members.size(); ++i) {
      if (--left_ < 0) return false;
      if (handler_ != nullptr) handler_->begin_member(type.members[i], static_cast<int>(i));
      if (!array({type.members[i], base, base + i, depth}, 0)) return false;
    }
    if (handler_ != nullptr) handler_->end_struct();
    lengths_.resize(base);
    return true;
  }

  /// A member of a struct, whose integers are in lengths_ from `base` on.
  struct Place {
    const Member& member;
    std::size_t base, own;
    int depth;
  };

  bool array(const Place& place, std::size_t dimension) {
    const Member& member = place.member;
    if (dimension == member.dimensions.size()) return value(place);
    const Dimension& declared = member.dimensions[dimension];
    const std::int64_t count =
        declared.member < 0 ? declared.size
                            : lengths_[place.base + static_cast<std::size_t>(declared.member)];
    if (count < 0) return false;
    const bool is_last = dimension + 1 == member.dimensions.size();
    const int width = is_last ? size_of(member.kind) : 0;
    if (width > 0 && count > (size_ - at_) / width) return false;
    if (is_last && (member.kind == Kind::kByte || (handler_ == nullptr && width > 0))) {
      if (handler_ != nullptr) handler_->bytes(member, data_ + at_, count);
      at_ += count * width;
      return true;
    }
    if (handler_ != nullptr) handler_->begin_array(count);
    for (std::int64_t i = 0; i < count; ++i) {
      if (width == 0 && --left_ < 0) return false;
      if (handler_ != nullptr) handler_->begin_element(i);
      if (!array(place, dimension + 1)) return false;
    }
    if (handler_ != nullptr) handler_->end_array();
    return true;
  }

  bool value(const Place& place) {
    const Member& member = place.member;
    if (member.kind == Kind::kStruct) return structure(*member.content, place.depth + 1);
    if (member.kind == Kind::kString) return text(member);
    std::uint64_t bits = 0;
    if (!number(size_of(member.kind), bits)) return false;
    std::int64_t integer = 0;
    double real = 0;
    switch (member.kind) {
      case Kind::kInt8:
        integer = static_cast<std::int8_t>(bits);
        break;
      case Kind::kInt16:
        integer = static_cast<std::int16_t>(bits);
        break;
      case Kind::kInt32:
      case Kind::kEnumeration:
        integer = static_cast<std::int32_t>(bits);
        break;
      case Kind::kBoolean:
        integer = bits != 0 ? 1 : 0;
        break;
      case Kind::kFloat: {
        const auto half = static_cast<std::uint32_t>(bits);
        float single = 0;
        std::memcpy(&single, &half, sizeof single);
        real = static_cast<double>(single);
        break;
      }
      case Kind::kDouble:
        std::memcpy(&real, &bits, sizeof real);
        break;
      default:  // kInt64, kByte
        integer = static_cast<std::int64_t>(bits);
    }
    if (member.dimensions.empty()) lengths_[place.own] = integer;
    if (handler_ == nullptr) return true;
    if (member.kind == Kind::kFloat || member.kind == Kind::kDouble)
      handler_->real(member, real);
    else
      handler_->integer(member, integer);
    return true;
  }

  bool text(const Member& member) {
    std::uint64_t length = 0;  // with the final zero
    if (!number(4, length) || length == 0 || length > static_cast<std::uint64_t>(size_ - at_))
      return false;
    const auto* begin = reinterpret_cast<const char*>(data_ + at_);
    at_ += static_cast<std::int64_t>(length);
    if (data_[at_ - 1] != 0) return false;
    if (handler_ != nullptr) handler_->text(member, {begin, static_cast<std::size_t>(length - 1)});
    return true;
  }

  bool number(int width, std::uint64_t& bits) {
    if (size_ - at_ < width) return false;
    bits = 0;
    for (int i = 0; i < width; ++i) bits = bits << 8 | data_[at_ + i];
    at_ += width;
    return true;
  }

  const std::uint8_t* data_;
  std::int64_t size_, at_ = 0;
  std::int64_t left_;  // elements and members that may still be visited
  Handler* handler_;
  std::vector<std::int64_t> lengths_;  // integers of the structs that are open
};

}  // namespace

bool fits(const Struct& type, const void* data, int size) {
  return Walk(data, size, nullptr).message(type);
}

bool decode(const Struct& type, const void* data, int size, Handler& handler) {
  return fits(type, data, size) && Walk(data, size, &handler).message(type);
}

}  // namespace palpate::types
