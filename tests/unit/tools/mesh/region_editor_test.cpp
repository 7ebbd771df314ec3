// The page's requests, without a socket: what they change, what the page gets, and who may.

#include "tools/mesh/region_editor.hpp"

#include <gmock/gmock.h>

#include <cstring>

#include "tests/support/scratch_folder.hpp"
#include "tools/mesh/mesh_files.hpp"

namespace palpate::mesh_tool {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

class Editor : public ::testing::Test {
 protected:
  Editor() {
    client_->send_text = [this](const std::string& text) { answer_ = json::parse(text); };
  }
  static mesh::MeshWithGroups bar() {
    mesh::MeshWithGroups made;
    made.mesh = mesh::make_box({0.4, 0.1, 0.1}, {8, 2, 2});
    return made;
  }

  /// The reason of a refusal, or nothing.
  std::string ask(const json& request) {
    answer_ = {};
    EXPECT_TRUE(editor_.receive(client_, request.dump(), 0));
    if (!answer_.is_object()) return "";  // a request to finish has no answer
    return answer_.value("type", "") == "error" ? answer_.value("reason", "?") : "";
  }
  void take_control() {
    EXPECT_EQ(ask({{"type", "control"}, {"token", token_.text()}}), "");
    ASSERT_TRUE(client_->may_control);
  }
  std::string select(json how, const std::string& group = "clamp", const std::string& edit = "add",
                     int stroke = 0) {
    how.update({{"type", "select"}, {"group", group}, {"edit", edit}, {"stroke", stroke}});
    if (how.count("of") == 0) how["of"] = "faces";
    return ask(how);
  }
  /// Heads of the parcels that are due.
  std::vector<json> received() {
    std::vector<json> heads;
    for (const auto& parcel : editor_.deliver(*client_, 0).parcels) {
      std::uint32_t length = 0;
      std::memcpy(&length, parcel->data(), 4);
      heads.push_back(json::parse(parcel->substr(4, length)));
    }
    return heads;
  }
  int faces(const std::string& group) const { return regions_.size(group).faces; }

  support::ScratchFolder folder_;
  const std::string file_ = (folder_.path() / "bar.msh").string();
  Regions regions_{bar()};
  serve::Token token_;
  RegionEditor editor_{regions_, file_, token_};
  std::shared_ptr<serve::Client> client_ = std::make_shared<serve::Client>();
  json answer_;
};

const json kTop = {{"by", "box"}, {"lower", {0, 0, 0.1}}, {"upper", {1, 1, 0.1}}};
const json kEnd = {{"by", "box"}, {"lower", {0, 0, 0}}, {"upper", {0, 1, 1}}};

TEST_F(Editor, NothingChangesWithoutTheToken) {
  EXPECT_THAT(select(kEnd), HasSubstr("need the token"));
  EXPECT_TRUE(regions_.groups().empty());
  const auto wrong = [&] {
    return editor_.receive(client_, R"({"type": "control", "token": "00"})", 0);
  };
  EXPECT_TRUE(wrong());
  EXPECT_FALSE(answer_["granted"]);
  EXPECT_TRUE(wrong());
  EXPECT_FALSE(wrong()) << "the third ends the connection";
}

TEST_F(Editor, APageGetsTheMeshOnceAndGroupsWhenTheyChange) {
  std::vector<json> heads = received();
  ASSERT_EQ(heads.size(), 2u);
  EXPECT_EQ(heads[0]["type"], "mesh");
  EXPECT_EQ(heads[0]["arrays"][0]["count"], 3 * 9 * 3 * 3);
  EXPECT_EQ(heads[0]["arrays"][1]["count"], 3 * 144);
  EXPECT_EQ(heads[1]["groups"].size(), 0u);
  EXPECT_TRUE(received().empty());
  take_control();
  EXPECT_EQ(select(kEnd), "");
  heads = received();
  ASSERT_EQ(heads.size(), 1u);
  EXPECT_EQ(heads[0]["groups"][0]["name"], "clamp");
  EXPECT_EQ(heads[0]["groups"][0]["faces"], 8);
  EXPECT_NEAR(heads[0]["groups"][0]["area"], 0.01, 1e-12);
  EXPECT_EQ(heads[0]["arrays"][0]["count"], 8);
  EXPECT_TRUE(heads[0]["changed"]);
}

TEST_F(Editor, EachWayToSelectEqualsTheCommands) {
  take_control();
  const RegionSelection& of = regions_.selection();
  const int top = of.nearest_face({0.2, 0.05, 0.1});
  const auto members = [&] { return regions_.members("part", RegionKind::kFaces); };
  EXPECT_EQ(select({{"by", "connected"}, {"face", top}, {"angle", 30}}, "part", "replace"), "");
  EXPECT_EQ(members(), of.facing({0, 0, 1}, 0.1));
  EXPECT_EQ(select({{"by", "brush"},
                    {"face", top},
                    {"at", {0.2, 0.05, 0.1}},
                    {"radius", 0.08},
                    {"angle", 30}},
                   "part", "replace"),
            "");
  EXPECT_EQ(members(), of.connected(top, 0.5, ball_space({0.2, 0.05, 0.1}, 0.08)));
  EXPECT_EQ(select({{"by", "all"}}, "part", "replace"), "");
  EXPECT_EQ(members().size(), 144u);
  // From above, by columns; the right half.
  EXPECT_EQ(select({{"by", "rectangle"},
                    {"clip_from_object", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, -1, -0.2, -0.05, 0, 1}},
                    {"lower", {-1e-9, -1}},
                    {"upper", {1, 1}}},
                   "part", "replace"),
            "");
  EXPECT_EQ(members().size(), 16u);
  json brush = {{"by", "brush"},    {"face", top},     {"at", {0.2, 0.05, 0.1}},
                {"of", "elements"}, {"radius", 0.001}, {"angle", 30}};
  EXPECT_EQ(select(brush, "core", "replace"), "");
  EXPECT_EQ(regions_.members("core", RegionKind::kElements), of.elements_at({top}))
      << "never less than the one under the pointer";
}

TEST_F(Editor, AStrokeIsUndoneAsAWhole) {
  take_control();
  EXPECT_EQ(select(kEnd), "");
  EXPECT_EQ(select(kTop, "clamp", "add", 7), "");
  EXPECT_EQ(select({{"by", "all"}}, "clamp", "add", 7), "");
  EXPECT_EQ(faces("clamp"), 144);
  EXPECT_EQ(ask({{"type", "undo"}}), "");
  EXPECT_EQ(faces("clamp"), 8);
  EXPECT_EQ(ask({{"type", "delete"}, {"group", "clamp"}}), "");
  EXPECT_EQ(ask({{"type", "undo"}}), "");
  EXPECT_EQ(faces("clamp"), 8);
  EXPECT_EQ(ask({{"type", "undo"}}), "");
  EXPECT_TRUE(regions_.groups().empty());
  EXPECT_THAT(ask({{"type", "undo"}}), HasSubstr("nothing to undo"));
}

TEST_F(Editor, SavesWhatTheDaemonAccepts) {
  take_control();
  EXPECT_EQ(select(kEnd), "");
  EXPECT_EQ(select(kTop, "grasp"), "");
  EXPECT_THAT(ask({{"type", "save"}}), HasSubstr("clamp and grasp share 3 nodes"));
  EXPECT_FALSE(std::filesystem::exists(file_));
  EXPECT_EQ(select(kEnd, "clamp", "remove"), "");
  EXPECT_TRUE(editor_.is_changed());
  EXPECT_EQ(ask({{"type", "finish"}}), "");
  EXPECT_FALSE(editor_.is_changed());
  EXPECT_TRUE(editor_.is_finished());
  const mesh::MeshWithGroups read = read_volume(file_, 1);
  EXPECT_EQ(read.groups.size(), 1u);
  EXPECT_EQ(read.groups.at("grasp").triangles.cols(), 32);
}

TEST_F(Editor, WrongRequestsAreRefusedWithTheReason) {
  take_control();
  EXPECT_TRUE(editor_.receive(client_, "{", 0));
  EXPECT_EQ(answer_["reason"], "not a JSON object");
  EXPECT_THAT(ask({{"type", "paint"}}), HasSubstr("must be control, select"));
  EXPECT_THAT(select({{"by", "magic"}}), HasSubstr("must be brush"));
  EXPECT_THAT(select({{"by", "box"}, {"lower", {0, 0}}, {"upper", {1, 1, 1}}}),
              HasSubstr("lower: must be 3 numbers"));
  EXPECT_THAT(select({{"by", "connected"}, {"face", 144}, {"angle", 30}}),
              HasSubstr("no face 144"));
  EXPECT_THAT(select({{"by", "connected"}, {"face", 1}, {"angle", 181}}), HasSubstr("angle"));
  EXPECT_THAT(select({{"by", "box"}, {"lower", {5, 5, 5}}, {"upper", {6, 6, 6}}}),
              HasSubstr("no face"));
  EXPECT_THAT(select(kEnd, "clamp", "paint"), HasSubstr("replace, add or remove"));
  EXPECT_THAT(ask({{"type", "delete"}, {"group", "clamp"}}), HasSubstr("no group 'clamp'"));
  EXPECT_TRUE(regions_.groups().empty());
  EXPECT_FALSE(editor_.is_changed());
}

}  // namespace
}  // namespace palpate::mesh_tool
