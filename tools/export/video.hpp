#pragma once

#include <cstdio>
#include <filesystem>

#include "sim/draw/image.hpp"

namespace palpate::exporting {

/// A video encoded by Debian's ffmpeg (H.264, yuv420p, for the widest compatibility) from images
/// piped to it.
class Video {
 public:
  /// Throws std::runtime_error if ffmpeg is not installed or does not start, or the name does not
  /// end in .mp4; std::invalid_argument if width or height is odd, which H.264 does not support.
  Video(const std::filesystem::path& file, int width, int height, double rate);
  ~Video();
  Video(const Video&) = delete;
  Video& operator=(const Video&) = delete;

  void add(const draw::Image& image);
  /// Waits for ffmpeg; throws std::runtime_error with its last output if it failed.
  void finish();

 private:
  [[noreturn]] void fail() const;

  std::filesystem::path file_, part_, messages_;
  int width_, height_;
  FILE* pipe_ = nullptr;
  int process_ = -1;
};

}  // namespace palpate::exporting
