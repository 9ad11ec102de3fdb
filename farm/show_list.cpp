#include "farm/show_list.h"

#include <algorithm>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <sstream>

#include "base/json_file.h"
#include "runtime/basis/read_file.h"
#include "runtime/core/error.h"
#include "runtime/core/json.h"
#include "runtime/core/text.h"

namespace bodyopt::farm {
namespace {

namespace fs = std::filesystem;

constexpr char kShotsSchema[] = "bodyopt-shots-1";
constexpr std::uint64_t kLargestList = 256 << 20;  // bytes

enum class Kind { text, path, clip, number, flag, numbers };

struct Key {
  const char* name;
  Kind kind;
};

// A former mode of the jiggle had this key: it is read, and left out.
constexpr char kFormerKey[] = "iterations";

// clang-format off
// Those of `eval` are its options, with "_" for "-".
constexpr Key kKeys[] = {{"shot", Kind::text},           {"element", Kind::text},
                         {"basis", Kind::path},          {"clip", Kind::clip},
                         {"frames", Kind::text},         {"out", Kind::path},
                         {"frame_ms", Kind::number},     {"level", Kind::number},
                         {"full_skin", Kind::flag},      {"device", Kind::text},
                         {"fps", Kind::number},          {"first_frame", Kind::number},
                         {"unit", Kind::number},         {"controls", Kind::path},
                         {"joint_map", Kind::path},      {"attached", Kind::path},
                         {"jiggle", Kind::flag},         {"dynamics", Kind::path},
                         {"cuts", Kind::text},           {"preroll", Kind::number},
                         {kFormerKey, Kind::number},     {"gravity_change", Kind::numbers},
                         {"require_device", Kind::flag}, {"modifiers", Kind::path},
                         {"up", Kind::text},             {"session", Kind::path},
                         {"character", Kind::path},      {"rigged", Kind::flag}};
// clang-format on

using Values = std::map<std::string, std::vector<std::string>>;  // by key; flags that are off are left out

std::string absolute(const fs::path& folder, const std::string& path) {
  return fs::absolute(folder / path).lexically_normal().string();
}

bool is_number(const std::string& text) {
  char* end = nullptr;
  std::strtod(text.c_str(), &end);
  return !text.empty() && end == text.c_str() + text.size();
}

// A value as the words of a command line. Throws Error(usage) with what was expected.
std::vector<std::string> words_of(const Json& value) {
  if (value.is_string()) return {value.get<std::string>()};
  if (value.is_boolean()) return {value.get<bool>() ? "true" : "false"};
  if (value.is_number()) return {value.dump()};
  if (!value.is_array())
    throw Error(ErrorKind::usage, "is ", value.dump().substr(0, 40), ", expected a text or a number");
  std::vector<std::string> words;
  for (const Json& item : value) {
    if (!item.is_number()) throw Error(ErrorKind::usage, "is a list of something else than numbers");
    words.push_back(item.dump());
  }
  return words;
}

const Key& known_key(const std::string& name) {
  const auto* key = std::find_if(std::begin(kKeys), std::end(kKeys), [&](const Key& k) { return name == k.name; });
  if (key == std::end(kKeys)) throw Error(ErrorKind::usage, "the key '", name, "' is unknown: misspelt?");
  return *key;
}

// Puts a value under its key, checked for its kind.
void set_value(Values& values, const std::string& name, std::vector<std::string> words, const fs::path& folder) {
  const Key& key = known_key(name);
  const auto fail = [&](const auto&... expected) {
    throw Error(ErrorKind::usage, "'", name, "' is '", words.front().substr(0, 60), "', expected ", expected...);
  };
  for (const std::string& word : words) {
    if (word.find('\0') != std::string::npos) fail("a text without zero bytes");
    if (word.starts_with("--")) fail("a value, not what looks like an option");
  }
  if (words.empty()) throw Error(ErrorKind::usage, "'", name, "' is empty");
  if (key.kind == Kind::flag) {
    if (words.front() != "true" && words.front() != "false") fail("true or false");
    if (words.front() == "true") {
      values[name] = {};
    } else {
      values.erase(name);
    }
    return;
  }
  if (key.kind == Kind::numbers && words.size() == 1) {  // of a CSV: "0 -1 0"
    std::istringstream text(words.front());
    words.clear();
    for (std::string word; text >> word;) words.push_back(word);
  }
  const bool is_numeric = key.kind == Kind::number || key.kind == Kind::numbers;
  if (is_numeric && !std::ranges::all_of(words, is_number)) fail("a number");
  if (key.kind != Kind::numbers && words.size() != 1) fail("one value");
  if (words.empty() || words.front().empty()) throw Error(ErrorKind::usage, "'", name, "' is empty");
  if (key.kind == Kind::path || key.kind == Kind::clip) words.front() = absolute(folder, words.front());
  values[name] = words;
}

std::string take(Values& values, const char* key, bool is_required) {
  const auto found = values.find(key);
  if (found == values.end()) {
    if (is_required) throw Error(ErrorKind::usage, "'", key, "' is missing");
    return "";
  }
  const std::string value = found->second.front();
  values.erase(found);
  return value;
}

// {shot} and {element} in the name of an output. A name may hold anything that a file's name may.
std::string with_names(std::string pattern, const std::string& shot, const std::string& element) {
  for (const auto& [field, name] : {std::pair("{shot}", shot), std::pair("{element}", element)}) {
    for (std::size_t at = 0; (at = pattern.find(field, at)) != std::string::npos; at += name.size()) {
      if (name.find('/') != std::string::npos || name == "..") {
        throw Error(ErrorKind::usage, "the name '", name, "' cannot be part of a file's name, as 'out' asks");
      }
      pattern.replace(at, std::string(field).size(), name);
    }
  }
  return pattern;
}

ShowElement element_from(Values values) {
  ShowElement element;
  element.shot = take(values, "shot", true);
  element.element = take(values, "element", true);
  element.session = take(values, "session", false);
  element.basis = take(values, "basis", element.session.empty());
  element.clip = take(values, "clip", element.session.empty());
  if (!element.session.empty() && !(element.basis + element.clip).empty()) {
    throw Error(ErrorKind::usage, "'session' names the basis and the clip itself: leave out 'basis' and 'clip'");
  }
  element.frames = take(values, "frames", false);
  element.out = with_names(take(values, "out", true), element.shot, element.element);
  const std::string cost = take(values, "frame_ms", false);
  if (!cost.empty()) element.frame_ms = std::atof(cost.c_str());
  if (!(element.frame_ms >= 0 && element.frame_ms < 1e9)) {
    throw Error(ErrorKind::usage, "'frame_ms' is '", cost, "', expected milliseconds, 0 or more");
  }
  for (auto& [key, words] : values) {
    std::string option = key;
    std::ranges::replace(option, '_', '-');
    element.options[option] = words;
  }
  return element;
}

class ListReader {
 public:
  ListReader(const fs::path& path, std::vector<std::string>& problems)
      : path_(path), folder_(fs::absolute(path).parent_path()), problems_(problems) {}

  void set_defaults(const Json& object, const std::string& place) {
    try_to(place, [&] { put(defaults_, object); });
  }
  void add(const Json& object, const std::string& place) {
    try_to(place, [&] {
      Values values = defaults_for(object.is_object() && object.contains("session"));
      put(values, object);
      finish(values, place);
    });
  }
  // A row of texts: those that are empty are as by default; of shot "*": defaults for the rows below.
  void add_row(const std::vector<std::string>& keys, const std::vector<std::string>& row, const std::string& place) {
    try_to(place, [&] {
      if (row.size() != keys.size()) {
        throw Error(ErrorKind::usage, "has ", row.size(), " values, and there are ", keys.size(), " columns");
      }
      const auto session = std::ranges::find(keys, "session") - keys.begin();
      Values values = defaults_for(session < std::ssize(keys) && !row[static_cast<std::size_t>(session)].empty());
      for (std::size_t k = 0; k < keys.size(); ++k) {
        if (!row[k].empty()) set_value(values, keys[k], {row[k]}, folder_);
      }
      const auto shot = values.find("shot");
      if (shot == values.end() || shot->second.front() != "*") return finish(values, place);
      values.erase(shot);
      defaults_ = values;
    });
  }

  ShowList list;

 private:
  template <typename Body>
  void try_to(const std::string& place, const Body& body) {
    try {
      body();
    } catch (const Error& error) {
      problems_.push_back(path_.string() + ": " + place + ": " + error.what());
    }
  }
  // A session stands in place of the basis and the clip that are by default.
  Values defaults_for(bool of_session) const {
    Values values = defaults_;
    for (const char* key : {"basis", "clip"}) {
      if (of_session) values.erase(key);
    }
    return values;
  }
  void put(Values& values, const Json& object) const {
    if (!object.is_object()) throw Error(ErrorKind::usage, "is not an object");
    for (const auto& [key, value] : object.items()) set_value(values, key, words_of(value), folder_);
  }
  void finish(Values values, const std::string& place) {
    if (values.erase(kFormerKey) > 0 && list.notes.empty()) {
      list.notes.push_back(path_.string() + ": '" + kFormerKey +
                           "' has no effect any more: the jiggle has one way to solve");
    }
    ShowElement element = element_from(values);
    element.place = place;
    list.elements.push_back(std::move(element));
  }

  fs::path path_, folder_;
  std::vector<std::string>& problems_;
  Values defaults_;
};

void read_object(const std::string& text, const fs::path& path, ListReader& reader) {
  const Json json = parse_strict_json(text, path.string());
  const JsonObject top(json, path, "the top level");
  if (!top.has("schema") || top.text("schema") != kShotsSchema) top.refuse("lacks \"schema\": \"", kShotsSchema, "\"");
  top.allow({"schema", "show", "defaults", "elements"});
  if (top.has("show")) reader.list.show = top.name("show");
  if (top.has("defaults")) reader.set_defaults(json["defaults"], "defaults");
  const Json& elements = top.array("elements");
  for (std::size_t k = 0; k < elements.size(); ++k) reader.add(elements[k], "elements[" + std::to_string(k) + "]");
}

void read_lines(const std::string& text, const fs::path& path, ListReader& reader) {
  std::istringstream lines(text);
  std::size_t number = 0;
  for (std::string line; std::getline(lines, line);) {
    const std::string place = "line " + std::to_string(++number);
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    const Json object = parse_strict_json(line, path.string() + ": " + place);
    if (object.is_object() && object.contains("defaults") && object.size() == 1) {
      reader.set_defaults(object["defaults"], place);
    } else {
      reader.add(object, place);
    }
  }
}

// Where commas are decimal, programs write other separators into a .csv. No key has these in its name.
void require_commas(const std::vector<std::string>& keys, const fs::path& path) {
  for (const auto& [separator, name] : {std::pair(';', "semicolons"), {'\t', "tabs"}}) {
    const auto has_it = [mark = separator](const std::string& key) { return key.find(mark) != std::string::npos; };
    if (std::ranges::none_of(keys, has_it)) continue;
    throw Error(ErrorKind::file, path, ": row 1: its columns are separated by ", name, ", expected commas: ",
                "was it written where a comma stands before decimals? Write it with commas, or a .json");
  }
}

void read_csv(const std::string& text, const fs::path& path, ListReader& reader) {
  const auto rows = parse_csv(text, path.string());
  require_commas(rows[0], path);
  for (std::size_t k = 1; k < rows.size(); ++k) reader.add_row(rows[0], rows[k], "row " + std::to_string(k + 1));
}

}  // namespace

std::string ShowElement::option(const char* name, const std::string& otherwise) const {
  const auto found = options.find(name);
  return found == options.end() || found->second.empty() ? otherwise : found->second.front();
}

ShowList read_show_list(const fs::path& path, std::vector<std::string>& problems) {
  const std::string text(without_mark(read_file(path, kLargestList, "a list of shots")));
  ListReader reader(path, problems);
  reader.list.show = path.stem().string();
  if (path.extension() == ".jsonl") {
    read_lines(text, path, reader);
  } else if (path.extension() == ".csv") {
    read_csv(text, path, reader);
  } else {
    read_object(text, path, reader);
  }
  return std::move(reader.list);
}

std::vector<std::vector<std::string>> parse_csv(const std::string& text, const std::string& origin) {
  std::vector<std::vector<std::string>> rows;
  std::vector<std::string> row;
  std::string field;
  bool is_quoted = false, was_quoted = false;
  const auto end_field = [&] {
    row.push_back(std::move(field));
    field.clear();
    was_quoted = false;
  };
  const auto end_row = [&] {
    const bool is_blank = row.empty() && field.empty() && !was_quoted;
    end_field();
    if (!is_blank) rows.push_back(row);
    row.clear();
  };
  for (std::size_t k = 0; k < text.size(); ++k) {
    const char c = text[k];
    if (is_quoted) {
      if (c != '"') {
        field += c;
      } else if (k + 1 < text.size() && text[k + 1] == '"') {
        field += text[++k];
      } else {
        is_quoted = false;
      }
    } else if (c == '"' && field.empty() && !was_quoted) {
      is_quoted = was_quoted = true;
    } else if (c == ',') {
      end_field();
    } else if (c == '\n') {
      end_row();
    } else if (c != '\r') {
      field += c;
    }
  }
  if (is_quoted) throw Error(ErrorKind::file, origin, ": a quotation mark is opened and not closed: cut off?");
  end_row();
  if (rows.empty()) throw Error(ErrorKind::file, origin, ": is empty; expected a row that names the columns");
  return rows;
}

}  // namespace bodyopt::farm
