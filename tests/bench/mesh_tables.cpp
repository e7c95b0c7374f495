#include "tests/bench/mesh_tables.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

namespace cs2mesh::bench {
namespace {

/// Tries of a size, and the share of the tolerance from which on a distance is near enough.
constexpr int kMostTries = 7;
constexpr double kNear = 0.85;
/// Samples of the tries before the last.
constexpr std::size_t kFewSamples = 100'000;
/// A grid that would take more is not tried.
constexpr double kMostBytes = 6e9;

struct Found {
  std::optional<Trial> best;  ///< within the tolerance, of the largest size
  Trial last;
  bool too_large = false;  ///< for memory
};

/// The next size where the distance falls with a power of the size, of late `exponent`.
double next_size(const Trial& trial, const std::optional<Trial>& before, double tolerance) {
  double exponent = 1.5;
  if (before && std::isfinite(before->error()) && before->size != trial.size) {
    exponent = std::log(trial.error() / before->error()) / std::log(trial.size / before->size);
    exponent = std::clamp(exponent, 0.8, 2.5);
  }
  constexpr double kAim = 0.94, kStep = 4.0;
  const double error = std::isfinite(trial.error()) ? trial.error() : 8 * tolerance;
  const double factor = std::pow(kAim * tolerance / error, 1 / exponent);
  return trial.size * std::clamp(factor, 1 / kStep, kStep);
}

Found search(const TableRequest& request, const SubjectFacts& facts, const MeshMethod& method,
             double tolerance) {
  TrialOptions options;
  options.threads = request.threads;
  options.most_seconds = request.most_seconds;
  options.samples = std::min(request.samples, kFewSamples);
  Found found;
  std::optional<Trial> before;
  double size = method.first_size * tolerance, too_small = 0.0, too_large = HUGE_VAL;
  for (int i = 0; i < kMostTries; ++i) {
    found.too_large = method.bytes_a_cell * facts.volume > kMostBytes * size * size * size;
    if (found.too_large) break;
    const Trial trial = run_trial(request.subject, method, size, options);
    found.last = trial;
    if (trial.state != TrialState::measured) break;
    if (trial.error() <= tolerance) {
      if (!found.best || size > found.best->size) found.best = trial;
      too_small = std::max(too_small, size);
      if (trial.error() >= kNear * tolerance) break;
    } else {
      too_large = std::min(too_large, size);
    }
    double next = next_size(trial, before, tolerance);
    // Distances need not fall evenly: stay between what is known.
    if (too_small > 0 && too_large < HUGE_VAL && !(next > too_small && next < too_large)) {
      next = std::sqrt(too_small * too_large);
    }
    if (too_small > 0 && too_large < 1.05 * too_small) break;
    before = trial;
    size = next;
  }
  if (found.best && request.samples > kFewSamples) {
    options.samples = request.samples;
    const Trial trial = run_trial(request.subject, method, found.best->size, options);
    if (trial.state == TrialState::measured) found.best = trial;
  }
  return found;
}

double mega(std::uint64_t count) {
  return 1e-6 * static_cast<double>(count);
}

void print_row(const MeshMethod& method, const Trial& t, double tolerance, const char* note) {
  std::printf("%-24s %9llu %9.2f %9.2f %10.3e %10.3e %8.3f %8.3f %8.3f %8.1f  %s\n",
              method.name.data(), static_cast<unsigned long long>(t.triangles), t.seconds,
              t.cpu_seconds, t.mesh_to_surface, t.surface_to_mesh, mega(t.evaluations.values),
              mega(t.evaluations.gradients), mega(t.evaluations.enclosures),
              static_cast<double>(t.peak_memory) / 0x1p20,
              t.error() <= tolerance ? note : "over the tolerance");
}

void print_without_mesh(const MeshMethod& method, const Trial& trial) {
  switch (trial.state) {
    case TrialState::cut_off:
      std::printf("%-24s not within %.0f s of processor time (size %.3e)\n", method.name.data(),
                  trial.seconds, trial.size);
      break;
    case TrialState::not_measured:
      std::printf("%-24s %9llu %9.2f %9.2f   measuring took too long\n", method.name.data(),
                  static_cast<unsigned long long>(trial.triangles), trial.seconds,
                  trial.cpu_seconds);
      break;
    default:
      std::printf("%-24s no mesh (%.2f s)\n", method.name.data(), trial.seconds);
  }
}

void print_found(const MeshMethod& method, const Found& found, double tolerance) {
  if (found.best) {
    print_row(method, *found.best, tolerance, "");
  } else if (found.too_large) {
    std::printf("%-24s its grid would take more than %.0f GB\n", method.name.data(),
                1e-9 * kMostBytes);
    if (found.last.state == TrialState::measured) print_row(method, found.last, tolerance, "");
  } else if (found.last.state == TrialState::measured) {
    print_row(method, found.last, tolerance, "");
  } else {
    print_without_mesh(method, found.last);
  }
}

}  // namespace

bool print_table(const TableRequest& request) {
  const SubjectFacts facts = facts_of(request.subject);
  if (!facts.known) return false;
  const double tolerance =
      request.tolerance > 0 ? request.tolerance : -request.tolerance * facts.diagonal;
  std::printf(
      "\n%s: %llu primitives, compiled in %.3f s; tolerance %.3e = %.4f %% of the diagonal; "
      "%d thread%s\n",
      request.subject.name.c_str(), static_cast<unsigned long long>(facts.primitives),
      facts.compile_seconds, tolerance, 100 * tolerance / facts.diagonal, request.threads,
      request.threads == 1 ? "" : "s");
  std::printf("%-24s %9s %9s %9s %10s %10s %8s %8s %8s %8s\n", "", "triangles", "seconds", "cpu s",
              "mesh->surf", "surf->mesh", "M values", "M grads", "M bounds", "MiB");
  for (const MeshMethod* method : request.methods) {
    if (method->ours) {
      TrialOptions options;
      options.threads = request.threads;
      options.most_seconds = request.most_seconds;
      options.samples = request.samples;
      const Trial trial = run_trial(request.subject, *method, tolerance, options);
      if (trial.state == TrialState::measured) {
        print_row(*method, trial, tolerance, "");
      } else {
        print_without_mesh(*method, trial);
      }
    } else {
      print_found(*method, search(request, facts, *method, tolerance), tolerance);
    }
    std::fflush(stdout);
  }
  return true;
}

}  // namespace cs2mesh::bench
