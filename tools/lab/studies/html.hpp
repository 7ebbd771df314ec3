#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace palpate::studies {

/// Text for HTML: & < > " ' as entities, so that nothing of it is markup.
std::string escaped(const std::string& text);

/// One page that needs no other file.
class HtmlPage {
 public:
  explicit HtmlPage(const std::string& title);

  void heading(int level, const std::string& text);
  void paragraph(const std::string& text);
  void list(const std::vector<std::string>& items);
  /// Cells of text; a row of one cell is a title across. Missing cells stay empty.
  void table(const std::vector<std::string>& header,
             const std::vector<std::vector<std::string>>& rows);
  /// PNG or SVG, by its name, put into the page; one line of text where it cannot be read.
  void picture(const std::filesystem::path& file, const std::string& caption);
  /// Monospaced text, its lines kept.
  void preformatted(const std::string& text);

  /// The whole page.
  std::string text() const { return body_ + "</body>\n</html>\n"; }

 private:
  std::string body_;
};

}  // namespace palpate::studies
