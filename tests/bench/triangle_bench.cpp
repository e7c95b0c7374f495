// Meshes a scene with the adaptive mesher and tells how well its triangles are used: how many there
// are beside the optimum, their angles and valences, and which share of the tolerance each of them
// needs.
//
//   triangle_bench SCENE TOLERANCE [balance]
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "polygonize/mesher.h"
#include "polygonize/part_request.h"
#include "polygonize/triangle_sample.h"
#include "polygonize/triangle_shape.h"
#include "tests/bench/bench_scene.h"
#include "tests/bench/largest_triangle.h"

namespace cs2mesh {
namespace {

using bench::processor_seconds;

/// A histogram over [0, 1) in equal steps, with what is beyond in a last one.
class Histogram {
 public:
  explicit Histogram(std::size_t steps) : count_(steps + 1, 0) {}
  void add(double x) {
    const auto steps = static_cast<double>(count_.size() - 1);
    ++count_[static_cast<std::size_t>(std::clamp(x * steps, 0.0, steps))];
    ++all_;
  }
  void print(const char* what, double scale) const {
    std::printf("  %s:", what);
    for (std::size_t i = 0; i < count_.size(); ++i) {
      const double from = scale * static_cast<double>(i) / static_cast<double>(count_.size() - 1);
      std::printf(" %.4g:%.3f%%", from,
                  100.0 * static_cast<double>(count_[i]) / static_cast<double>(all_));
    }
    std::printf("\n");
  }

 private:
  std::vector<std::size_t> count_;
  std::size_t all_ = 0;
};

/// The greater principal curvature of a surface at a point, and the lesser over it.
struct Curvature {
  double greater = 0.0, ratio = 0.0;
};

Curvature curvature_of(const Jet2& jet) {
  const double slope = norm(jet.gradient);
  const Vec3d n = jet.gradient / slope;
  const Vec3d side = std::abs(n.x) < 0.6 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
  const Vec3d u = cross(n, side) / norm(cross(n, side)), v = cross(n, u);
  const Vec3d hu = jet.hessian * u, hv = jet.hessian * v;
  const double uu = dot(u, hu) / slope, vv = dot(v, hv) / slope, uv = dot(u, hv) / slope;
  const double mean = 0.5 * std::abs(uu + vv), radius = std::hypot(0.5 * (uu - vv), uv);
  return {mean + radius, mean + radius > 0 ? (mean - radius) / (mean + radius) : 0.0};
}

/// Of a part of the surface: the triangles that there are, and that there could be.
struct Use {
  double triangles = 0.0;
  double hexagonal = 0.0;  ///< 0.385 / tolerance times the integral of sqrt |k1 k2|
  double least = 0.0;      ///< of triangles without thin ones

  Use& operator+=(const Use& other) {
    triangles += other.triangles;
    hexagonal += other.hexagonal;
    least += other.least;
    return *this;
  }
  void print() const {
    std::printf("%.0f triangles, %.3f x %.0f, %.3f x %.0f\n", triangles, triangles / hexagonal,
                hexagonal, triangles / least, least);
  }
};

/// By the ratio of curvatures, in equal steps from -1 to 1.
constexpr int kRatios = 20;
using Uses = std::array<Use, kRatios>;

Uses uses_of(const ImplicitSurface& surface, const TriangleMesh& mesh, double tolerance,
             bool balance) {
  std::vector<Vec3d> points;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) points.push_back(centroid(mesh, t));
  std::vector<Jet2> jets(points.size());
  surface.second_jets(points, jets);
  std::array<double, kRatios> largest{};
  for (int i = 0; i < kRatios; ++i) {
    const double ratio = 2 * (i + 0.5) / kRatios - 1;
    largest[static_cast<std::size_t>(i)] = bench::largest_triangle(ratio, kThinAngle, balance);
  }
  // A triangle of circumradius c on a sphere of radius R is c^2 / (2 R) off.
  const double hexagon = 1.5 * std::sqrt(3.0) * (balance ? 2 : 1);
  Uses uses;
  for (std::size_t t = 0; t < points.size(); ++t) {
    const auto [greater, ratio] = curvature_of(jets[t]);
    const double part = norm(area_vector(mesh, t)) * greater / tolerance;
    const auto i =
        static_cast<std::size_t>(std::clamp(0.5 * kRatios * (ratio + 1), 0.0, kRatios - 1.0));
    uses[i] += {1, part * std::sqrt(std::abs(ratio)) / hexagon, part / largest[i]};
  }
  return uses;
}

void print_uses(const Uses& uses) {
  std::printf("  triangles beside the least of equilateral ones, and of any without thin ones:\n");
  Use all;
  for (std::size_t i = 0; i < kRatios; ++i) {
    all += uses[i];
    if (uses[i].triangles == 0) continue;
    std::printf("    k2 / k1 from %.1f: ", 2.0 * static_cast<double>(i) / kRatios - 1);
    uses[i].print();
  }
  std::printf("    all: ");
  all.print();
}

/// The first-order distance of each triangle where it is looked at.
std::vector<double> distances(const ImplicitSurface& surface, const TriangleMesh& mesh) {
  std::vector<double> all;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    std::vector<Vec3d> points = more_points(mesh, t, Look::closer);
    points.push_back(sample_point(mesh, t));
    std::vector<Jet> jets(points.size());
    surface.jets(points, jets);
    double most = 0.0;
    for (const Jet& jet : jets) most = std::max(most, first_order_distance(jet, HUGE_VAL));
    all.push_back(most);
  }
  return all;
}

void print_shapes(const TriangleMesh& mesh) {
  Histogram angles(12);
  for (const auto& [a, b, c] : mesh.triangles) {
    angles.add(smallest_angle(mesh.positions[a], mesh.positions[b], mesh.positions[c]) / 60.0);
  }
  const TriangleShapes shapes = triangle_shapes(mesh);
  std::printf(
      "  smallest angle %.3g deg; below 20 deg: %zu, %.4f %%\n", shapes.min_angle_deg, shapes.thin,
      100.0 * static_cast<double>(shapes.thin) / static_cast<double>(mesh.triangles.size()));
  angles.print("angles", 60.0);
  std::vector<int> valence(mesh.positions.size(), 0);
  for (const auto& t : mesh.triangles) {
    for (const auto v : t) ++valence[v];
  }
  std::array<std::size_t, 13> count{};
  for (const int n : valence) ++count[static_cast<std::size_t>(std::min(n, 12))];
  std::printf("  valence:");
  for (std::size_t n = 3; n < count.size(); ++n) {
    std::printf(" %zu:%.3f%%", n,
                100.0 * static_cast<double>(count[n]) / static_cast<double>(valence.size()));
  }
  std::printf("\n");
}

int run(const char* path, double tolerance, bool balance) {
  const Result<CompiledScene> compiled = bench::compile_file(path);
  if (!compiled) return 2;
  if (tolerance < 0) tolerance *= -compiled->extent.diagonal();
  for (const Part& part : compiled->parts) {
    const double start = processor_seconds();
    MesherRequest request = request_for(part, tolerance, nullptr);
    request.balance = balance;
    const Result<MesherResult> made = meshers().front().mesh(*part.surface, request);
    if (!made || made->mesh.empty()) continue;
    const TriangleMesh& mesh = made->mesh;
    std::printf("%s %s tolerance %.3g: %zu triangles in %.2f s of processor time\n", path,
                part.name.c_str(), tolerance, mesh.triangles.size(), processor_seconds() - start);
    print_uses(uses_of(*part.surface, mesh, tolerance, balance));
    print_shapes(mesh);
    Histogram used(20);
    for (const double d : distances(*part.surface, mesh)) used.add(d / tolerance);
    used.print("share of the tolerance", 1.0);
  }
  return 0;
}

}  // namespace
}  // namespace cs2mesh

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr,
                 "usage: triangle_bench SCENE TOLERANCE [balance]\n"
                 "a tolerance below 0 is a part of the diagonal, as -0.001\n");
    return 2;
  }
  return cs2mesh::run(argv[1], std::strtod(argv[2], nullptr), argc > 3);
}
