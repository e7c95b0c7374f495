#include "tests/bench/mesh_growth.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <vector>

#include "polygonize/power_fit.h"

namespace cs2mesh::bench {
namespace {

/// What a run may hold: 64 MiB, 300 bytes a triangle and 1 KiB a primitive.
double allowed_bytes(double triangles, double primitives) {
  return 64 * 0x1p20 + 300 * triangles + 1024 * primitives;
}

/// Points of a ladder.
struct Ladder {
  std::vector<double> x, seconds;

  void print(const char* of) const {
    if (const auto fit = fit_power(x, seconds)) {
      std::printf("cpu seconds grow with the power %.3f (+- %.3f) of %s\n", fit->exponent,
                  fit->deviation, of);
    }
  }
};

std::string vector_text(const Vec3d& p) {
  char text[96];
  std::snprintf(text, sizeof text, "<%.17g %.17g %.17g>", p.x, p.y, p.z);
  return text;
}

/// A coil of a hundred Gaussian segments, each cut into equal pieces: the same field, the same
/// surface, whatever their number.
std::string cut_coil(std::size_t primitives) {
  constexpr std::size_t kSegments = 100;
  const std::size_t pieces = std::max<std::size_t>(1, primitives / kSegments);
  const auto corner = [](std::size_t i) {
    const double turn = 6 * std::numbers::pi * static_cast<double>(i) / kSegments;
    return Vec3d{2 * std::cos(turn), 2 * std::sin(turn), 0.25 * turn};
  };
  std::string text = "surface s { kernel gaussian blobbiness -4 }\n";
  for (std::size_t i = 0; i < kSegments; ++i) {
    const Vec3d a = corner(i), b = corner(i + 1);
    for (std::size_t k = 0; k < pieces; ++k) {
      const auto at = [&](std::size_t j) {
        return a + (static_cast<double>(j) / static_cast<double>(pieces)) * (b - a);
      };
      text += "cylinder s 0.4 " + vector_text(at(k)) + " " + vector_text(at(k + 1)) + "\n";
    }
  }
  return text;
}

/// A ball of radius 1 with small ones inside, none of which comes near its surface.
std::string filled_ball(const std::string& kernel, std::size_t primitives) {
  std::string text = "surface s { kernel gaussian blobbiness -4 }\nsurface t { kernel " + kernel +
                     " blobbiness -2 }\nsphere s 1 <0 0 0>\n";
  const double golden = std::numbers::pi * (3 - std::sqrt(5.0));
  const auto count = static_cast<double>(primitives - 1);
  // So many balls of that size fill the inner ball about once.
  const double radius = 0.5 * std::cbrt(1 / count);
  for (std::size_t i = 1; i < primitives; ++i) {
    const double share = (static_cast<double>(i) - 0.5) / count;
    const double height = 1 - 2 * std::fmod(0.618034 * static_cast<double>(i), 1.0);
    const double across = std::sqrt(1 - height * height), turn = golden * static_cast<double>(i);
    const Vec3d direction{across * std::cos(turn), across * std::sin(turn), height};
    char size[32];
    std::snprintf(size, sizeof size, "sphere t %.6g ", radius);
    text += size + vector_text(0.4 * std::cbrt(share) * direction) + "\n";
  }
  return text;
}

/// Of finite reach.
std::string filled_by_soft(std::size_t primitives) {
  return filled_ball("soft", primitives);
}
/// Of bounds that are cheap, so that the topology is proven.
std::string filled_by_gaussian(std::size_t primitives) {
  return filled_ball("gaussian", primitives);
}

struct Family {
  const char* name;
  std::string (*scene)(std::size_t primitives);
  double tolerance;
};
constexpr std::array<Family, 3> kFamilies{{
    {"a coil of 100 segments, cut into pieces", cut_coil, 0.004},
    {"a ball around small soft balls that do not reach its surface", filled_by_soft, 0.0005},
    {"a ball around small Gaussian balls likewise", filled_by_gaussian, 0.0005},
}};

void print_memory(const Trial& trial, double primitives) {
  const double allowed = allowed_bytes(static_cast<double>(trial.triangles), primitives);
  std::printf(" %9.1f %9.1f %7.2f\n", static_cast<double>(trial.peak_memory) / 0x1p20,
              allowed / 0x1p20, static_cast<double>(trial.peak_memory) / allowed);
}

bool print_if_without_mesh(const Trial& trial) {
  if (trial.state == TrialState::meshed) return false;
  std::printf("   %s\n",
              trial.state == TrialState::cut_off ? "not in the time that there is" : "no mesh");
  return true;
}

}  // namespace

void print_growth_by_triangles(const Subject& subject, const GrowthRequest& request) {
  const SubjectFacts facts = facts_of(subject);
  if (!facts.known) return;
  std::printf("\n%s, %s: time against triangles\n", subject.name.c_str(),
              request.method->name.data());
  std::printf("%10s %10s %9s %9s %9s %9s %7s %9s %9s %7s\n", "tolerance", "triangles", "1 thread",
              "cpu s", "2 threads", "cpu s", "ratio", "MiB", "allowed", "share");
  TrialOptions options;
  options.most_seconds = request.most_seconds;
  Ladder ladder;
  double tolerance = 4e-3 * facts.diagonal, triangles = 0;
  constexpr double kNextStep = 2.5;  // of the four times as many that there will be
  for (; kNextStep * triangles < request.most_triangles; tolerance /= 4) {
    options.threads = 1;
    const Trial one = run_trial(subject, *request.method, tolerance, options);
    std::printf("%10.3e", tolerance);
    if (print_if_without_mesh(one)) break;
    options.threads = 2;
    const Trial two = run_trial(subject, *request.method, tolerance, options);
    triangles = static_cast<double>(one.triangles);
    std::printf(" %10.0f %9.2f %9.2f %9.2f %9.2f %7.2f", triangles, one.seconds, one.cpu_seconds,
                two.seconds, two.cpu_seconds, one.seconds / two.seconds);
    print_memory(one, static_cast<double>(facts.primitives));
    std::fflush(stdout);
    ladder.x.push_back(triangles);
    ladder.seconds.push_back(one.cpu_seconds);
  }
  ladder.print("triangles");
}

void print_growth_by_primitives(const GrowthRequest& request) {
  TrialOptions options;
  options.most_seconds = request.most_seconds;
  for (const Family& family : kFamilies) {
    std::printf("\n%s, %s: time against primitives\n", family.name, request.method->name.data());
    std::printf("%10s %10s %10s %9s %9s %9s %9s %9s %7s\n", "primitives", "triangles", "compile s",
                "mesh s", "values M", "bounds M", "MiB", "allowed", "share");
    Ladder ladder;
    for (double primitives = 100; primitives <= request.most_primitives; primitives *= 10) {
      const Subject subject{family.name, "", family.scene(static_cast<std::size_t>(primitives))};
      const Trial trial = run_trial(subject, *request.method, family.tolerance, options);
      std::printf("%10.0f", primitives);
      if (print_if_without_mesh(trial)) break;
      std::printf(" %10llu %10.3f %9.2f %9.2f %9.2f",
                  static_cast<unsigned long long>(trial.triangles), trial.compile_cpu_seconds,
                  trial.cpu_seconds, 1e-6 * static_cast<double>(trial.evaluations.values),
                  1e-6 * static_cast<double>(trial.evaluations.enclosures));
      print_memory(trial, primitives);
      std::fflush(stdout);
      ladder.x.push_back(primitives);
      ladder.seconds.push_back(trial.compile_cpu_seconds + trial.cpu_seconds);
    }
    ladder.print("primitives");
  }
}

}  // namespace cs2mesh::bench
