#include "tools/export/csv_export.hpp"

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

/// The table of one channel.
class Table {
 public:
  Table(const ChannelSurvey& channel, const std::filesystem::path& file)
      : columns_(columns(*channel.type, channel.widths)), out_(file) {
    written_ = {file, channel.channel, 0};
    std::string header = "time,received_utime";
    for (const Column& column : columns_) header += "," + column.name;
    out_.write(header + "\n");
    describe();
  }

  void add(const Message& message) {
    row_.clear();
    char time[32];
    std::snprintf(time, sizeof time, "%.6f", message.time);
    row_ += time;
    row_ += ',';
    row_ += std::to_string(message.event.utime);
    for (const Column& column : columns_) {
      row_ += ',';
      append_cell(message.record, column, row_);
    }
    row_ += '\n';
    out_.write(row_);
    ++written_.count;
  }

  Written finish() {
    out_.finish();
    return written_;
  }

 private:
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
  OutputFile out_;
  Written written_;
  std::string row_;
};

}  // namespace

std::vector<Written> export_csv(Source& source, const std::filesystem::path& folder) {
  using Key = std::pair<std::string, const log::TypeInfo*>;
  std::map<Key, Table> tables;
  std::set<std::string> names;
  for (const ChannelSurvey& channel : source.found().channels) {
    if (!source.is_selected(channel) || channel.messages == channel.broken) continue;
    std::string name = common::file_name(channel.channel);
    while (!names.insert(name).second) name += "_" + channel.type->name;
    tables.try_emplace({channel.channel, channel.type}, channel, folder / (name + ".csv"));
  }
  source.each("writing CSV", [&tables](const Message& message) {
    tables.at({message.event.channel, &message.record.type()}).add(message);
  });
  std::vector<Written> written;
  for (auto& [key, table] : tables) written.push_back(table.finish());
  return written;
}

}  // namespace palpate::exporting
