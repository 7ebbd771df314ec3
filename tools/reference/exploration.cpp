#include "tools/reference/exploration.hpp"

#include <yaml-cpp/yaml.h>

#include <fstream>

#include "core/sensing/recurrent_network.hpp"
#include "rt/bus/authentication.hpp"
#include "rt/config/installation.hpp"
#include "rt/config/node.hpp"
#include "rt/daemon/settings.hpp"
#include "rt/inference/model_file.hpp"
#include "rt/pipeline/pipeline.hpp"
#include "tools/fit/kinds.hpp"
#include "tools/fit/plan.hpp"
#include "tools/recordings/plan.hpp"
#ifndef PALPATE_WITHOUT_SIM
#include "sim/scenes/scene.hpp"
#endif

namespace palpate::reference {
namespace {

namespace fs = std::filesystem;

/// A network that outputs zero, with the given parameters.
[[maybe_unused]] void write_network(const fs::path& folder, const std::string& name,
                                    const std::vector<inference::Channel>& inputs,
                                    const std::vector<inference::Channel>& outputs) {
  inference::ModelCard card;
  card.name = name;
  card.rate = 100;
  card.inputs = inputs;
  card.outputs = outputs;
  const auto weights = sensing::RecurrentWeights::zero(static_cast<int>(inputs.size()),
                                                       static_cast<int>(outputs.size()), {4});
  inference::write_model_file((folder / (name + ".pt")).string(), weights, card);
}

/// Recordings of a bar that is pulled and released four times, and of skin between two pads.
void write_recordings(const fs::path& folder) {
  std::ofstream bar(folder / "bar.csv");
  bar << "time,strain,stretch,gap,length,stress,force,width,height,unit,probe\n";
  for (int i = 0; i < 400; ++i) {
    const double strain = 0.003 * std::min(i % 100, 100 - i % 100);
    bar << 0.01 * i << "," << strain << "," << 1 + strain << "," << 0.02 * (1 - strain) << ","
        << 0.02 * strain << "," << 1e4 * strain << "," << 10 * strain << ","
        << 0.01 * (1 - 0.3 * strain) << "," << 0.02 * (1 - strain) << ",1,1\n";
  }
  std::ofstream field(folder / "field.csv"), pads(folder / "pads.csv");
  field << "frame,point,x,y\n";
  pads << "frame,x,y,far,force\n";
  for (int frame = 0; frame < 3; ++frame) {
    for (int point = 0; point < 4; ++point)
      field << frame << "," << point << "," << 0.01 + 0.002 * point - 4e-4 * frame << ",0.001\n";
    pads << frame << "," << -1e-3 * frame << ",0,0.03," << -0.02 * frame << "\n";
  }
}

/// Two prisms along x with named triangles at both ends and between them, and one named prism.
void write_parts(const fs::path& file) {
  std::ofstream out(file);
  out << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n4\n2 1 \"clamp\"\n2 2 \"hand\"\n"
         "2 3 \"other hand\"\n3 4 \"half\"\n$EndPhysicalNames\n$Nodes\n9\n";
  for (int i = 0; i < 3; ++i) {
    const double x = 0.25 * i;
    out << 3 * i + 1 << ' ' << x << " -0.2 -0.2\n"
        << 3 * i + 2 << ' ' << x << " 0.3 -0.2\n"
        << 3 * i + 3 << ' ' << x << " 0.03 0.4\n";
  }
  out << "$EndNodes\n$Elements\n9\n";
  for (int i = 0; i < 3; ++i)
    out << i + 1 << " 2 2 " << i + 1 << " 1 " << 3 * i + 1 << ' ' << 3 * i + 2 << ' ' << 3 * i + 3
        << '\n';
  for (int i = 0; i < 2; ++i) {
    const int a = 3 * i, b = a + 3;
    const int tetrahedra[3][4] = {
        {a + 1, a + 2, a + 3, b + 3}, {a + 1, a + 2, b + 3, b + 2}, {a + 1, b + 2, b + 3, b + 1}};
    for (int t = 0; t < 3; ++t) {
      out << 4 + 3 * i + t << " 4 2 " << (i == 0 ? 4 : 0) << " 1";
      for (const int node : tetrahedra[t]) out << ' ' << node;
      out << '\n';
    }
  }
  out << "$EndElements\n";
}

/// The files that explorations name below MODELS, unless they exist already.
void write_models(const fs::path& folder) {
  if (fs::exists(folder / "key")) return;
  bus::make_key_file((folder / "key").string());
  write_recordings(folder);
  std::ofstream(folder / "material.yaml")
      << "material: {model: linear, young_modulus: 3e4, poisson_ratio: 0.3}\n"
         "corotational: {young_modulus: 3e4, poisson_ratio: 0.3}\n";
  // One tetrahedron on the foam's base.
  std::ofstream(folder / "foam.msh")
      << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 0.2 0 0\n3 0.1 0.04 0\n"
         "4 0.1 0.02 0.04\n$EndNodes\n$Elements\n1\n1 4 2 0 1 1 2 3 4\n$EndElements\n";
  write_parts(folder / "parts.msh");
  std::ofstream(folder / "wedge.obj") << "v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nv 0 0 0.1\n"
                                         "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
#ifndef PALPATE_WITHOUT_TORCH
  const std::vector<inference::Channel> force = {{"fx", "N"}, {"fy", "N"}, {"fz", "N"}};
  std::vector<inference::Channel> wrench = force;
  for (const char* name : {"tx", "ty", "tz"}) wrench.push_back({name, "N m"});
  write_network(folder, "observer", {{"gravity_z", "1"}}, wrench);
  write_network(folder, "finger", {{"pdc", "count"}}, force);
  write_network(folder, "direction", {{"pdc", "count"}}, {{"nx", "1"}, {"ny", "1"}, {"nz", "1"}});
#endif
}

std::string replaced(std::string text, const std::string& word, const std::string& by) {
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at))
    text.replace(at, word.size(), by);
  return text;
}

void read_daemon(const config::Node& root) {
  const daemon::Settings settings = daemon::read_settings(root);
  const pipeline::Pipeline pipeline(root, settings.loop.period, true);
  root.check_all_used();
}

const char* chapter_of(Reader reader) {
  switch (reader) {
    case Reader::kDaemon:
      return "daemon";
    case Reader::kScene:
      return "scene";
    case Reader::kTrain:
      return "train";
    case Reader::kFit:
      return "fit";
    case Reader::kRecording:
      return "recording";
  }
  return "";
}

#ifndef PALPATE_WITHOUT_SIM
void read_scene(const config::Node& root, const std::string&) { scenes::read_scene(root); }
#else
void read_scene(const config::Node&, const std::string& file) {
  throw config::Error(file + ": this build has no simulator");
}
#endif

/// Keys read from the recording itself; those of a configuration that it names belong to the
/// latter.
Declarations read_recording(const config::Node& root, const config::DeclarationList& list) {
  try {
    fit::make_experiment(root, "");
    root.check_all_used();
  } catch (const config::Error&) {
    throw;
  } catch (const std::exception&) {
    if (!root.has("log")) throw;  // a log need not exist: by then every key has been read
  }
  Declarations own;
  for (const config::Declaration& declaration : list.all())
    if (declaration.document == "<text>") own.push_back(declaration);
  return without_names(own);
}

}  // namespace

Declarations read(Reader reader, const Exploration& exploration) {
  config::DeclarationList list;
  const config::Node root = exploration.file.empty()
                                ? config::Node::from_text(exploration.text)
                                : config::Node::load_file(exploration.file, exploration.overrides);
  if (reader == Reader::kDaemon) {
    try {
      read_daemon(root);
    } catch (const config::Error&) {
      if (exploration.only.empty()) throw;
    }
  } else if (reader == Reader::kTrain) {
    recordings::read_plan(root);
  } else if (reader == Reader::kFit) {
    // Its parts are merged in separate documents.
    fit::read_plan(root, "");
    return without_names(list.all());
  } else if (reader == Reader::kRecording) {
    return read_recording(root, list);
  } else {
    read_scene(root, exploration.file);
  }
  Declarations own;
  for (const config::Declaration& declaration : list.all())
    if (declaration.document == exploration.file &&
        declaration.path.rfind(exploration.only, 0) == 0)
      own.push_back(declaration);
  return own;
}

std::vector<Exploration> explorations(Reader reader, const fs::path& models) {
  write_models(models);
  const fs::path data = config::data_folder();
  const config::Node plan =
      config::Node::load_file((data / "tools/reference/explorations.yaml").string());
  std::string zeros = "[0";
  for (int i = 1; i < 21; ++i) zeros += ", 0";
  std::vector<Exploration> found;
  for (const config::Node& item : plan.list(chapter_of(reader))) {
#ifdef PALPATE_WITHOUT_TORCH
    if (item.flag("torch", false)) continue;
#endif
    if (reader == Reader::kRecording) {
      const std::string text = replaced(item.dump(), "ROOT", data.string());
      found.push_back({"", {}, replaced(text, "MODELS", models.string()), item.text("kind")});
      continue;
    }
    Exploration exploration{(data / item.text("file")).string(), {}};
    if (item.has("set"))
      for (const std::string& set : item.texts("set"))
        exploration.overrides.push_back(
            replaced(replaced(set, "MODELS", models.string()), "ZEROS", zeros + "]"));
    exploration.only = item.text("only", "");
    found.push_back(exploration);
  }
  return found;
}

}  // namespace palpate::reference
