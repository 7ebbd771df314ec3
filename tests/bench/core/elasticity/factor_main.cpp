#include <CLI/CLI.hpp>
#include <cstdio>
#include <iostream>

#include "core/elasticity/incremental/refactor_job.hpp"
#include "core/factor/cholmod/cholmod_factor.hpp"
#include "core/math/blas.hpp"
#include "rt/config/command_line.hpp"
#include "tests/bench/core/elasticity/factor_choice.hpp"
#include "tests/bench/core/elasticity/samples.hpp"
#include "tests/bench/core/elasticity/scenario.hpp"

namespace palpate::bench {
namespace {

/// The bar bent and rotated as after 50 ms of motion L.
Eigen::Matrix3Xd moved_bar(const Scenario& scenario, elasticity::SolverOptions solver) {
  const auto model = make_model(scenario.body(), Mechanics::kDynamic, solver);
  for (int k = 1; k <= 50; ++k) {
    scenario.apply(1e-3 * k, *model);
    model->step(1e-3);
    support::refactor(*model);
  }
  return model->positions();
}

/// Parts of one job with one of the factors, each measured on its own. Thread times in s.
struct Parts {
  Samples job, assembly, sensitivities, factorisation, bare, panels;
};

/// A job at a given shape, whole and in parts.
class Subject {
 public:
  Subject(const elasticity::NumberedBody& body, const elasticity::SolverOptions& options,
          Mechanics mechanics, const Eigen::Matrix3Xd& shape)
      : job_(body, options, no_samples_),
        tangents_(elasticity::make_element_tangents(body.elements, body.pattern)),
        matrix_(body.pattern),
        mass_(elasticity::mass_blocks(body.elements, body.pattern)),
        factor_(options.make_factor(body.supernodes)),
        cholmod_(dynamic_cast<factor::CholmodFactor*>(factor_.get())),
        response_(body.body, body.elements, body.pattern),
        stress_(elasticity::make_stress_evaluator(body.elements)),
        panels_(body.supernodes, options.panels) {
    job_.snapshot.positions = shape;
    job_.snapshot.held = {true, false};
    job_.snapshot.gravity_O = body.body.gravity_O;
    if (mechanics == Mechanics::kDynamic) job_.factor.step = {1e6 + 2e3, 0};
    if (cholmod_ != nullptr) cholmod_->set_clock(thread_time);
    sensitivity_.resize(body.node_count());
  }

  int factorisations() const { return job_.factor.step.inertia > 0 ? 2 : 1; }
  bool is_exact() const { return job_.factor.exact; }
  const Parts& parts() const { return parts_; }

  void measure() {
    const auto time = [](Samples& samples, auto&& work) {
      const double begin = thread_time();
      work();
      samples.add(thread_time() - begin);
    };
    const elasticity::Snapshot& at = job_.snapshot;
    time(parts_.job, [&] { job_.run(); });
    time(parts_.assembly,
         [&] { tangents_->assemble(at.positions, elasticity::Tangent::kExact, matrix_, nullptr); });
    factorise(matrix_);
    time(parts_.sensitivities, [&] {
      stress_->evaluate(at.positions, sensitivity_.stress);
      response_.compute(at, matrix_, *factor_, sensitivity_);
    });
    if (factorisations() == 2) {
      matrix_.add_scalar(job_.factor.step.inertia, mass_);
      factorise(matrix_);
    }
    time(parts_.panels, [&] { panels_.assign(*factor_); });
  }

 private:
  void factorise(const factor::BlockMatrix& matrix) {
    const double begin = thread_time();
    factor_->factorise(matrix);
    const double whole = thread_time() - begin;
    parts_.factorisation.add(whole);
    parts_.bare.add(cholmod_ != nullptr ? cholmod_->bare_time() : whole);
  }

  std::vector<mesh::PointWeights> no_samples_;
  elasticity::RefactorJob job_;
  std::unique_ptr<elasticity::ElementTangents> tangents_;
  factor::BlockMatrix matrix_;
  Eigen::VectorXd mass_;
  std::unique_ptr<factor::SupernodalFactor> factor_;
  factor::CholmodFactor* cholmod_;
  elasticity::StaticResponse response_;
  std::unique_ptr<elasticity::StressEvaluator> stress_;
  factor::SolvePanels panels_;
  elasticity::Sensitivity sensitivity_;
  Parts parts_;
};

void print(const char* name, const Subject& subject) {
  const Parts& p = subject.parts();
  const auto ms = [](const Samples& samples) { return 1e3 * samples.quantile(0.5); };
  const double bare = subject.factorisations() * ms(p.bare);
  const double rest = ms(p.job) - ms(p.assembly) - ms(p.sensitivities);
  std::printf("  %-8s %8.2f %9.2f %13.2f %8.2f %6d x %7.2f %8.2f %8.2f %7.2f%s\n", name, ms(p.job),
              ms(p.assembly), ms(p.sensitivities), rest, subject.factorisations(), ms(p.bare),
              ms(p.factorisation) - ms(p.bare), ms(p.panels), rest / bare,
              subject.is_exact() ? "" : "  not positive definite");
}

int run(int repetitions, factor::PanelPrecision panels) {
  const math::Blas blas = math::hold_blas_to_one_thread();
  std::printf("BLAS %s, %d thread; medians of %d, thread time in ms\n", blas.file.c_str(),
              blas.threads, repetitions);
  for (const BarMesh& mesh :
       {bar_of(mesh::ElementOrder::kQuadratic, 475), bar_of(mesh::ElementOrder::kLinear, 2997)}) {
    const Scenario scenario(mesh, Motion::kLarge);
    elasticity::SolverOptions own, cholmod;
    own.panels = cholmod.panels = panels;
    choose_factor("cholmod", cholmod);
    const elasticity::NumberedBody body(scenario.body());
    const elasticity::NumberedBody reordered(scenario.body(), cholmod.orders);
    const Eigen::Matrix3Xd shape = moved_bar(scenario, own);
    for (const Mechanics mechanics : {Mechanics::kQuasistatic, Mechanics::kDynamic}) {
      Subject of_own(body, own, mechanics, shape), of_cholmod(reordered, cholmod, mechanics, shape);
      for (int k = 0; k < repetitions; ++k) {  // in turn, so that both find the same load
        of_own.measure();
        of_cholmod.measure();
      }
      std::printf("%s, %s\n  %-8s %8s %9s %13s %8s %16s %8s %8s %7s\n", mesh.text().c_str(),
                  mechanics == Mechanics::kDynamic ? "dynamic" : "quasistatic", "factor", "job",
                  "assembly", "sensitivities", "rest", "bare", "convert", "panels", "rest/bare");
      print("own", of_own);
      print("cholmod", of_cholmod);
    }
  }
  return 0;
}

}  // namespace
}  // namespace palpate::bench

int main(int argc, char** argv) {
  CLI::App app{
      "The background job with the own factor and with CHOLMOD's, side by side. rest: the job "
      "without assembly and sensitivities; bare: one numeric factorisation; convert: of its matrix "
      "and its factor; panels: what the loop solves with."};
  int repetitions = 41;
  bool half = false;
  app.add_option("--repetitions", repetitions, "of each job")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_flag("--half", half, "panels of half precision");
  if (const auto code = palpate::config::parse(app, argc, argv)) return *code;
  try {
    return palpate::bench::run(repetitions, half ? palpate::factor::PanelPrecision::kHalf
                                                 : palpate::factor::PanelPrecision::kSingle);
  } catch (const std::exception& error) {
    std::cerr << "bench_factor: " << error.what() << '\n';
    return palpate::config::kExitError;
  }
}
