#include "cli/arguments/options.h"

#include <fmt/core.h>
#include <spdlog/spdlog.h>

#include <cstdint>
#include <cstdlib>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

namespace bodyopt::cli {

CLI::App& add_verb(CLI::App& parent, const std::string& name, const std::string& description) {
  return *parent.add_subcommand(name, description);
}

template <typename Value>
CLI::Option* add_option(CLI::App& verb, const std::string& name, Value& value, const std::string& description) {
  return verb.add_option(name, value, description);
}

template <typename Text>
CLI::Option* add_option(CLI::App& verb, const std::string& name, Text& value, const std::string& type,
                        const std::string& description) {
  CLI::Option* option = add_option(verb, name, value, description)->type_name(type);
  if (type.starts_with("FILE.")) return option->check(must_end_in(type.substr(4)));
  return option->check([](const std::string& text) {
    return text.empty() ? std::string("expected a value, found an empty one: a shell variable that is not set?") : "";
  });
}

template <typename Number>
CLI::Option* add_number(CLI::App& verb, const std::string& name, Number& value, double low, double high,
                        const std::string& description) {
  CLI::Option* option = add_option(verb, name, value, description)->capture_default_str();
  if constexpr (std::is_integral_v<Number>) {
    return option->check(CLI::Range(static_cast<int>(low), static_cast<int>(high)));
  } else {
    return option->check(number_from(low, high));
  }
}

CLI::Option* add_flag(CLI::App& verb, const std::string& name, bool& value, const std::string& description) {
  return verb.add_flag(name, value, description);
}

void add_former_option(CLI::App& verb, const std::string& name, const std::string& since) {
  const auto warn = [=](const std::string&) { spdlog::warn("{} has no effect any more: {}", name, since); };
  verb.add_option_function<std::string>(name, warn)->group("");  // not among the help's
}

std::function<std::string(const std::string&)> number_from(double low, double high) {
  return [low, high](const std::string& text) {
    const char* begin = text.c_str();
    char* end = nullptr;
    const double value = std::strtod(begin, &end);
    const bool is_number = end == begin + text.size() && !text.empty();
    return is_number && value >= low && value <= high
               ? std::string()
               : fmt::format("expected a number from {:g} to {:g}, found '{}'", low, high, text);
  };
}

std::string above_zero(const std::string& text) {
  const bool is_one =
      number_from(std::numeric_limits<double>::denorm_min(), std::numeric_limits<double>::max())(text).empty();
  return is_one ? "" : "expected a number above 0, found '" + text + "'";
}

std::function<std::string(const std::string&)> must_end_in(const std::string& extension) {
  return [extension](const std::string& name) {
    return name.ends_with(extension) ? std::string() : "'" + name + "' does not end in " + extension;
  };
}

template CLI::Option* add_option(CLI::App&, const std::string&, int&, const std::string&);
template CLI::Option* add_option(CLI::App&, const std::string&, std::int64_t&, const std::string&);
template CLI::Option* add_option(CLI::App&, const std::string&, unsigned&, const std::string&);
template CLI::Option* add_option(CLI::App&, const std::string&, std::uint64_t&, const std::string&);
template CLI::Option* add_option(CLI::App&, const std::string&, float&, const std::string&);
template CLI::Option* add_option(CLI::App&, const std::string&, double&, const std::string&);
template CLI::Option* add_option(CLI::App&, const std::string&, std::string&, const std::string&);
template CLI::Option* add_option(CLI::App&, const std::string&, std::optional<int>&, const std::string&);
template CLI::Option* add_option(CLI::App&, const std::string&, std::optional<std::uint16_t>&, const std::string&);
template CLI::Option* add_option(CLI::App&, const std::string&, std::vector<unsigned>&, const std::string&);
template CLI::Option* add_option(CLI::App&, const std::string&, std::vector<float>&, const std::string&);
template CLI::Option* add_option(CLI::App&, const std::string&, std::vector<double>&, const std::string&);
template CLI::Option* add_option(CLI::App&, const std::string&, std::vector<std::string>&, const std::string&);
template CLI::Option* add_option(CLI::App&, const std::string&, std::vector<std::pair<std::string, std::string>>&,
                                 const std::string&);

template CLI::Option* add_option(CLI::App&, const std::string&, std::string&, const std::string&, const std::string&);
template CLI::Option* add_option(CLI::App&, const std::string&, std::vector<std::string>&, const std::string&,
                                 const std::string&);

template CLI::Option* add_number(CLI::App&, const std::string&, int&, double, double, const std::string&);
template CLI::Option* add_number(CLI::App&, const std::string&, std::int64_t&, double, double, const std::string&);
template CLI::Option* add_number(CLI::App&, const std::string&, unsigned&, double, double, const std::string&);
template CLI::Option* add_number(CLI::App&, const std::string&, float&, double, double, const std::string&);
template CLI::Option* add_number(CLI::App&, const std::string&, double&, double, double, const std::string&);

}  // namespace bodyopt::cli
