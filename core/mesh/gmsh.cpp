#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <iterator>
#include <memory>
#include <sstream>
#include <utility>

#include "core/mesh/gmsh_content.hpp"
#include "core/mesh/mesh_formats.hpp"

namespace palpate::mesh {
namespace {

constexpr long kMostGroups = 100;  // maximum per entity

/// The numbers of a .msh in order, from its text or binary form. `what` names a missing item.
class GmshSource {
 public:
  virtual ~GmshSource() = default;

  /// Advances to the line that begins the next section; false at the end of the file.
  virtual bool next_section(std::string& section) = 0;
  virtual void expect(const std::string& end) = 0;
  virtual void skip_to(const std::string& end) = 0;
  virtual void read_names(GmshContent& content) = 0;

  /// Begins a record, which is a line of the text.
  virtual void begin(const std::string& what) = 0;
  /// The count on a line of its own, which is text in version 2 of either form.
  virtual long count_line(const std::string& what) = 0;
  virtual long integer() = 0;  // 32 bits
  virtual long number() = 0;   // of a node or element in version 4: 64 bits
  /// Number of items that follow, of at least `size` bytes each in the binary form.
  virtual long count(std::size_t size) = 0;
  virtual double real() = 0;
  /// Passes over what a line may leave out.
  virtual void skip(int integers, int numbers, int reals) = 0;

  [[noreturn]] virtual void fail(const std::string& what) const = 0;
  virtual bool is_binary() const = 0;
};

void read_names_of(LineReader& reader, GmshContent& content) {
  reader.require("the number of names");
  const int count = reader.count(0);
  for (int i = 0; i < count; ++i) {
    reader.require("a physical name");
    const GmshContent::Tag tag{reader.count(0), reader.integer(1)};
    const std::string& line = reader.line();
    const std::size_t open = line.find('"'), close = line.rfind('"');
    if (open == close) reader.fail("a physical name must stand in quotes");
    content.names[tag] = line.substr(open + 1, close - open - 1);
  }
}

class TextSource final : public GmshSource {
 public:
  explicit TextSource(LineReader& reader) : reader_(reader) {}

  bool next_section(std::string& section) override {
    if (!reader_.next()) return false;
    section = reader_.words()[0];
    if (section[0] != '$') fail("'" + section + "' stands outside of any section");
    return true;
  }
  void expect(const std::string& end) override {
    reader_.require(end);
    if (reader_.words()[0] != end) fail("'" + reader_.line() + "' where " + end + " should stand");
  }
  void skip_to(const std::string& end) override {
    do {
      reader_.require(end);
    } while (reader_.words()[0] != end);
  }
  void read_names(GmshContent& content) override { read_names_of(reader_, content); }

  void begin(const std::string& what) override {
    reader_.require(what);
    column_ = 0;
  }
  long count_line(const std::string& what) override {
    begin(what);
    return count(1);
  }
  long integer() override { return reader_.integer(column_++); }
  long number() override { return integer(); }
  long count(std::size_t) override { return reader_.count(column_++); }
  double real() override { return reader_.number(column_++); }
  void skip(int integers, int numbers, int reals) override {
    column_ += integers + numbers + reals;
  }
  [[noreturn]] void fail(const std::string& what) const override { reader_.fail(what); }
  bool is_binary() const override { return false; }

 private:
  LineReader& reader_;
  int column_ = 0;
};

/// Little-endian, after the line of the format.
class BinarySource final : public GmshSource {
 public:
  BinarySource(std::istream& stream, const std::string& name)
      : name_(name),
        first_(static_cast<std::size_t>(std::max<std::streamoff>(0, stream.tellg()))),
        bytes_(std::istreambuf_iterator<char>(stream), {}) {}

  bool next_section(std::string& section) override {
    while (at_ < bytes_.size() && (bytes_[at_] == '\n' || bytes_[at_] == '\r')) ++at_;
    if (at_ >= bytes_.size()) return false;
    const std::size_t end = std::min(bytes_.find('\n', at_), bytes_.size());
    section = bytes_.substr(at_, end - at_);
    while (!section.empty() && (section.back() == '\r' || section.back() == ' '))
      section.pop_back();
    if (section.empty() || section[0] != '$') fail("no section begins here");
    at_ = std::min(end + 1, bytes_.size());
    return true;
  }
  void expect(const std::string& end) override {
    std::string section;
    if (!next_section(section) || section != end) fail(end + " should stand here");
  }
  void skip_to(const std::string& end) override { at_ = find(end) + end.size(); }
  void read_names(GmshContent& content) override {
    const std::size_t end = find("$EndPhysicalNames");
    std::istringstream text(bytes_.substr(at_, end - at_));
    LineReader reader(text, name_ + ", $PhysicalNames", '\0');
    read_names_of(reader, content);
    at_ = end;
  }

  void begin(const std::string&) override {}
  long count_line(const std::string&) override {
    const std::size_t end = std::min(bytes_.find('\n', at_), bytes_.size());
    std::istringstream text(bytes_.substr(at_, end - at_));
    LineReader reader(text, place(), '\0');
    reader.require("a count");
    at_ = std::min(end + 1, bytes_.size());
    return reader.count(0);
  }
  long integer() override { return take<std::int32_t>(); }
  long number() override { return static_cast<long>(take<std::uint64_t>()); }
  long count(std::size_t size) override {
    const auto count = take<std::uint64_t>();
    if (count > (bytes_.size() - at_) / size) fail("the file ends too early");
    return static_cast<long>(count);
  }
  double real() override { return take<double>(); }
  void skip(int integers, int numbers, int reals) override {
    const std::size_t bytes = 4 * std::size_t(integers) + 8 * std::size_t(numbers + reals);
    if (bytes_.size() - at_ < bytes) fail("the file ends too early");
    at_ += bytes;
  }
  [[noreturn]] void fail(const std::string& what) const override {
    throw ParseError(place() + ": " + what);
  }
  bool is_binary() const override { return true; }

 private:
  std::string place() const { return name_ + ": byte " + std::to_string(first_ + at_); }
  std::size_t find(const std::string& end) const {
    const std::size_t found = bytes_.find(end, at_);
    if (found == std::string::npos) fail("the file ends before " + end);
    return found;
  }
  template <typename Number>
  Number take() {
    if (bytes_.size() - at_ < sizeof(Number)) fail("the file ends too early");
    Number number;
    std::memcpy(&number, &bytes_[at_], sizeof number);
    at_ += sizeof number;
    return number;
  }

  const std::string& name_;
  std::size_t first_;  // offset in the file at which `bytes_` begins
  std::string bytes_;
  std::size_t at_ = 0;
};

class GmshReader {
 public:
  GmshReader(std::istream& stream, const std::string& name, OnFault on_fault)
      : lines_(stream, name, '\0'),
        source_(std::make_unique<TextSource>(lines_)),
        content_(on_fault) {
    std::string section;
    while (source_->next_section(section)) {
      if (section == "$MeshFormat") {
        read_format(stream, name);
        continue;
      }
      if (version_ == 0) source_->fail("does not start with $MeshFormat");
      read_section(section, "$End" + section.substr(1));
    }
    if (!content_.has_volume()) lines_.fail("holds no tetrahedra");
  }

  MeshWithGroups result() const { return content_.assemble(); }

 private:
  void read_format(std::istream& stream, const std::string& name) {
    lines_.require("the version");
    const double version = lines_.number(0);
    version_ = version >= 2 && version < 3 ? 2 : version == 4.1 ? 4 : 0;
    if (version_ == 0)
      lines_.fail("version " + lines_.words()[0] + " cannot be read; allowed: 2.x, 4.1");
    if (lines_.integer(1) != 0) {
      source_ = std::make_unique<BinarySource>(stream, name);
      if (source_->integer() != 1)
        source_->fail("the binary file is damaged, or of the other byte order");
    }
    source_->expect("$EndMeshFormat");
  }

  void read_section(const std::string& section, const std::string& end) {
    if (section == "$PhysicalNames") {
      source_->read_names(content_);
    } else if (section == "$Entities") {
      read_entities();
    } else if (section == "$Nodes") {
      version_ == 2 ? read_nodes_2() : read_nodes_4();
    } else if (section == "$Elements") {
      version_ == 4 ? read_elements_4() : source_->is_binary() ? read_blocks_2() : read_lines_2();
    } else {
      source_->skip_to(end);
      return;
    }
    source_->expect(end);
  }

  /// Version 4: physical groups of each entity.
  void read_entities() {
    source_->begin("the numbers of entities");
    std::array<long, 4> counts;
    for (long& count : counts) count = source_->count(1);
    for (int d = 0; d < 4; ++d) {
      for (long i = 0; i < counts[d]; ++i) {
        source_->begin("an entity");
        std::vector<long>& groups = content_.entity_groups[{d, source_->integer()}];
        source_->skip(0, 0, d == 0 ? 3 : 6);  // its bounding box
        const long number = source_->count(sizeof(std::int32_t));
        // each element receives its entity's groups, so that long lists of both would multiply
        if (number > kMostGroups) source_->fail("an entity is in too many physical groups");
        // a negative number: the entity has reversed orientation in that group
        for (long g = 0; g < number; ++g) groups.push_back(std::labs(source_->integer()));
        if (d == 0 || !source_->is_binary()) continue;
        for (long bounding = source_->count(4); bounding > 0; --bounding) source_->integer();
      }
    }
  }

  void check(const std::string& error) const {
    if (!error.empty()) source_->fail(error);
  }

  void add_node(long number) {
    Eigen::Vector3d p;
    for (int i = 0; i < 3; ++i) p[i] = source_->real();
    check(content_.add_node(number, p));
  }

  void read_nodes_2() {
    const long count = source_->count_line("the number of nodes");
    for (long i = 0; i < count; ++i) {
      source_->begin("a node");
      add_node(source_->integer());
    }
  }

  void read_nodes_4() {
    source_->begin("the numbers of nodes");
    const long blocks = source_->count(1);
    source_->skip(0, 3, 0);
    for (long b = 0; b < blocks; ++b) {
      source_->begin("a block of nodes");
      int parameters = 0;  // per node
      if (source_->is_binary()) {
        const long dimension = source_->integer();
        source_->skip(1, 0, 0);
        if (source_->integer() != 0) parameters = static_cast<int>(dimension);
      } else {
        source_->skip(3, 0, 0);
      }
      const long count = source_->count(sizeof(std::uint64_t));
      std::vector<long> numbers;
      for (long i = 0; i < count; ++i) {
        source_->begin("a node number");
        numbers.push_back(source_->number());
      }
      for (const long number : numbers) {
        source_->begin("a node");
        add_node(number);
        for (int k = 0; k < parameters; ++k) source_->real();
      }
    }
  }

  /// Number of nodes of an element; those of unknown types can only be passed over in lines.
  int node_count(long type) const {
    const int count = gmsh_node_count(type);
    if (count == 0 && source_->is_binary())
      source_->fail("elements of type " + std::to_string(type) + " are unknown");
    return count;
  }

  template <typename Read>
  void add_element(long number, long type, const std::vector<long>& groups, const Read& read) {
    std::vector<long> nodes;
    for (int k = node_count(type); k > 0; --k) nodes.push_back(read());
    check(content_.add_element(number, type, nodes, groups));
  }

  /// The first of the tags of an element is its physical group; 0: none.
  std::vector<long> read_tags(long count) {
    std::vector<long> groups;
    for (long k = 0; k < count; ++k) {
      const long tag = source_->integer();
      if (k == 0 && tag != 0) groups.push_back(tag);
    }
    return groups;
  }

  void read_lines_2() {
    const long count = source_->count_line("the number of elements");
    for (long i = 0; i < count; ++i) {
      source_->begin("an element");
      const long number = source_->integer(), type = source_->integer();
      const std::vector<long> groups = read_tags(source_->count(1));
      add_element(number, type, groups, [this] { return source_->integer(); });
    }
  }

  void read_blocks_2() {
    const long count = source_->count_line("");
    for (long done = 0; done < count;) {
      const long type = source_->integer(), block = source_->integer(), tags = source_->integer();
      if (block < 1 || block > count - done)
        source_->fail("a block of elements has a wrong length");
      if (tags < 0 || tags > 1000) source_->fail("an element has no sensible number of tags");
      for (long i = 0; i < block; ++i, ++done) {
        const long number = source_->integer();
        const std::vector<long> groups = read_tags(tags);
        add_element(number, type, groups, [this] { return source_->integer(); });
      }
    }
  }

  void read_elements_4() {
    source_->begin("the numbers of elements");
    const long blocks = source_->count(1);
    source_->skip(0, 3, 0);
    for (long b = 0; b < blocks; ++b) {
      source_->begin("a block of elements");
      const auto dimension = static_cast<int>(source_->integer());
      const GmshContent::Tag entity{dimension, source_->integer()};
      const long type = source_->integer();
      const long count = source_->count(sizeof(std::uint64_t) * (1 + node_count(type)));
      const auto found = content_.entity_groups.find(entity);
      const std::vector<long> groups =
          found == content_.entity_groups.end() ? std::vector<long>() : found->second;
      for (long i = 0; i < count; ++i) {
        source_->begin("an element");
        const long number = source_->number();
        add_element(number, type, groups, [this] { return source_->number(); });
      }
    }
  }

  LineReader lines_;
  std::unique_ptr<GmshSource> source_;
  GmshContent content_;
  int version_ = 0;
};

}  // namespace

MeshWithGroups read_gmsh(std::istream& stream, const std::string& name, OnFault on_fault) {
  return GmshReader(stream, name, on_fault).result();
}

}  // namespace palpate::mesh
