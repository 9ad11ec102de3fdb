// Verbs and their options are declared through functions that are compiled once: CLI11 is headers alone, and all of it
// would be compiled again with every verb.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <memory>
#include <string>
#include <type_traits>

namespace bodyopt::cli {

// A verb of the program, or a verb below one.
CLI::App& add_verb(CLI::App& parent, const std::string& name, const std::string& description);

// One with arguments of its own, which live as long as it does; it runs with them. `Parameter`: as `run` takes them.
template <typename Arguments>
struct DeclaredVerb {
  CLI::App& verb;
  Arguments& arguments;
};
template <typename Arguments, typename Parameter = const Arguments&>
DeclaredVerb<Arguments> add_verb(CLI::App& parent, const std::string& name, const std::string& description,
                                 void (*run)(std::type_identity_t<Parameter>)) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App& verb = add_verb(parent, name, description);
  verb.callback([arguments, run] { run(*arguments); });
  return {verb, *arguments};
}

// `value` takes what the user gives; its types are those that options.cpp lists.
template <typename Value>
CLI::Option* add_option(CLI::App& verb, const std::string& name, Value& value, const std::string& description);

// The same of text that may not be empty: that is most likely a shell variable that is not set, and must not mean the
// default. `type`: as the help calls it; "FILE.png" is a name that ends in .png: a slip must not overwrite a character.
template <typename Text>
CLI::Option* add_option(CLI::App& verb, const std::string& name, Text& value, const std::string& type,
                        const std::string& description);

// One that must be given. `type`: as the help calls it.
template <typename Value>
CLI::Option* add_required(CLI::App& verb, const std::string& name, Value& value, const std::string& type,
                          const std::string& description) {
  return add_option(verb, name, value, description)->required()->type_name(type);
}

// A number, finite, within these ends; the help shows its default.
template <typename Number>
CLI::Option* add_number(CLI::App& verb, const std::string& name, Number& value, double low, double high,
                        const std::string& description);

CLI::Option* add_flag(CLI::App& verb, const std::string& name, bool& value, const std::string& description);

// An option that earlier versions had: it takes a value and says on standard error that it has no effect, since...
void add_former_option(CLI::App& verb, const std::string& name, const std::string& since);

// Checks of options give what is wrong, or nothing. A number, finite, within these ends.
std::function<std::string(const std::string&)> number_from(double low, double high);

// A number above 0 and finite, which CLI11 does not ask of "nan".
std::string above_zero(const std::string& text);

// A file's name that ends as said.
std::function<std::string(const std::string&)> must_end_in(const std::string& extension);

}  // namespace bodyopt::cli
