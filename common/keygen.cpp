// farhand-keygen FILE, or farhand-keygen --certificates DIRECTORY
#include <cstdio>

#include "common/arguments.hpp"
#include "common/certificate_issue.hpp"
#include "common/key_file.hpp"
#include "common/program.hpp"

namespace farhand {
namespace {

constexpr std::uint64_t kDays = Lifetime{}.until, kMostDays = 3650;

void make_one_key(const std::string& file) {
  const Key key = write_new_key(file);
  std::printf(
      "wrote key %s to %s\n"
      "Whoever has it can move the robot. Copy it to the other machine by a way you trust, such\n"
      "as scp -p, and name it in the scene on both: link { key_file: \"%s\" }\n",
      key.name.c_str(), file.c_str(), file.c_str());
}

void make_all_certificates(const std::string& directory, std::uint64_t days) {
  if (days < 1 || days > kMostDays)
    throw std::runtime_error("--days " + std::to_string(days) + " is not from 1 to " +
                             std::to_string(kMostDays));
  const std::string name = write_new_certificates(directory, static_cast<int>(days));
  std::printf(
      "wrote authority %s and certificates of a master, a slave and an observer to %s, valid for\n"
      "%llu days. Copy authority.pem, and of each side NAME.pem and NAME_key.pem, to that side's\n"
      "machine by a way you trust, such as scp -p, and name them in its scene:\n"
      "link { certificates { authority_file: \"authority.pem\" certificate_file: \"master.pem\"\n"
      "                      private_key_file: \"master_key.pem\" } }\n"
      "Then remove the directory. The authority can sign nothing more, its private key is gone:\n"
      "for another machine, or if a private key is lost, make a new set for all.\n",
      name.c_str(), directory.c_str(), static_cast<unsigned long long>(days));
}

}  // namespace
}  // namespace farhand

int main(int argc, char** argv) {
  using namespace farhand;
  Arguments arguments(
      "A new random key for the link between master and slave, or certificates for it",
      "farhand-keygen");
  std::string file;
  std::optional<std::string> directory;
  std::optional<std::uint64_t> days;
  arguments.option("file", file, "the key to make; a file that exists is left as it is");
  arguments.option(
      "--certificates", directory,
      "make certificates in this directory instead, one each for a master, a slave and an "
      "observer, by a new authority that signs nothing more; a new set is made anew, "
      "and files that exist are left as they are");
  arguments.option("--days", days,
                   "for how long they are valid, " + std::to_string(kDays) + " by default");
  const auto missing = [&] {
    if (file.empty() == !directory) return "either file or --certificates";
    return days && !directory ? "--certificates" : "";
  };
  if (const auto status = arguments.parse(argc, argv, missing)) return *status;
  return run_guarded("farhand-keygen", [&] {
    if (directory)
      make_all_certificates(*directory, days.value_or(kDays));
    else
      make_one_key(file);
    return 0;
  });
}
