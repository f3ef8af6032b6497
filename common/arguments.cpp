#include "common/arguments.hpp"

#include <CLI/CLI.hpp>

namespace farhand {
namespace {

constexpr int kUsageError = 2;

// Empty if good, as the parser wants it.
std::string check_duration(const std::string& text) {
  double seconds = 0;
  if (CLI::detail::lexical_cast(text, seconds) && seconds >= 0.001 && seconds <= 1e7) return "";
  return "'" + text + "' is not a number of seconds from 0.001 to 1e7";
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
void Arguments::duration(double& seconds, const std::string& help) {
  app_->add_option("--duration", seconds, help)->type_name("SECONDS")->check(check_duration);
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
