// farhand-keygen FILE
#include <cstdio>

#include "common/arguments.hpp"
#include "common/key_file.hpp"
#include "common/program.hpp"

int main(int argc, char** argv) {
  farhand::Arguments arguments("A new random key for the link between master and slave",
                               "farhand-keygen");
  std::string file;
  arguments.option("file", file, "the file to make; one that exists is left as it is");
  const auto missing = [&] { return file.empty() ? "file" : ""; };
  if (const auto status = arguments.parse(argc, argv, missing)) return *status;
  return farhand::run_guarded("farhand-keygen", [&] {
    const farhand::Key key = farhand::write_new_key(file);
    std::printf(
        "wrote key %s to %s\n"
        "Whoever has it can move the robot. Copy it to the other machine by a way you trust, such\n"
        "as scp -p, and name it in the scene on both: link { key_file: \"%s\" }\n",
        key.name.c_str(), file.c_str(), file.c_str());
    return 0;
  });
}
