// Verbs and their options are declared through functions that are compiled once: CLI11 is headers alone, and all of it
// would be compiled again with every verb.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>

namespace bodyopt::cli {

// A verb of the program, or a verb below one.
CLI::App& add_verb(CLI::App& parent, const std::string& name, const std::string& description);

// `value` takes what the user gives; its types are those that options.cpp lists.
template <typename Value>
CLI::Option* add_option(CLI::App& verb, const std::string& name, Value& value, const std::string& description);

// The same of text that may not be empty: that is most likely a shell variable that is not set, and must not mean the
// default. `type`: as the help calls it; "FILE.png" is a name that ends in .png: a slip must not overwrite a character.
template <typename Text>
CLI::Option* add_option(CLI::App& verb, const std::string& name, Text& value, const std::string& type,
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
