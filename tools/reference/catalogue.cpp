#include "tools/reference/catalogue.hpp"

#include <algorithm>
#include <cctype>

namespace palpate::reference {
namespace {

/// Keys whose value decides which other keys of their section are read.
const std::set<std::string> kDeciding = {"component", "law", "kind", "integrator", "action"};

using Choices = std::map<std::string, std::string>;

/// One mapping of one document: its choices, and the keys that were read.
struct Visit {
  Choices choices;
  std::vector<config::Declaration> declarations;
};

/// "sensing.0.payload" is an instance of "sensing[].payload".
std::string pattern_of(const std::string& path) {
  std::string pattern;
  std::size_t begin = 0;
  while (begin <= path.size() && !path.empty()) {
    const std::size_t end = std::min(path.find('.', begin), path.size());
    const std::string part = path.substr(begin, end - begin);
    if (std::all_of(part.begin(), part.end(), [](unsigned char c) { return std::isdigit(c); })) {
      pattern += "[]";
    } else {
      pattern += (pattern.empty() ? "" : ".") + part;
    }
    begin = end + 1;
  }
  return pattern;
}

std::vector<Visit> visits_of(const std::vector<Declarations>& readings,
                             const std::string& pattern) {
  std::vector<Visit> visits;
  for (const Declarations& reading : readings) {
    std::map<std::string, Visit> here;
    for (const config::Declaration& declaration : reading) {
      if (pattern_of(declaration.path) != pattern) continue;
      Visit& visit = here[declaration.path];
      if (declaration.type == "one of") visit.choices[declaration.name] = declaration.value;
      visit.declarations.push_back(declaration);
    }
    for (auto& [path, visit] : here) visits.push_back(std::move(visit));
  }
  return visits;
}

/// The same parameter, not only one of the same name.
bool is_same(const config::Declaration& a, const config::Declaration& b) {
  // A range may depend on keys read before; the words of a choice do not.
  return a.name == b.name && a.meaning == b.meaning &&
         (a.type != "one of" || a.allowed == b.allowed);
}

const config::Declaration* find(const Visit& visit, const config::Declaration& wanted) {
  for (const config::Declaration& declaration : visit.declarations)
    if (is_same(declaration, wanted)) return &declaration;
  return nullptr;
}

/// Values of `choice` in the visits that satisfy `condition`.
template <class Condition>
std::set<std::string> values(const std::vector<Visit>& visits, const std::string& choice,
                             Condition condition) {
  std::set<std::string> found;
  for (const Visit& visit : visits) {
    const auto value = visit.choices.find(choice);
    if (value != visit.choices.end() && condition(visit)) found.insert(value->second);
  }
  return found;
}

bool holds(const Parameter& parameter, const Visit& visit) {
  for (const auto& [choice, allowed] : parameter.only_with) {
    const auto value = visit.choices.find(choice);
    if (value == visit.choices.end() || allowed.count(value->second) == 0) return false;
  }
  return true;
}

Parameter describe(const config::Declaration& first, const std::vector<Visit>& visits) {
  Parameter parameter;
  parameter.name = first.name;
  parameter.type = first.type;
  parameter.unit = first.unit;
  parameter.allowed = first.allowed;
  parameter.meaning = first.meaning;
  parameter.range = first.range;
  parameter.choices = first.choices;
  const auto asked = [&](const Visit& visit) { return find(visit, first) != nullptr; };
  std::set<std::string> choices;
  for (const Visit& visit : visits)
    for (const auto& choice : visit.choices)
      if (kDeciding.count(choice.first) != 0) choices.insert(choice.first);
  for (const std::string& choice : choices) {
    const std::set<std::string> with = values(visits, choice, asked);
    const std::set<std::string> all = values(visits, choice, [](const Visit&) { return true; });
    if (choice != first.name && !with.empty() && with != all) parameter.only_with[choice] = with;
  }
  parameter.required = true;
  for (const Visit& visit : visits) {
    const config::Declaration* declaration = find(visit, first);
    if (declaration == nullptr) {
      // Not read although it might have been: a reader that first checks whether the key is
      // present.
      if (holds(parameter, visit)) parameter.required = false;
      continue;
    }
    parameter.required = parameter.required && declaration->required;
    parameter.range.lower = std::min(parameter.range.lower, declaration->range.lower);
    parameter.range.upper = std::max(parameter.range.upper, declaration->range.upper);
    if (!declaration->fallback.empty() &&
        std::count(parameter.defaults.begin(), parameter.defaults.end(), declaration->fallback) ==
            0)
      parameter.defaults.push_back(declaration->fallback);
  }
  return parameter;
}

void sort_by_tree(std::vector<Section>& sections) {
  std::vector<Section> sorted;
  const auto place = [&](const auto& self, const std::string& parent) -> void {
    for (const Section& section : sections) {
      const std::size_t dot = section.path.rfind('.');
      const std::string above = dot == std::string::npos ? "" : section.path.substr(0, dot);
      if (section.path.empty() || above != parent) continue;
      sorted.push_back(section);
      self(self, section.path);
    }
  };
  for (const Section& section : sections)
    if (section.path.empty()) sorted.push_back(section);
  place(place, "");
  sections = std::move(sorted);
}

bool is_fallback(const std::string& path) {
  return path.size() > 9 && path.substr(path.size() - 9) == ".fallback";
}

/// Keys that an arm shares with the first one are documented once.
bool is_of_both_arms(const Section& section, const std::vector<Section>& sections) {
  const std::string arm = "second_arm.";
  if (section.path.compare(0, arm.size(), arm) != 0) return false;
  const auto same = [](const Parameter& a, const Parameter& b) {
    return a.name == b.name && a.type == b.type && a.meaning == b.meaning && a.allowed == b.allowed;
  };
  return std::any_of(sections.begin(), sections.end(), [&](const Section& other) {
    return other.path == section.path.substr(arm.size()) &&
           std::all_of(section.parameters.begin(), section.parameters.end(), [&](const auto& own) {
             return std::any_of(other.parameters.begin(), other.parameters.end(),
                                [&](const auto& known) { return same(own, known); });
           });
  });
}

/// Sections whose keys are names given by the document: a fit's parameters, and a study's methods.
bool has_names_for_keys(const std::string& path) {
  return path == "parameters" ||
         (path.size() > 5 && path.compare(path.size() - 5, 5, ".also") == 0);
}

}  // namespace

Declarations without_names(Declarations declarations) {
  const std::string columns = "columns.";
  for (config::Declaration& declaration : declarations) {
    const std::size_t at = declaration.path.find(columns);
    if (at != std::string::npos)
      declaration.path.replace(at + columns.size(), std::string::npos, "QUANTITY");
    if (has_names_for_keys(declaration.path)) {
      declaration.name = "NAME";
    } else if (declaration.path.rfind("parameters.", 0) == 0) {
      declaration.path = "parameters.NAME";
    }
  }
  return declarations;
}

Declarations declared_by(const std::string& file, const std::function<void()>& read) {
  config::DeclarationList list;
  read();
  Declarations own;
  for (const config::Declaration& declaration : list.all())
    if (declaration.document == file) own.push_back(declaration);
  return without_names(own);
}

std::vector<Section> all_sections(const std::vector<Declarations>& readings) {
  std::vector<Section> sections;
  for (const Declarations& reading : readings) {
    for (const config::Declaration& declaration : reading) {
      const std::string pattern = pattern_of(declaration.path);
      const auto known = std::find_if(sections.begin(), sections.end(),
                                      [&](const Section& s) { return s.path == pattern; });
      if (known == sections.end()) sections.push_back({pattern, {}});
    }
  }
  for (Section& section : sections) {
    const std::vector<Visit> visits = visits_of(readings, section.path);
    std::vector<config::Declaration> seen;
    for (const Visit& visit : visits) {
      for (const config::Declaration& declaration : visit.declarations) {
        // Any component may have one.
        if (declaration.name == "fallback" && declaration.type == "section") continue;
        if (std::any_of(seen.begin(), seen.end(),
                        [&](const auto& known) { return is_same(known, declaration); }))
          continue;
        seen.push_back(declaration);
        section.parameters.push_back(describe(declaration, visits));
      }
    }
  }
  sort_by_tree(sections);
  sections.erase(std::remove_if(sections.begin(), sections.end(),
                                [](const Section& s) { return is_fallback(s.path); }),
                 sections.end());
  return sections;
}

std::vector<Section> merge(const std::vector<Declarations>& readings) {
  std::vector<Section> sections = all_sections(readings);
  const std::vector<Section> all = sections;
  sections.erase(std::remove_if(sections.begin(), sections.end(),
                                [&](const Section& s) { return is_of_both_arms(s, all); }),
                 sections.end());
  return sections;
}

std::vector<std::string> undescribed(const std::vector<Section>& sections) {
  std::vector<std::string> names;
  for (const Section& section : sections)
    for (const Parameter& parameter : section.parameters)
      if (parameter.meaning.empty())
        names.push_back(section.path + (section.path.empty() ? "" : ".") + parameter.name);
  return names;
}

}  // namespace palpate::reference
