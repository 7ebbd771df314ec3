#include "tools/lab/studies/html.hpp"

#include <algorithm>
#include <fstream>
#include <sstream>

#include "tools/common/base64.hpp"

namespace palpate::studies {
namespace {

constexpr const char* kStyle =
    "body{font:15px/1.45 sans-serif;max-width:1280px;margin:2em auto;padding:0 1em;color:#222}"
    "table{border-collapse:collapse;margin:1em 0;font-size:13px;display:block;overflow-x:auto}"
    "th,td{border:1px solid #ccc;padding:3px 7px;text-align:right;vertical-align:top}"
    "th{background:#eef1f5}td:first-child,th:first-child{text-align:left}"
    "td.title{background:#f7f7f2;font-weight:bold;text-align:left}"
    "figure{margin:1em 0}img{max-width:100%;border:1px solid #ddd}"
    "figcaption{color:#555}pre{background:#f5f5f5;padding:.6em;overflow-x:auto}";

std::string element(const std::string& name, const std::string& text) {
  return "<" + name + ">" + escaped(text) + "</" + name + ">";
}

}  // namespace

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      case '\'':
        result += "&#39;";
        break;
      default:
        result += c;
    }
  }
  return result;
}

HtmlPage::HtmlPage(const std::string& title)
    : body_("<!DOCTYPE html>\n<html lang=\"en\">\n<head><meta charset=\"utf-8\">" +
            element("title", title) + "<style>" + kStyle + "</style></head>\n<body>\n") {
  heading(1, title);
}

void HtmlPage::heading(int level, const std::string& text) {
  body_ += element("h" + std::to_string(level), text) + "\n";
}

void HtmlPage::paragraph(const std::string& text) { body_ += element("p", text) + "\n"; }

void HtmlPage::list(const std::vector<std::string>& items) {
  body_ += "<ul>\n";
  for (const std::string& item : items) body_ += element("li", item) + "\n";
  body_ += "</ul>\n";
}

void HtmlPage::table(const std::vector<std::string>& header,
                     const std::vector<std::vector<std::string>>& rows) {
  body_ += "<table>\n<tr>";
  for (const std::string& cell : header) body_ += element("th", cell);
  body_ += "</tr>\n";
  for (const std::vector<std::string>& row : rows) {
    body_ += "<tr>";
    if (row.size() == 1 && header.size() > 1) {
      body_ += "<td class=\"title\" colspan=\"" + std::to_string(header.size()) + "\">" +
               escaped(row[0]) + "</td>";
    } else {
      for (std::size_t i = 0; i < header.size(); ++i)
        body_ += element("td", i < row.size() ? row[i] : "");
    }
    body_ += "</tr>\n";
  }
  body_ += "</table>\n";
}

void HtmlPage::picture(const std::filesystem::path& file, const std::string& caption) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream bytes;
  if (!in || !(bytes << in.rdbuf())) {
    paragraph(caption + ": no picture");
    return;
  }
  const std::string type = file.extension() == ".svg" ? "image/svg+xml" : "image/png";
  body_ += "<figure><img alt=\"" + escaped(caption) + "\" src=\"data:" + type + ";base64," +
           common::to_base64(bytes.str()) + "\">" + element("figcaption", caption) + "</figure>\n";
}

void HtmlPage::preformatted(const std::string& text) { body_ += element("pre", text) + "\n"; }

}  // namespace palpate::studies
