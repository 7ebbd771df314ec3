#include "tools/export/csv_export.hpp"

#include <iostream>
#include <map>
#include <set>

#include "tools/common/output_files.hpp"
#include "tools/export/columns.hpp"
#include "tools/export/output_file.hpp"

namespace palpate::exporting {
namespace {

void append_cell(const log::Record& record, const Column& column, std::string& row) {
  const int field = column.field;
  switch (column.kind) {
    case Column::Kind::kText:
      if (column.index < record.texts(field))
        row += common::csv_cell(record.text(field, column.index));
      break;
    case Column::Kind::kBytes:
      row += record.hexadecimal(field, 0, record.used(field));
      break;
    case Column::Kind::kLength:
      row += std::to_string(record.used(field));
      break;
    case Column::Kind::kHash:
      if (column.index < record.used(field)) row += record.hexadecimal(field, column.index, 1);
      break;
    case Column::Kind::kNumber:
      if (column.index < record.used(field)) record.append_number(field, column.index, row);
      break;
  }
}

/// The columns of a described type; blocks of more than kMostBytes are columns of their length.
std::vector<Column> foreign_table(const ForeignColumns& foreign) {
  std::vector<Column> result;
  for (const auto& [key, column] : foreign.columns()) {
    const bool is_long = column.most_bytes > kMostBytes;
    result.push_back({column.path + (is_long ? ".length" : ""), is_long ? "byte" : "",
                      column.member->comment,
                      is_long ? Column::Kind::kLength : Column::Kind::kText});
  }
  return result;
}

/// The table of one channel.
class Table {
 public:
  Table(const ChannelSurvey& channel, const std::filesystem::path& file)
      : columns_(channel.type != nullptr ? columns(*channel.type, channel.widths)
                                         : foreign_table(channel.foreign_columns)),
        out_(file) {
    written_ = {file, channel.channel, 0};
    int place = 0;
    for (const auto& [key, column] : channel.foreign_columns.columns()) places_[key] = place++;
    std::string header = "time,received_utime";
    for (const Column& column : columns_) header += "," + column.name;
    out_.write(header + "\n");
    describe();
  }

  void add(const Message& message) {
    begin_row(message.time, message.event.utime);
    for (const Column& column : columns_) {
      row_ += ',';
      append_cell(message.record, column, row_);
    }
    end_row();
  }

  void add(const ForeignMessage& message) {
    begin_row(message.time, message.event.utime);
    int next = 0;  // columns whose cells are written
    types::each_leaf(message.type, message.event.data, message.event.size,
                     [&](const types::Leaf& leaf) {
                       const int place = places_.at(leaf.key());
                       row_.append(static_cast<std::size_t>(place + 1 - next), ',');
                       next = place + 1;
                       append_leaf(leaf, columns_[static_cast<std::size_t>(place)]);
                     });
    row_.append(columns_.size() - static_cast<std::size_t>(next), ',');
    end_row();
  }

  Written finish() {
    out_.finish();
    return written_;
  }

 private:
  void begin_row(double time, std::int64_t received_utime) {
    row_.clear();
    char text[32];
    std::snprintf(text, sizeof text, "%.6f", time);
    row_ += text;
    row_ += ',';
    row_ += std::to_string(received_utime);
  }

  void end_row() {
    row_ += '\n';
    out_.write(row_);
    ++written_.count;
  }

  void append_leaf(const types::Leaf& leaf, const Column& column) {
    if (column.kind == Column::Kind::kLength)
      row_ += std::to_string(leaf.text().size());
    else if (leaf.what() == types::Leaf::What::kText)
      row_ += common::csv_cell(std::string(leaf.text()));
    else
      leaf.append_to(row_, kMostBytes);
  }

  void describe() const {
    std::filesystem::path file = written_.file;
    file.replace_extension(".columns.csv");
    OutputFile out(file);
    out.write("column,unit,meaning\n");
    out.write("time,s,since the earliest message of all logs\n");
    out.write("received_utime,us,when the log received the message\n");
    for (const Column& column : columns_)
      out.write(column.name + "," + common::csv_cell(column.unit) + "," +
                common::csv_cell(column.meaning) + "\n");
    out.finish();
  }

  std::vector<Column> columns_;
  std::map<std::vector<std::int64_t>, int> places_;  // of the keys of a described type
  OutputFile out_;
  Written written_;
  std::string row_;
};

}  // namespace

std::vector<Written> export_csv(Source& source, const std::filesystem::path& folder) {
  using Key = std::pair<std::string, const void*>;  // channel, and its type
  std::map<Key, Table> tables;
  std::set<std::string> names;
  for (const ChannelSurvey& channel : source.found().channels) {
    if (!source.is_selected(channel) && !source.is_foreign_selected(channel)) continue;
    if (channel.messages == channel.broken) continue;
    if (channel.foreign_columns.is_too_wide()) {
      std::cerr << "skipped: " << channel.channel << " (" << channel.type_name()
                << ") would have more than " << ForeignColumns::kMost
                << " columns; palpate-export mcap writes it\n";
      continue;
    }
    std::string name = common::file_name(channel.channel);
    while (!names.insert(name).second) name += "_" + common::file_name(channel.type_name());
    tables.try_emplace({channel.channel, channel.type_address()}, channel,
                       folder / (name + ".csv"));
  }
  source.each(
      "writing CSV",
      [&tables](const Message& message) {
        tables.at({message.event.channel, &message.record.type()}).add(message);
      },
      [&tables](const ForeignMessage& message) {
        const auto table = tables.find({message.event.channel, &message.type});
        if (table != tables.end()) table->second.add(message);
      });
  std::vector<Written> written;
  for (auto& [key, table] : tables) written.push_back(table.finish());
  return written;
}

}  // namespace palpate::exporting
