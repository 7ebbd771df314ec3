#include "tools/view/request.hpp"

#include <gtest/gtest.h>

#include "rt/bus/text.hpp"

namespace palpate::view {
namespace {

TEST(Request, OfEachKind) {
  EXPECT_EQ(std::get<Acknowledge>(parse_request(R"({"type":"ack","frame":12})", 5)).frame, 12);
  EXPECT_EQ(std::get<ColourBy>(parse_request(R"({"type":"colour","field":"strain"})", 5)).field,
            Field::kStrain);
  EXPECT_EQ(std::get<TakeControl>(parse_request(R"({"type":"control","token":"ab"})", 5)).token,
            "ab");
  const auto play =
      std::get<Play>(parse_request(R"({"type":"play","action":"seek","value":2})", 5));
  EXPECT_EQ(play.action, Play::Action::kSeek);
  EXPECT_EQ(play.value, 2);
  const auto command = std::get<Command>(parse_request(
      R"({"type":"command","id":3,"event":"replace","slot":"deformation","component":"linear"})",
      5));
  EXPECT_EQ(command.id, 3);
  EXPECT_STREQ(bus::get_text(command.message.component), "linear");
  EXPECT_STREQ(bus::get_text(command.message.slot), "deformation");
  const auto target = std::get<SetTarget>(
      parse_request(R"({"type":"target","id":4,"kind":"point","values":[1,2,3]})", 5));
  EXPECT_EQ(target.message.at(0).value_count, 3);
  EXPECT_EQ(target.message.at(0).values[1], 2);
}

TEST(Request, APushIsNoStrongerThanAllowed) {
  const auto push = [](double max_force) {
    return std::get<Push>(
        parse_request(R"({"type":"push","point":[0,1,2],"force":[3,0,-4]})", max_force));
  };
  EXPECT_EQ(push(10).force[2], -4);
  EXPECT_NEAR(push(2.5).force[0], 1.5, 1e-12);
  EXPECT_NEAR(push(2.5).force[2], -2, 1e-12);
  EXPECT_EQ(push(0).force[0], 0);
}

TEST(Request, OnlySomeMoveSomething) {
  for (const char* text : {R"({"type":"command","id":1,"event":"start"})",
                           R"({"type":"target","id":1,"kind":"point","values":[0,0,0]})",
                           R"({"type":"push","point":[0,0,0],"force":[0,0,0]})"})
    EXPECT_TRUE(moves_something(parse_request(text, 5))) << text;
  for (const char* text : {R"({"type":"ack","frame":1})", R"({"type":"play","action":"pause"})",
                           R"({"type":"colour","field":"stress"})"})
    EXPECT_FALSE(moves_something(parse_request(text, 5))) << text;
}

TEST(Request, WrongOnesSayWhatIsWrong) {
  const std::pair<const char*, const char*> wrong[] = {
      {"", "not a JSON object"},
      {"[1]", "not a JSON object"},
      {"{", "not a JSON object"},
      {R"({"type":"sudo"})", "type"},
      {R"({"type":1})", "type"},
      {R"({"type":"ack"})", "frame"},
      {R"({"type":"ack","frame":"1"})", "frame"},
      {R"({"type":"ack","frame":-1})", "from 0"},
      {R"({"type":"colour","field":"x"})", "displacement"},
      {R"({"type":"command","id":1,"event":"reboot"})", "start, stop"},
      {R"({"type":"command","event":"start"})", "id"},
      {R"({"type":"push","point":[0,0],"force":[0,0,0]})", "three numbers"},
      {R"({"type":"push","point":[0,0,1e99],"force":[0,0,0]})", "from -1000 to 1000"},
      {R"({"type":"push","point":[0,0,null],"force":[0,0,0]})", "point"},
      {R"({"type":"push","point":{},"force":[0,0,0]})", "list"},
      {R"({"type":"play","action":"rate","value":1000})", "from 0.01 to 100"},
      {R"({"type":"play","action":"jump"})", "seek"}};
  for (const auto& [text, what] : wrong) {
    try {
      parse_request(text, 5);
      ADD_FAILURE() << text;
    } catch (const RequestError& error) {
      EXPECT_NE(std::string(error.what()).find(what), std::string::npos) << error.what();
    }
  }
  const std::string deep(8000, '[');
  EXPECT_THROW(parse_request(deep, 5), RequestError);
  EXPECT_THROW(parse_request(R"({"type":"command","id":1,"event":"replace","slot":")" +
                                 std::string(40, 'a') + R"("})",
                             5),
               RequestError);
}

}  // namespace
}  // namespace palpate::view
