#include "common/arguments.hpp"

#include <CLI/CLI.hpp>
#include <cstdio>

namespace farhand {
namespace {

constexpr int kUsageError = 2;

std::string in_words(double number) {
  char out[32];
  std::snprintf(out, sizeof out, "%g", number);
  return out;
}

// Empty if good, as the parser wants it.
std::string check_number(const std::string& text, const NumberRange& range) {
  double number = 0;
  if (CLI::detail::lexical_cast(text, number) && number >= range.least && number <= range.most)
    return "";
  return "'" + text + "' is not a number " + (range.of.empty() ? "" : "of " + range.of + " ") +
         "from " + in_words(range.least) + " to " + in_words(range.most);
}

}  // namespace

Arguments::Arguments(const std::string& description, const std::string& program)
    : app_(std::make_unique<CLI::App>(description, program)) {}
Arguments::~Arguments() = default;

void Arguments::flag(const std::string& name, bool& to, const std::string& help) {
  app_->add_flag(name, to, help);
}
void Arguments::option(const std::string& name, std::string& to, const std::string& help) {
  app_->add_option(name, to, help);
}
void Arguments::option(const std::string& name, std::optional<std::string>& to,
                       const std::string& help) {
  app_->add_option(name, to, help);
}
void Arguments::option(const std::string& name, std::optional<std::uint64_t>& to,
                       const std::string& help) {
  app_->add_option(name, to, help);
}
void Arguments::option(const std::string& name, std::vector<std::string>& to,
                       const std::string& help) {
  app_->add_option(name, to, help);
}
void Arguments::number(const std::string& name, double& to, const NumberRange& range,
                       const std::string& help) {
  app_->add_option(name, to, help)
      ->type_name(range.of.empty() ? "number" : range.of)
      ->check([range](const std::string& text) { return check_number(text, range); });
}
void Arguments::duration(double& seconds, const std::string& help) {
  number("--duration", seconds, {.least = 0.001, .most = 1e7, .of = "seconds"}, help);
}

std::optional<int> Arguments::parse(int argc, char** argv,
                                    const std::function<std::string()>& missing) {
  try {
    app_->parse(argc, argv);
    if (const std::string what = missing(); !what.empty()) throw CLI::RequiredError(what);
  } catch (const CLI::ParseError& e) {
    return app_->exit(e) == 0 ? 0 : kUsageError;
  }
  return {};
}

}  // namespace farhand
