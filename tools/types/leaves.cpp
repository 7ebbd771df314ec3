#include "tools/types/leaves.hpp"

#include <charconv>

namespace palpate::types {
namespace {

template <class Number>
void append(Number value, std::string& text) {
  char digits[32];
  text.append(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
}

}  // namespace

std::string Leaf::path() const {
  std::string result;
  for (std::size_t i = 0; i < key_.size(); ++i) {
    if (names_[i] == nullptr)
      result += "[" + std::to_string(key_[i]) + "]";
    else
      result += (i == 0 ? "" : ".") + *names_[i];
  }
  return result;
}

void Leaf::append_to(std::string& text, std::int64_t most_bytes) const {
  static constexpr char kDigits[] = "0123456789abcdef";
  switch (what_) {
    case What::kInteger:
      append(integer_, text);
      break;
    case What::kReal:
      if (member_->kind == Kind::kFloat)
        append(static_cast<float>(real_), text);
      else
        append(real_, text);
      break;
    case What::kText:
      text += text_;
      break;
    case What::kBytes:
      if (static_cast<std::int64_t>(text_.size()) > most_bytes) {
        text += std::to_string(text_.size()) + " bytes";
        break;
      }
      for (const char c : text_) {
        text += kDigits[static_cast<unsigned char>(c) >> 4];
        text += kDigits[static_cast<unsigned char>(c) & 0xf];
      }
  }
}

class LeafHandler : public Handler {
 public:
  explicit LeafHandler(const std::function<void(const Leaf&)>& take) : take_(take) {}

  void begin_struct(const Struct&) override { push(); }
  void end_struct() override { pop(); }
  void begin_member(const Member& member, int index) override { set(&member.name, index); }
  void begin_array(std::int64_t) override { push(); }
  void begin_element(std::int64_t index) override { set(nullptr, index); }
  void end_array() override { pop(); }

  void integer(const Member& member, std::int64_t value) override {
    leaf_.integer_ = value;
    give(member, Leaf::What::kInteger);
  }
  void real(const Member& member, double value) override {
    leaf_.real_ = value;
    give(member, Leaf::What::kReal);
  }
  void text(const Member& member, std::string_view value) override {
    leaf_.text_ = value;
    give(member, Leaf::What::kText);
  }
  void bytes(const Member& member, const std::uint8_t* data, std::int64_t size) override {
    leaf_.text_ = {reinterpret_cast<const char*>(data), static_cast<std::size_t>(size)};
    give(member, Leaf::What::kBytes);
  }

 private:
  void push() {
    leaf_.key_.push_back(0);
    leaf_.names_.push_back(nullptr);
  }
  void pop() {
    leaf_.key_.pop_back();
    leaf_.names_.pop_back();
  }
  void set(const std::string* name, std::int64_t index) {
    leaf_.key_.back() = index;
    leaf_.names_.back() = name;
  }
  void give(const Member& member, Leaf::What what) {
    leaf_.member_ = &member;
    leaf_.what_ = what;
    take_(leaf_);
  }

  Leaf leaf_;
  const std::function<void(const Leaf&)>& take_;
};

bool each_leaf(const Struct& type, const void* data, int size,
               const std::function<void(const Leaf&)>& take) {
  LeafHandler handler(take);
  return decode(type, data, size, handler);
}

}  // namespace palpate::types
