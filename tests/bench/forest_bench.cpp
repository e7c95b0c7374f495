// The cost of an evaluation near the surface of a forest, by the number of its bones: compile time,
// memory (the terms and all that is made of them; that of the first line alone, where later ones
// reuse what it has given back), time a point with the set-up of cells included, and the error
// against the full sum.
//
//     forest_bench [points a bone [bones]]

#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>
#include <vector>

#include "libfield/base/random.h"
#include "libfield/field/field.h"
#include "libfield/integral/isolation.h"

namespace cs2mesh {
namespace {

/// Processor time, all of it one thread's: what else the machine does counts less.
double processor_seconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}
double seconds_since(double start) {
  return processor_seconds() - start;
}

struct Bone {
  Segment segment;
  double radius;
};

/// Adds a branch and, up to the depth, the two that grow out of its end.
void grow(Random& random, const Vec3d& root, const Vec3d& direction, double length, int depth,
          std::vector<Bone>& bones) {
  const Vec3d end = root + length * direction;
  bones.push_back({{root, end}, 0.09 * length});
  if (depth == 0) return;
  for (int child = 0; child < 2; ++child) {
    const Vec3d aside = random.direction();
    const Vec3d turned = normalized(direction + 0.7 * aside + Vec3d{0, 0, 0.15});
    grow(random, end, turned, length * random.uniform(0.78, 0.92), depth - 1, bones);
  }
}

/// Trees of 1,000 bones or fewer on a jittered square grid.
std::vector<Bone> forest(std::size_t count) {
  std::vector<Bone> bones;
  const std::size_t trees = (count + 999) / 1000;
  const auto side = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(trees))));
  for (std::size_t t = 0; bones.size() < count; ++t) {
    Random random(3, t);
    const Vec3d root{4.5 * static_cast<double>(t % side) + random.uniform(-0.8, 0.8),
                     4.5 * static_cast<double>(t / side) + random.uniform(-0.8, 0.8), 0};
    std::vector<Bone> tree;
    grow(random, root, {0, 0, 1}, 1.0, 9, tree);
    tree.resize(std::min({tree.size(), std::size_t{1000}, count - bones.size()}));
    bones.insert(bones.end(), tree.begin(), tree.end());
  }
  return bones;
}

Term term_of(const Bone& bone, KernelKind kind, bool points) {
  Term term;
  term.primitive =
      points ? Primitive(Point{0.5 * (bone.segment.a + bone.segment.b)}) : Primitive(bone.segment);
  term.frame = frame_of(term.primitive);
  const Isolation isolation = isolate(kind, term.primitive, bone.radius, -2.0);
  term.kernel = make_kernel(kind, isolation.width, isolation.strength, isolation.log_strength, 0);
  return term;
}

/// Points about a bone at its radius, give or take a fifth.
void add_points(Random& random, const Bone& bone, bool at_middle, std::size_t count,
                std::vector<Vec3d>& points) {
  const Vec3d axis = bone.segment.b - bone.segment.a;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3d aside = normalized(cross(axis, random.direction()));
    const double along = at_middle ? 0.5 : random.uniform();
    points.push_back(bone.segment.a + along * axis +
                     bone.radius * random.uniform(0.8, 1.2) * aside);
  }
}

double peak_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return 1024.0 * static_cast<double>(usage.ru_maxrss);
}

/// The greatest difference from the sum of all terms, over some of the points.
double worst_error(const Field& field, const std::vector<Vec3d>& points, std::size_t checks) {
  std::vector<Vec3d> some;
  for (std::size_t i = 0; i < checks; ++i) some.push_back(points[i * points.size() / checks]);
  std::vector<Jet> jets(some.size()), full(some.size());
  field.jets(some, jets);
  field.full_jets(some, full);
  double worst = 0.0;
  for (std::size_t i = 0; i < some.size(); ++i) {
    worst = std::max(worst, std::abs(jets[i].value + 1.0 - full[i].value));
  }
  return worst;
}

void report(KernelKind kind, bool as_points, std::size_t count, std::size_t a_bone, bool apart) {
  const std::vector<Bone> bones = forest(count);
  const double before = peak_bytes();
  std::vector<Term> terms;
  terms.reserve(bones.size());
  for (const Bone& bone : bones) terms.push_back(term_of(bone, kind, as_points));
  const auto wall_start = std::chrono::steady_clock::now();
  const auto start = processor_seconds();
  const Field field(std::move(terms), 1e-9);
  const double compile = seconds_since(start);
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - wall_start;
  const double bytes = peak_bytes() - before;

  // Around 1,000 bones: those of one tree, or here and there.
  std::vector<Vec3d> points;
  Random random(5);
  for (std::size_t i = 0; i < 1000; ++i) {
    const std::size_t bone = apart ? i * (count / 1000) : count / 2000 * 1000 + i;
    add_points(random, bones[bone], as_points, a_bone, points);
  }
  std::vector<double> values(points.size());
  std::vector<Jet> jets(points.size());
  auto lap = processor_seconds();
  field.values(points, values);
  const double first = seconds_since(lap);
  lap = processor_seconds();
  field.values(points, values);
  const double again = seconds_since(lap);
  lap = processor_seconds();
  field.jets(points, jets);
  const double with_gradient = seconds_since(lap);
  const double n = static_cast<double>(points.size());
  const std::size_t checks = std::min<std::size_t>(points.size(), 200'000'000 / count);
  std::printf("%-8s %-8s %7zu %-8s %8.3f %8.3f %8.0f %9.0f %9.0f %9.0f   %.1e at %zu\n",
              std::string(name_of(kind)).c_str(), as_points ? "points" : "segments", count,
              apart ? "apart" : "together", compile, wall.count(),
              bytes / static_cast<double>(count), 1e9 * first / n, 1e9 * again / n,
              1e9 * with_gradient / n, worst_error(field, points, checks), checks);
  std::fflush(stdout);
}

}  // namespace
}  // namespace cs2mesh

int main(int argc, char** argv) {
  using cs2mesh::KernelKind;
  const std::size_t a_bone = argc > 1 ? std::strtoul(argv[1], nullptr, 10) : 100;
  const std::size_t only = argc > 2 ? std::strtoul(argv[2], nullptr, 10) : 0;
  std::printf(
      "kernel   shape      bones places    compile, elapsed,  bytes/   ns/point: values   "
      "again,\n");
  std::printf(
      "                                      cpu s        s     bone  with set-up    again    jets"
      "   error / T\n");
  for (const bool apart : {false, true}) {
    for (const KernelKind kind : {KernelKind::cauchy, KernelKind::gaussian}) {
      for (const bool as_points : {false, true}) {
        for (const std::size_t count : {1000, 10'000, 100'000}) {
          if (only != 0 && count != only) continue;
          cs2mesh::report(kind, as_points, count, a_bone, apart);
        }
      }
    }
  }
}
