#include "tests/support/torch_script/torch_script.hpp"

#include <torch/script.h>

#include <fstream>
#include <sstream>

namespace palpate::torch_script {

std::string module(const std::string& source, const std::vector<Tensor>& parameters) {
  torch::jit::Module module("Users");
  for (const Tensor& parameter : parameters)
    module.register_parameter(parameter.name,
                              torch::tensor(parameter.values).reshape(parameter.shape), false);
  module.define(source);
  std::ostringstream stream;
  module.save(stream);
  return stream.str();
}

std::string forward(const std::string& body) {
  std::string source = "def forward(self, x: Tensor, state: Tensor) -> Tuple[Tensor, Tensor]:\n";
  std::istringstream lines(body);
  for (std::string line; std::getline(lines, line);) source += "    " + line + "\n";
  return source;
}

void write(const std::string& path, const std::string& bytes, inference::ModelCard card) {
  card.architecture = "user";
  card.sha256 = inference::sha256_of(bytes);
  std::ofstream(path, std::ios::binary) << bytes;
  inference::write_card(card, inference::card_path(path));
}

}  // namespace palpate::torch_script
