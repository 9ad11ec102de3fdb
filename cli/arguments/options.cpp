#include "cli/arguments/options.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace bodyopt::cli {

CLI::App& add_verb(CLI::App& parent, const std::string& name, const std::string& description) {
  return *parent.add_subcommand(name, description);
}

template <typename Value>
CLI::Option* add_option(CLI::App& verb, const std::string& name, Value& value, const std::string& description) {
  return verb.add_option(name, value, description);
}

CLI::Option* add_flag(CLI::App& verb, const std::string& name, bool& value, const std::string& description) {
  return verb.add_flag(name, value, description);
}

template CLI::Option* add_option(CLI::App&, const std::string&, bool&, const std::string&);
template CLI::Option* add_option(CLI::App&, const std::string&, int&, const std::string&);
template CLI::Option* add_option(CLI::App&, const std::string&, unsigned&, const std::string&);
template CLI::Option* add_option(CLI::App&, const std::string&, std::uint64_t&, const std::string&);
template CLI::Option* add_option(CLI::App&, const std::string&, double&, const std::string&);
template CLI::Option* add_option(CLI::App&, const std::string&, std::string&, const std::string&);
template CLI::Option* add_option(CLI::App&, const std::string&, std::filesystem::path&, const std::string&);
template CLI::Option* add_option(CLI::App&, const std::string&, std::optional<int>&, const std::string&);
template CLI::Option* add_option(CLI::App&, const std::string&, std::optional<double>&, const std::string&);
template CLI::Option* add_option(CLI::App&, const std::string&, std::optional<std::uint16_t>&, const std::string&);
template CLI::Option* add_option(CLI::App&, const std::string&, std::optional<std::string>&, const std::string&);
template CLI::Option* add_option(CLI::App&, const std::string&, std::vector<int>&, const std::string&);
template CLI::Option* add_option(CLI::App&, const std::string&, std::vector<unsigned>&, const std::string&);
template CLI::Option* add_option(CLI::App&, const std::string&, std::vector<float>&, const std::string&);
template CLI::Option* add_option(CLI::App&, const std::string&, std::vector<double>&, const std::string&);
template CLI::Option* add_option(CLI::App&, const std::string&, std::vector<std::string>&, const std::string&);

}  // namespace bodyopt::cli
