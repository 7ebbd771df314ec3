#include "tools/export/video.hpp"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <string>
#include <vector>

#include "tools/common/process.hpp"

extern char** environ;

namespace palpate::exporting {

Video::Video(const std::filesystem::path& file, int width, int height, double rate)
    : file_(file), width_(width), height_(height) {
  if (file.extension() != ".mp4")
    throw std::runtime_error(file.string() + ": the name of a film must end in .mp4");
  if (width % 2 != 0 || height % 2 != 0)
    throw std::invalid_argument("width and height of a film must be even");
  if (file.has_parent_path()) std::filesystem::create_directories(file.parent_path());
  part_ = file;
  part_.replace_extension(".part.mp4");
  messages_ = file;
  messages_.replace_extension(".ffmpeg-messages");

  std::vector<std::string> command{
      "ffmpeg",     "-y",
      "-loglevel",  "error",
      "-f",         "rawvideo",
      "-pix_fmt",   "rgb24",
      "-s",         std::to_string(width) + "x" + std::to_string(height),
      "-r",         std::to_string(rate),
      "-i",         "pipe:0",
      "-an",        "-c:v",
      "libx264",    "-preset",
      "medium",     "-crf",
      "20",         "-pix_fmt",
      "yuv420p",    "-movflags",
      "+faststart", part_.string()};
  std::vector<char*> arguments;
  for (std::string& word : command) arguments.push_back(word.data());
  arguments.push_back(nullptr);

  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error("no pipe to ffmpeg can be made");
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[0], STDIN_FILENO);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, messages_.c_str(),
                                   O_CREAT | O_WRONLY | O_TRUNC, 0644);
  const int error =
      posix_spawnp(&process_, arguments[0], &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(ends[0]);
  if (error != 0) {
    close(ends[1]);
    process_ = -1;
    throw std::runtime_error(std::string("ffmpeg cannot be run (apt-get install ffmpeg): ") +
                             std::strerror(error));
  }
  signal(SIGPIPE, SIG_IGN);  // if ffmpeg has ended, the write fails
  pipe_ = fdopen(ends[1], "wb");
}

Video::~Video() {
  if (pipe_ != nullptr) fclose(pipe_);
  if (process_ > 0) {
    waitpid(process_, nullptr, 0);
    std::error_code ignored;
    std::filesystem::remove(part_, ignored);
    std::filesystem::remove(messages_, ignored);
  }
}

void Video::fail() const {
  throw std::runtime_error(file_.string() + ": ffmpeg failed: " + common::tail(messages_, 5));
}

void Video::add(const draw::Image& image) {
  if (image.width != width_ || image.height != height_)
    throw std::invalid_argument("a picture of another size than the film's");
  if (fwrite(image.rgb.data(), 1, image.rgb.size(), pipe_) != image.rgb.size()) fail();
}

void Video::finish() {
  const bool is_flushed = fclose(pipe_) == 0;
  pipe_ = nullptr;
  int status = 0;
  waitpid(process_, &status, 0);
  if (!is_flushed || !WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    process_ = -1;
    fail();
  }
  process_ = -1;
  std::filesystem::remove(messages_);
  std::filesystem::rename(part_, file_);
}

}  // namespace palpate::exporting
