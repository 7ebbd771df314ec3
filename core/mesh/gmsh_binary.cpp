#include "core/mesh/gmsh_content.hpp"

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <iterator>
#include <sstream>

namespace palpate::mesh {
namespace {

constexpr std::uint64_t kMostGroups = 100;  // maximum per entity

class BinaryReader {
 public:
  BinaryReader(std::istream& stream, const std::string& name, int version, GmshContent& content)
      : name_(name),
        first_(static_cast<std::size_t>(std::max<std::streamoff>(0, stream.tellg()))),
        bytes_(std::istreambuf_iterator<char>(stream), {}),
        version_(version),
        content_(content) {}

  void read() {
    if (take<std::int32_t>() != 1) fail("the binary file is damaged, or of the other byte order");
    expect("$EndMeshFormat");
    while (next_line()) {
      const std::string end = "$End" + line_.substr(1);
      if (line_ == "$PhysicalNames") {
        read_names();
        continue;
      }
      if (line_ == "$Entities") {
        read_entities();
      } else if (line_ == "$Nodes") {
        version_ == 2 ? read_nodes_2() : read_nodes_4();
      } else if (line_ == "$Elements") {
        version_ == 2 ? read_elements_2() : read_elements_4();
      } else {
        skip_to(end);
        continue;
      }
      expect(end);
    }
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw ParseError(name_ + ": byte " + std::to_string(first_ + at_) + ": " + what);
  }
  void check(const std::string& error) const {
    if (!error.empty()) fail(error);
  }

  template <typename Number>
  Number take() {
    if (bytes_.size() - at_ < sizeof(Number)) fail("the file ends too early");
    Number number;
    std::memcpy(&number, &bytes_[at_], sizeof number);
    at_ += sizeof number;
    return number;
  }

  /// Reads a count of items of at least `size` bytes each, checked against the size of the file.
  std::uint64_t take_count(std::size_t size) {
    const auto count = take<std::uint64_t>();
    if (count > (bytes_.size() - at_) / size) fail("the file ends too early");
    return count;
  }

  /// Next non-empty line, which must begin a section.
  bool next_line() {
    while (at_ < bytes_.size() && (bytes_[at_] == '\n' || bytes_[at_] == '\r')) ++at_;
    if (at_ >= bytes_.size()) return false;
    const std::size_t end = std::min(bytes_.find('\n', at_), bytes_.size());
    line_ = bytes_.substr(at_, end - at_);
    while (!line_.empty() && (line_.back() == '\r' || line_.back() == ' ')) line_.pop_back();
    if (line_.empty() || line_[0] != '$') fail("no section begins here");
    at_ = std::min(end + 1, bytes_.size());
    return true;
  }

  void expect(const std::string& section) {
    if (!next_line() || line_ != section) fail(section + " should stand here");
  }

  void skip_to(const std::string& end) {
    const std::size_t found = bytes_.find(end, at_);
    if (found == std::string::npos) fail("the file ends before " + end);
    at_ = found + end.size();
  }

  void read_names() {
    const std::string end = "$EndPhysicalNames";
    const std::size_t found = bytes_.find(end, at_);
    if (found == std::string::npos) fail("the file ends before " + end);
    std::istringstream text(bytes_.substr(at_, found - at_));
    LineReader reader(text, name_ + ", $PhysicalNames", '\0');
    read_gmsh_names(reader, content_);
    at_ = found + end.size();
  }

  long count_line() {
    const std::size_t end = std::min(bytes_.find('\n', at_), bytes_.size());
    std::istringstream text(bytes_.substr(at_, end - at_));
    LineReader reader(text, name_ + ": byte " + std::to_string(first_ + at_), '\0');
    reader.require("a count");
    const long count = reader.count(0);
    at_ = std::min(end + 1, bytes_.size());
    return count;
  }

  Eigen::Vector3d take_point() {
    Eigen::Vector3d p;
    for (int i = 0; i < 3; ++i) p[i] = take<double>();
    return p;
  }

  void read_entities() {
    std::uint64_t counts[4];
    for (std::uint64_t& count : counts) count = take_count(1);
    for (int d = 0; d < 4; ++d) {
      for (std::uint64_t i = 0; i < counts[d]; ++i) {
        std::vector<long>& groups = content_.entity_groups[{d, take<std::int32_t>()}];
        for (int k = 0; k < (d == 0 ? 3 : 6); ++k) take<double>();
        const std::uint64_t number = take_count(sizeof(std::int32_t));
        if (number > kMostGroups) fail("an entity is in too many physical groups");
        for (std::uint64_t g = 0; g < number; ++g)
          groups.push_back(std::labs(take<std::int32_t>()));
        if (d == 0) continue;
        const std::uint64_t bounding = take_count(sizeof(std::int32_t));
        at_ += sizeof(std::int32_t) * bounding;
      }
    }
  }

  void read_nodes_2() {
    const long count = count_line();
    for (long i = 0; i < count; ++i) {
      const long number = take<std::int32_t>();
      check(content_.add_node(number, take_point()));
    }
  }

  void read_nodes_4() {
    const std::uint64_t blocks = take_count(1);
    for (int k = 0; k < 3; ++k) take<std::uint64_t>();
    for (std::uint64_t b = 0; b < blocks; ++b) {
      const int dimension = take<std::int32_t>();
      take<std::int32_t>();
      const bool parametric = take<std::int32_t>() != 0;
      const std::uint64_t count = take_count(sizeof(std::uint64_t));
      std::vector<long> numbers;
      for (std::uint64_t i = 0; i < count; ++i) {
        numbers.push_back(static_cast<long>(take<std::uint64_t>()));
      }
      for (const long number : numbers) {
        check(content_.add_node(number, take_point()));
        for (int k = 0; parametric && k < dimension; ++k) take<double>();
      }
    }
  }

  int node_count(long type) const {
    const int count = gmsh_node_count(type);
    if (count == 0) fail("elements of type " + std::to_string(type) + " are unknown");
    return count;
  }

  void read_elements_2() {
    const long count = count_line();
    for (long done = 0; done < count;) {
      const long type = take<std::int32_t>(), block = take<std::int32_t>(),
                 tags = take<std::int32_t>();
      if (block < 1 || block > count - done) fail("a block of elements has a wrong length");
      if (tags < 0 || tags > 1000) fail("an element has no sensible number of tags");
      const int nodes = node_count(type);
      for (long i = 0; i < block; ++i, ++done) {
        const long number = take<std::int32_t>();
        std::vector<long> groups, corners;
        for (long k = 0; k < tags; ++k) {
          const long tag = take<std::int32_t>();
          if (k == 0 && tag != 0) groups.push_back(tag);
        }
        for (int k = 0; k < nodes; ++k) corners.push_back(take<std::int32_t>());
        check(content_.add_element(number, type, corners, groups));
      }
    }
  }

  void read_elements_4() {
    const std::uint64_t blocks = take_count(1);
    for (int k = 0; k < 3; ++k) take<std::uint64_t>();
    for (std::uint64_t b = 0; b < blocks; ++b) {
      const int dimension = take<std::int32_t>();
      const GmshContent::Tag entity{dimension, take<std::int32_t>()};
      const long type = take<std::int32_t>();
      const int nodes = node_count(type);
      const std::uint64_t count = take_count(sizeof(std::uint64_t) * (1 + nodes));
      const auto found = content_.entity_groups.find(entity);
      const std::vector<long> groups =
          found == content_.entity_groups.end() ? std::vector<long>() : found->second;
      for (std::uint64_t i = 0; i < count; ++i) {
        const auto number = static_cast<long>(take<std::uint64_t>());
        std::vector<long> corners;
        for (int k = 0; k < nodes; ++k) {
          corners.push_back(static_cast<long>(take<std::uint64_t>()));
        }
        check(content_.add_element(number, type, corners, groups));
      }
    }
  }

  const std::string& name_;
  std::size_t first_;  // offset in the file at which `bytes_` begins
  std::string bytes_;
  int version_;
  GmshContent& content_;
  std::size_t at_ = 0;
  std::string line_;
};

}  // namespace

void read_gmsh_binary(std::istream& stream, const std::string& name, int version,
                      GmshContent& content) {
  BinaryReader(stream, name, version, content).read();
}

}  // namespace palpate::mesh
