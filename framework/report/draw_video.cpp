#include "framework/report/draw_video.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <sstream>

#include "framework/report/draw_canvas.h"

extern char** environ;

namespace talus {
namespace {

// A program that reads what is written here; a program that ends early is no reason to end as well.
class Pipe {
 public:
  explicit Pipe(std::vector<std::string> words) {
    struct sigaction ignore {};
    ignore.sa_handler = SIG_IGN;
    sigaction(SIGPIPE, &ignore, &before_);
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) return;
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[0], 0);
    posix_spawn_file_actions_addopen(&actions, 1, "/dev/null", O_WRONLY, 0);
    std::vector<char*> arguments;
    arguments.reserve(words.size() + 1);
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    if (posix_spawnp(&child_, arguments[0], &actions, nullptr, arguments.data(), environ) != 0)
      child_ = -1;
    posix_spawn_file_actions_destroy(&actions);
    close(ends[0]);
    to_ = ends[1];
  }
  ~Pipe() {
    finish();
    sigaction(SIGPIPE, &before_, nullptr);
  }
  Pipe(const Pipe&) = delete;

  bool write(const std::string& data) {
    for (std::size_t done = 0; done < data.size();) {
      const ssize_t n = ::write(to_, data.data() + done, data.size() - done);
      if (n < 0 && errno == EINTR) continue;
      if (n < 0) return false;
      done += static_cast<std::size_t>(n);
    }
    return true;
  }
  bool finish() {  // true where the program ended well
    if (to_ >= 0) close(to_);
    to_ = -1;
    if (child_ <= 0) return false;
    int status = 0;
    while (waitpid(child_, &status, 0) < 0 && errno == EINTR) continue;
    child_ = -1;
    return WIFEXITED(status) && WEXITSTATUS(status) == 0;
  }

 private:
  pid_t child_ = -1;
  int to_ = -1;
  struct sigaction before_ {};
};

}  // namespace

bool ffmpeg_found() {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');)
    if (access((folder + "/ffmpeg").c_str(), X_OK) == 0) return true;
  return false;
}

bool write_video(const std::string& file, const std::vector<Picture>& pictures, double rate,
                 const std::function<void(double)>& progress) {
  const std::string ending = std::filesystem::path(file).extension().string(),
                    beside = file + ".part" + ending;
  std::vector<std::string> words{
      "ffmpeg",
      "-loglevel",
      "error",
      "-nostdin",
      "-y",
      "-f",
      "rawvideo",
      "-pixel_format",
      "bgra",
      "-video_size",
      fmt::format("{}x{}", std::lround(pictures[0].width), std::lround(pictures[0].height)),
      "-framerate",
      fmt::format("{:g}", rate),
      "-i",
      "pipe:0",
      "-vf"};
  if (ending == ".gif")
    words.push_back("split[a][b];[a]palettegen[p];[b][p]paletteuse=dither=none");
  else  // most players want even sides and this sort of colour
    words.insert(words.end(), {"pad=ceil(iw/2)*2:ceil(ih/2)*2:color=white", "-pix_fmt", "yuv420p"});
  words.push_back("file:" + beside);
  bool good = true;
  {
    Pipe ffmpeg(words);
    for (std::size_t k = 0; good && k < pictures.size(); ++k) {
      good = ffmpeg.write(raw_pixels(pictures[k]));
      if (progress) progress(static_cast<double>(k + 1) / static_cast<double>(pictures.size()));
    }
    good = ffmpeg.finish() && good;
  }
  std::error_code error;
  if (good) std::filesystem::rename(beside, file, error);
  if (good && !error) return true;
  std::filesystem::remove(beside, error);
  return false;
}

}  // namespace talus
