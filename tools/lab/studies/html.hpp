#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace palpate::studies {

/// Escapes text for HTML: & < > " ' as entities.
std::string escaped(const std::string& text);

/// A self-contained HTML page.
class HtmlPage {
 public:
  explicit HtmlPage(const std::string& title);

  void heading(int level, const std::string& text);
  void paragraph(const std::string& text);
  void list(const std::vector<std::string>& items);
  /// Table cells of text; a row of one cell spans the table as a title. Missing cells stay empty.
  void table(const std::vector<std::string>& header,
             const std::vector<std::vector<std::string>>& rows);
  /// PNG or SVG, by its name, embedded in the page; one line of text if it cannot be read.
  void picture(const std::filesystem::path& file, const std::string& caption);
  /// Monospaced text with line breaks preserved.
  void preformatted(const std::string& text);

  /// The whole page.
  std::string text() const { return body_ + "</body>\n</html>\n"; }

 private:
  std::string body_;
};

}  // namespace palpate::studies
