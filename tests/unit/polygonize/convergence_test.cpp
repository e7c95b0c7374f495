#include "polygonize/convergence.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <new>
#include <thread>

#include "libfield/art/read_art.h"
#include "libfield/base/check.h"
#include "polygonize/reference_uncertainty.h"
#include "tests/unit/polygonize/mesh_test_tools.h"

namespace cs2mesh {
namespace {

using Meshed = Result<MesherResult>;

/// A sphere of octahedron triangles about the origin, as fine as asked for: within
/// 1 / 4^levels of the unit sphere.
MesherResult sphere(int levels) {
  MesherResult result;
  result.mesh = test::sphere_mesh(levels);
  result.error = 1 / std::pow(4.0, levels);
  result.reached = true;
  return result;
}

int levels_for(double tolerance) {
  return std::max(1, static_cast<int>(std::ceil(std::log(1 / tolerance) / std::log(4.0))));
}

constexpr Mesher kOctahedron = {"octahedron", "finer and finer",
                                [](const ImplicitSurface& surface, const MesherRequest& request) {
                                  surface.value({0, 0, 0});
                                  surface.restrict_to(surface.bounds())->jet({0, 0, 1});
                                  surface.enclose(surface.bounds());
                                  return Meshed(sphere(levels_for(request.tolerance)));
                                }};
constexpr Mesher kHonest = {"honest", "says that it gives up",
                            [](const ImplicitSurface&, const MesherRequest&) {
                              MesherResult result = sphere(1);
                              result.reached = false;
                              return Meshed(std::move(result));
                            }};
constexpr Mesher kLiar = {"liar", "says that it is within the tolerance",
                          [](const ImplicitSurface&, const MesherRequest&) {
                            MesherResult result = sphere(1);
                            result.error = 0;
                            return Meshed(std::move(result));
                          }};
constexpr Mesher kBlind = {
    "blind", "sees nothing",
    [](const ImplicitSurface&, const MesherRequest&) { return Meshed(MesherResult{}); }};
constexpr Mesher kLimited = {"limited", "runs into a limit",
                             [](const ImplicitSurface&, const MesherRequest&) {
                               return Meshed(error_at({}, "too many nodes", Failure::limit));
                             }};
constexpr Mesher kGreedy = {
    "greedy", "runs out of memory",
    [](const ImplicitSurface&, const MesherRequest&) -> Meshed { throw std::bad_alloc(); }};
constexpr Mesher kEndless = {"endless", "stops when it is told to",
                             [](const ImplicitSurface&, const MesherRequest& request) {
                               while (!cancelled(request.progress)) {
                                 std::this_thread::sleep_for(std::chrono::milliseconds(1));
                               }
                               return Meshed(error_at({}, "interrupted", Failure::interrupted));
                             }};

struct Fixture {
  Scene scene;
  CompiledScene compiled;
  LadderOptions options;

  Fixture() {
    scene = *parse_art("surface s { kernel cauchy radius 1 blobbiness -2 }\nsphere s 1 0 0 0\n",
                       "ball.art");
    compiled = *clip_to_bounds(*compile(scene), scene);
    options.samples = 5000;
    options.certified_rays = 100;
  }

  LadderRun run(const Mesher& mesher, double tolerance, Model* model = nullptr) const {
    return *run_rung(scene, compiled, mesher, tolerance, options, model);
  }
};

TEST(Convergence, ARunIsMeasuredAndCounted) {
  const Fixture f;
  Model model;
  const LadderRun run = f.run(kOctahedron, 0.01, &model);
  EXPECT_EQ(run.outcome, RunOutcome::reached) << run.remark;
  EXPECT_EQ(run.mesher, "octahedron");
  EXPECT_EQ(run.remark, "");
  EXPECT_EQ(run.triangles, 8u * 256u);
  EXPECT_EQ(run.triangles, model.triangle_count());
  EXPECT_EQ(run.evaluations, (Evaluations{2, 1, 0, 1}));
  EXPECT_GT(run.error.max(), 0.001);
  EXPECT_LE(run.error.max(), 0.01);
  EXPECT_LT(run.spread, run.error.max());
  EXPECT_GT(run.seconds, 0);
  EXPECT_GE(run.timings, 1);
  EXPECT_GT(run.peak_memory, 0u);
}

TEST(Convergence, WhatGoesWrongIsARowThatSaysSo) {
  Fixture f;
  EXPECT_EQ(f.run(kHonest, 0.01).outcome, RunOutcome::missed);
  EXPECT_NE(f.run(kHonest, 0.01).remark.find("gave up"), std::string::npos);
  EXPECT_EQ(f.run(kLiar, 0.01).outcome, RunOutcome::missed);
  EXPECT_NE(f.run(kLiar, 0.01).remark.find("does not confirm"), std::string::npos);
  EXPECT_EQ(f.run(kBlind, 0.01).outcome, RunOutcome::failed);
  EXPECT_NE(f.run(kBlind, 0.01).remark.find("no surface"), std::string::npos);
  EXPECT_EQ(f.run(kLimited, 0.01).outcome, RunOutcome::failed);
  EXPECT_EQ(f.run(kLimited, 0.01).remark, "too many nodes");
  EXPECT_EQ(f.run(kGreedy, 0.01).outcome, RunOutcome::failed);
  EXPECT_EQ(f.run(kGreedy, 0.01).remark, "out of memory");
  EXPECT_THROW((void)f.run(kOctahedron, 0), ContractViolation);
}

TEST(Convergence, ARunIsCutOffAtItsTimeLimit) {
  Fixture f;
  f.options.time_limit = 0.02;
  const LadderRun run = f.run(kEndless, 0.01);
  EXPECT_EQ(run.outcome, RunOutcome::cut_off);
  EXPECT_GE(run.seconds, 0.02);
  EXPECT_EQ(run.timings, 1);
  EXPECT_EQ(f.run(kOctahedron, 0.5).outcome, RunOutcome::reached);
}

struct Impatience final : Progress {
  bool cancelled() const override { return true; }
};

TEST(Convergence, TheUserMayStopTheLadder) {
  Fixture f;
  Impatience user;
  f.options.progress = &user;
  f.options.tolerances = {0.1};
  f.options.meshers = {&kEndless};
  const auto runs = climb_ladder(f.scene, f.compiled, f.options);
  ASSERT_FALSE(runs);
  EXPECT_EQ(runs.diagnostics().front().failure, Failure::interrupted);
}

TEST(Convergence, TheLadderOfASmoothSurfaceIsOfSecondOrder) {
  Fixture f;
  f.options.tolerances = {0.1, 0.02, 0.005, 0.001};
  f.options.meshers = {&kOctahedron, &kLimited};
  std::size_t visits = 0, meshes = 0;
  const auto visit = [&](const LadderRun& run, Model& model) {
    ++visits;
    meshes += model.parts.empty() ? 0 : 1;
    EXPECT_EQ(run.has_mesh(), !model.parts.empty());
  };
  const auto runs = climb_ladder(f.scene, f.compiled, f.options, visit);
  ASSERT_TRUE(runs);
  EXPECT_EQ(runs->size(), 8u);
  EXPECT_EQ(visits, 8u);
  EXPECT_EQ(meshes, 4u);
  const std::vector<MesherOrders> orders = fit_orders(*runs);
  ASSERT_EQ(orders.size(), 2u);
  ASSERT_TRUE(orders[0].max_by_triangles);
  EXPECT_NEAR(orders[0].max_by_triangles->exponent, -1, 0.1);
  EXPECT_NEAR(orders[0].rms_by_triangles->exponent, -1, 0.1);
  EXPECT_FALSE(orders[1].max_by_triangles);
}

TEST(Convergence, OnlyRunsWithAMeshAreOnTheFront) {
  std::vector<LadderRun> runs(3);
  for (LadderRun& run : runs) run.outcome = RunOutcome::reached;
  runs[0].triangles = 100, runs[0].error.mesh_to_surface_max = 0.1;
  runs[1].triangles = 200, runs[1].error.mesh_to_surface_max = 0.2;
  runs[2].triangles = 50, runs[2].outcome = RunOutcome::failed;
  EXPECT_EQ(pareto_runs(runs, RunCost::triangles), (std::vector<bool>{true, false, false}));
}

TEST(ReferenceUncertainty, IsTheBudgetOverTheSlopeWhereSamplesAreOnTheSurface) {
  const Fixture f;
  const Jet jet = f.compiled.parts[0].surface->jet({1, 0, 0});
  const double step = 1e-4 / norm(jet.gradient);
  EXPECT_NEAR(reference_uncertainty(f.compiled, 1e-4, 2000), step, 0.01 * step);
  EXPECT_LT(reference_uncertainty(f.compiled, 0, 2000), 1e-6);
  EXPECT_GT(reference_uncertainty(f.compiled, 0, 2000), 0);
}

}  // namespace
}  // namespace cs2mesh
