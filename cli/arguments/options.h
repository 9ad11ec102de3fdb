// Verbs and their options are declared through functions that are compiled once: CLI11 is headers alone, and all of it
// would be compiled again with every verb.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace bodyopt::cli {

// A verb of the program, or a verb below one.
CLI::App& add_verb(CLI::App& parent, const std::string& name, const std::string& description);

// `value` takes what the user gives; its types are those that options.cpp lists.
template <typename Value>
CLI::Option* add_option(CLI::App& verb, const std::string& name, Value& value, const std::string& description);

CLI::Option* add_flag(CLI::App& verb, const std::string& name, bool& value, const std::string& description);

}  // namespace bodyopt::cli
