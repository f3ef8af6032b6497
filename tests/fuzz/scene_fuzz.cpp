// Scenes as the fuzzer writes them: refused with a place in the file, or good for both sides.
#include <cctype>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <vector>

#include "common/scene.hpp"
#include "master/build.hpp"
#include "master/master.hpp"
#include "slave/build.hpp"
#include "slave/slave.hpp"
#include "tests/fuzz/input.hpp"

namespace farhand {
namespace {

std::vector<std::string> shipped_scenes() {
  std::vector<std::string> scenes;
  for (const auto& file :
       std::filesystem::directory_iterator(FARHAND_SOURCE_DIR "/deploy/scenes")) {
    std::ostringstream text;
    text << std::ifstream(file.path()).rdbuf();
    scenes.push_back(text.str());
  }
  return scenes;
}

// A number of the text becomes one that tends to be forgotten.
std::string with_odd_number(std::string text, std::size_t which) {
  static const char* const kOdd[] = {"0",   "-1",     "1e308",      "-1e308", "nan",
                                     "inf", "1e-308", "4294967296", "0.001",  "1000000"};
  std::vector<std::size_t> digits;
  for (std::size_t i = 1; i < text.size(); ++i)
    if (std::isdigit(static_cast<unsigned char>(text[i])) != 0 && text[i - 1] == ' ')
      digits.push_back(i);
  if (digits.empty()) return text;
  const std::size_t at = digits[which % digits.size()];
  return text.replace(at, text.find_first_not_of("0123456789.e-", at) - at,
                      kOdd[which / digits.size() % std::size(kOdd)]);
}

}  // namespace
}  // namespace farhand

std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t room,
                                    unsigned seed) {
  using namespace farhand;
  static const std::vector<std::string> scenes = shipped_scenes();
  const bool restart = seed % 8 == 0 || size == 0;
  if (seed % 3 != 0)
    return mutate_or_restart(data, size, room, restart,
                             restart ? scenes[seed / 8 % scenes.size()] : "");
  const std::string text = with_odd_number(
      restart ? scenes[seed / 8 % scenes.size()] : std::string(data, data + size), seed / 24);
  size = std::min(text.size(), room);
  std::copy_n(text.begin(), size, data);
  return size;
}

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace farhand;
  try {
    const Scene scene = parse_scene(std::string(data, data + size), "scene");
    require(scene.shared_hash == shared_hash(scene.proto));
    if (scene.proto.has_master()) Master(master_config(scene.proto));
    if (scene.proto.has_slave()) Slave(slave_config(scene.proto));
  } catch (const SceneError& e) {
    require(e.line >= 1 && e.column >= 1 && !e.field.empty());
  }
  return 0;
}
