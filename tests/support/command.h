// Runs the talus command as a process, in a folder of its own.
#pragma once

#include <doctest/doctest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace talus::testing {

inline std::string contents(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return (std::ostringstream() << in.rdbuf()).str();
}

// A folder that is there as long as the object is.
class Folder {
 public:
  Folder() {
    std::string name = (std::filesystem::temp_directory_path() / "talus-test-XXXXXX").string();
    REQUIRE(mkdtemp(name.data()));
    path_ = name;
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;

  std::string operator/(const std::string& file) const { return (path_ / file).string(); }
  std::string write(const std::string& file, const std::string& text) const {
    std::ofstream(path_ / file, std::ios::binary) << text;
    return *this / file;
  }
  std::vector<std::string> files() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(path_))
      names.push_back(entry.path().filename().string());
    return names;
  }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

struct Run {
  int code = -1;
  std::string out, error;
};

// Arguments as a shell takes them; runs inside the folder.
inline Run command(const Folder& folder, const std::string& arguments) {
  const Folder streams;
  const std::string line = "cd '" + folder.path().string() + "' && '" TALUS_COMMAND "' " +
                           arguments + " > '" + streams / "out" + "' 2> '" + streams / "error" +
                           "' < /dev/null";
  const int status = std::system(line.c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, contents(streams / "out"),
          contents(streams / "error")};
}

// An error message without the word "error" behind its place.
inline std::string said(std::string error) {
  const std::size_t at = error.find(": error: ");
  return at == std::string::npos ? "(no error) " + error : error.replace(at, 9, ": ");
}

// What a terminal shows, standard output and standard error, by `script`; in front of the command
// goes `environment`: "TERM=xterm". Lines end in \r\n there, which is \n here.
inline std::string terminal(const Folder& folder, const std::string& arguments,
                            const std::string& environment = "TERM=xterm") {
  const Folder streams;
  std::ofstream(streams / "run") << "cd '" << folder.path().string() << "' && exec env -u NO_COLOR "
                                 << environment << " '" TALUS_COMMAND "' " << arguments << "\n";
  const std::string line = "script -qc 'sh " + streams / "run" + "' /dev/null > '" +
                           streams / "out" + "' 2>&1 < /dev/null";
  CHECK(std::system(line.c_str()) == 0);
  std::string text = contents(streams / "out");
  for (std::size_t at = 0; (at = text.find("\r\n", at)) != std::string::npos;) text.erase(at, 1);
  return text;
}

// The same for any program; the exit code alone.
inline int shell(const std::string& command) {
  const int status = std::system((command + " > /dev/null 2>&1").c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

}  // namespace talus::testing
