// A file that lives as long as this object, for tests of readers.
#pragma once

#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <string>

namespace farhand {

class TemporaryFile {
 public:
  explicit TemporaryFile(const std::string& text, const std::string& suffix = ".csv") {
    static std::atomic<int> count{0};
    path_ = (std::filesystem::temp_directory_path() /
             ("farhand_" + std::to_string(getpid()) + "_" + std::to_string(count++) + suffix))
                .string();
    std::ofstream(path_, std::ios::binary) << text;
  }
  ~TemporaryFile() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

// The text of the exception f() throws, or "" if it throws none.
template <typename F>
std::string refusal(F&& f) {
  try {
    f();
  } catch (const std::exception& e) {
    return e.what();
  }
  return "";
}

}  // namespace farhand
