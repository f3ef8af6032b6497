// Recordings as the fuzzer leaves them: refused, or read to their end.
#include "tests/fuzz/input.hpp"
#include "tests/support/mcap_files.hpp"
#include "tests/support/temporary_file.hpp"

namespace farhand {
namespace {

std::string valid_file(unsigned messages) {
  TemporaryFile file("", ".mcap");
  write_example(file.path(), messages);
  return bytes_of(file.path());
}

}  // namespace
}  // namespace farhand

std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t room,
                                    unsigned seed) {
  using namespace farhand;
  static const std::string files[] = {valid_file(0), valid_file(1), valid_file(12)};
  return mutate_or_restart(data, size, room, seed % 8 == 0, files[seed / 8 % 3]);
}

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace farhand;
  static const TemporaryFile file("", ".mcap");
  put_bytes(file.path(), {reinterpret_cast<const char*>(data), size});
  try {
    read_back(file.path());  // whatever it finds: the sanitizers watch
  } catch (const std::runtime_error&) {
  }
  return 0;
}
