// Command-line arguments. A thin face before the argument parser, whose header is dear to compile:
// this is the one place that includes it.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace farhand {

struct NumberRange {
  double least = 0;
  double most = 0;
  std::string of = "";  // its unit, in words
};

class Arguments {
 public:
  Arguments(const std::string& description, const std::string& program);
  ~Arguments();

  // `name` as typed: "--quiet", "-o,--output"; without dashes it is the word or words that stand
  // alone. Each variable must outlive parse() and keeps its value if the argument is not given.
  void flag(const std::string& name, bool& to, const std::string& help);
  void option(const std::string& name, std::string& to, const std::string& help);
  void option(const std::string& name, std::optional<std::string>& to, const std::string& help);
  void option(const std::string& name, std::optional<std::uint64_t>& to, const std::string& help);
  void option(const std::string& name, std::vector<std::string>& to, const std::string& help);
  // Refuses what is not in the range.
  void number(const std::string& name, double& to, const NumberRange& range,
              const std::string& help);
  // --duration; refuses what is no number of seconds from a millisecond to a few months.
  void duration(double& seconds, const std::string& help);

  // None if the program shall go on, else its exit status: 0 after --help, 2 after arguments that
  // make no sense, which it names on stderr. `missing` says what else should have been given, or
  // nothing; it is asked when every argument that was given is understood.
  std::optional<int> parse(int argc, char** argv, const std::function<std::string()>& missing);

 private:
  std::unique_ptr<CLI::App> app_;
};

}  // namespace farhand
