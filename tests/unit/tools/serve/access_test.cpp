#include "tools/serve/access.hpp"

#include <gtest/gtest.h>

#include "tests/support/scratch_folder.hpp"

namespace palpate::serve {
namespace {

TEST(Doorman, KnowsItsOwnNamesWithItsPortAlone) {
  const Doorman doorman({"127.0.0.1", "localhost", "[::1]", "Lab.example"}, 8765);
  for (const char* host : {"127.0.0.1:8765", "LOCALHOST:8765", "[::1]:8765", "lab.example:8765"})
    EXPECT_TRUE(doorman.knows_host(host)) << host;
  for (const char* host : {"", "127.0.0.1", "127.0.0.1:80", "evil.example:8765", "localhost:87650",
                           "localhost.evil.example:8765", "127.0.0.1:8765@evil.example"})
    EXPECT_FALSE(doorman.knows_host(host)) << host;
}

TEST(Doorman, KnowsThePagesThatItServedItself) {
  const Doorman doorman({"127.0.0.1", "localhost"}, 8765);
  EXPECT_TRUE(doorman.knows_origin("http://localhost:8765", "localhost:8765"));
  for (const char* origin :
       {"", "null", "http://evil.example", "http://localhost", "http://localhost:8766",
        "http://127.0.0.1:8765", "http://localhost:8765.evil.example", "file://", "localhost:8765"})
    EXPECT_FALSE(doorman.knows_origin(origin, "localhost:8765")) << origin;
  EXPECT_FALSE(doorman.knows_origin("http://evil.example:8765", "evil.example:8765"))
      << "a name that was made to point here";
}

TEST(Token, IsLongAndItsOwn) {
  const Token token, other;
  EXPECT_EQ(token.text().size(), 64U);
  EXPECT_TRUE(token.is(token.text()));
  EXPECT_FALSE(token.is(other.text()));
  EXPECT_FALSE(token.is(""));
  EXPECT_FALSE(token.is(token.text().substr(1)));
  EXPECT_FALSE(token.is(token.text() + "0"));
  std::string wrong = token.text();
  wrong[63] = wrong[63] == '0' ? '1' : '0';
  EXPECT_FALSE(token.is(wrong));
}

TEST(Token, StaysThatOfItsFile) {
  const support::ScratchFolder folder;
  const std::string path = (folder.path() / "token").string();
  bus::make_key_file(path);
  EXPECT_TRUE(Token(path).is(Token(path).text()));
  EXPECT_THROW(Token((folder.path() / "none").string()), std::runtime_error);
}

}  // namespace
}  // namespace palpate::serve
