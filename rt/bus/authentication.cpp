#include "rt/bus/authentication.hpp"

#include <fcntl.h>
#include <sodium.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cctype>
#include <cerrno>
#include <ctime>
#include <stdexcept>

namespace palpate::bus {
namespace {

static_assert(kKeySize == crypto_auth_hmacsha512256_KEYBYTES);
static_assert(kCodeSize == crypto_auth_hmacsha512256_BYTES);

[[noreturn]] void fail(const std::string& path, const std::string& what) {
  throw std::runtime_error("key file " + path + ": " + what);
}

void require_sodium() {
  if (sodium_init() < 0) throw std::runtime_error("libsodium finds no source of random numbers");
}

class File {
 public:
  File(const std::string& path, int flags) : fd_(open(path.c_str(), flags | O_CLOEXEC, 0600)) {}
  ~File() {
    if (fd_ >= 0) close(fd_);
  }
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  int fd() const { return fd_; }

 private:
  int fd_;
};

}  // namespace

Key read_key_file(const std::string& path) {
  require_sodium();
  // non-blocking, in case the path is a pipe
  const File file(path, O_RDONLY | O_NONBLOCK);
  if (file.fd() < 0) fail(path, std::string("cannot be opened: ") + std::strerror(errno));
  struct stat status {};
  if (fstat(file.fd(), &status) != 0 || !S_ISREG(status.st_mode)) fail(path, "is no file");
  if ((status.st_mode & (S_IRWXG | S_IRWXO)) != 0)
    fail(path, "others than its owner have access to it; chmod 600 " + path);

  constexpr int kDigits = 2 * kKeySize;
  char text[kDigits + 3];  // digits, an end of line, and one byte to detect longer content
  ssize_t size = read(file.fd(), text, sizeof(text));
  Key key;
  bool good = size == kKeySize;
  if (good) {
    std::memcpy(key.data(), text, kKeySize);
  } else {
    while (size > kDigits && std::isspace(static_cast<unsigned char>(text[size - 1]))) --size;
    std::size_t made = 0;
    good = size == kDigits &&
           sodium_hex2bin(key.data(), key.size(), text, kDigits, nullptr, &made, nullptr) == 0 &&
           made == key.size();
  }
  sodium_memzero(text, sizeof(text));
  if (!good)
    fail(path, "must hold 32 bytes or 64 hexadecimal digits; palpate-command --make-key makes one");
  return key;
}

void make_key_file(const std::string& path) {
  require_sodium();
  Key key;
  randombytes_buf(key.data(), key.size());
  char text[2 * kKeySize + 1];
  sodium_bin2hex(text, sizeof(text), key.data(), key.size());
  text[2 * kKeySize] = '\n';
  const File file(path, O_WRONLY | O_CREAT | O_EXCL);
  if (file.fd() < 0) fail(path, std::string("cannot be made: ") + std::strerror(errno));
  if (write(file.fd(), text, sizeof(text)) != static_cast<ssize_t>(sizeof(text)))
    fail(path, std::string("cannot be written: ") + std::strerror(errno));
}

std::int64_t wall_clock_us() noexcept {
  timespec now{};
  clock_gettime(CLOCK_REALTIME, &now);
  return static_cast<std::int64_t>(now.tv_sec) * 1000000 + now.tv_nsec / 1000;
}

void compute_code(const Key& key, std::string_view channel, const void* data, int size,
                  std::uint8_t* code) noexcept {
  constexpr std::uint8_t kEnd = 0;
  crypto_auth_hmacsha512256_state state;
  crypto_auth_hmacsha512256_init(&state, key.data(), key.size());
  crypto_auth_hmacsha512256_update(&state, reinterpret_cast<const unsigned char*>(channel.data()),
                                   channel.size());
  crypto_auth_hmacsha512256_update(&state, &kEnd, 1);
  crypto_auth_hmacsha512256_update(&state, static_cast<const unsigned char*>(data),
                                   static_cast<unsigned long long>(size));
  crypto_auth_hmacsha512256_final(&state, code);
}

bool same_code(const std::uint8_t* a, const std::uint8_t* b) noexcept {
  return crypto_verify_32(a, b) == 0;
}

}  // namespace palpate::bus
