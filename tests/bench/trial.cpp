#include "tests/bench/trial.h"

#include <poll.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <functional>
#include <type_traits>

#include "libfield/art/read_art.h"
#include "libfield/base/peak_memory.h"
#include "polygonize/metrology.h"
#include "polygonize/part_request.h"
#include "polygonize/stage_log.h"

namespace cs2mesh::bench {
namespace {

double clock_seconds() {
  using Clock = std::chrono::steady_clock;
  return std::chrono::duration<double>(Clock::now().time_since_epoch()).count();
}

/// A forked process that hands values back, one after the other. The parent must not have started
/// threads.
class Child {
 public:
  /// `work` gets the end of the pipe to write to. Output that waits in buffers is written first.
  explicit Child(const std::function<void(int)>& work) {
    std::fflush(nullptr);
    int ends[2];
    if (::pipe(ends) != 0) return;
    process_ = ::fork();
    if (process_ == 0) {
      ::close(ends[0]);
      try {
        work(ends[1]);
        ::_exit(0);
      } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
        ::_exit(1);
      }
    }
    ::close(ends[1]);
    from_ = ends[0];
  }
  ~Child() {
    if (from_ >= 0) ::close(from_);
    if (process_ <= 0) return;
    ::kill(process_, SIGKILL);
    ::waitpid(process_, nullptr, 0);
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  enum class Answer { given, late, none };

  /// The next value, if it comes in time.
  template <class T>
  Answer read(double seconds, T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    if (from_ < 0) return Answer::none;
    pollfd waiting{from_, POLLIN, 0};
    const int ready = ::poll(&waiting, 1, static_cast<int>(1000 * seconds));
    if (ready == 0) return Answer::late;
    // Less than a pipe holds, so written at once.
    if (::read(from_, &value, sizeof value) == sizeof value) return Answer::given;
    int status = 0;
    ::waitpid(process_, &status, 0);
    process_ = -1;
    return WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU ? Answer::late : Answer::none;
  }

 private:
  pid_t process_ = -1;
  int from_ = -1;
};

template <class T>
void send(int to, const T& value) {
  if (::write(to, &value, sizeof value) != sizeof value) ::_exit(1);
}

/// The process gets SIGXCPU after so many seconds more of processor time; whole ones.
void limit_cpu(double seconds) {
  rlimit limit{};
  ::getrlimit(RLIMIT_CPU, &limit);
  limit.rlim_cur = std::isfinite(seconds) ? static_cast<rlim_t>(std::ceil(cpu_seconds() + seconds))
                                          : limit.rlim_max;
  ::setrlimit(RLIMIT_CPU, &limit);
}

Result<CompiledScene> compiled(const Subject& subject, Scene& scene) {
  Result<Scene> read =
      subject.path.empty() ? parse_art(subject.text, subject.name) : read_art(subject.path);
  if (!read) return Result<CompiledScene>::failure(read.diagnostics());
  scene = *std::move(read);
  Result<CompiledScene> made = compile(scene);
  if (!made) return made;
  return clip_to_bounds(*std::move(made), scene);
}

void look_at(const Subject& subject, int to) {
  const double start = clock_seconds(), cpu_start = cpu_seconds();
  Scene scene;
  const Result<CompiledScene> made = compiled(subject, scene);
  if (!made) {
    std::fprintf(stderr, "%s\n", to_string(made.diagnostics().front()).c_str());
    return;
  }
  SubjectFacts facts;
  facts.known = true;
  facts.compile_seconds = clock_seconds() - start;
  facts.compile_cpu_seconds = cpu_seconds() - cpu_start;
  facts.primitives = scene.elements.size();
  facts.diagonal = made->extent.diagonal();
  const Vec3d extent = made->parts.front().surface->bounds().extent();
  facts.volume = extent.x * extent.y * extent.z;
  send(to, facts);
}

void measure_mesh(const Part& part, const TriangleMesh& mesh, std::size_t samples, Trial& trial) {
  MeasureOptions measuring;
  measuring.samples = samples;
  measuring.certified_rays = samples / 100;
  const MeasuredError error = measure(*part.surface, mesh, measuring);
  trial.mesh_to_surface = error.mesh_to_surface_max;
  trial.surface_to_mesh = error.surface_to_mesh_max;
  trial.state = TrialState::measured;
}

/// Meshes the first part of a scene with so many threads, counted and timed.
TriangleMesh mesh_timed(CompiledScene counted, const MeshMethod& method,
                        const TrialOptions& options, Trial& trial) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(options.threads));
  EvaluationCounter counter;
  count_evaluations(counted, counter);
  limit_cpu(options.most_seconds);
  const double start = clock_seconds(), cpu_start = cpu_seconds();
  TriangleMesh mesh = method.mesh(counted.parts.front(), trial.size);
  trial.seconds = clock_seconds() - start;
  trial.cpu_seconds = cpu_seconds() - cpu_start;
  trial.evaluations = counter.total();
  trial.peak_memory = peak_memory_bytes();
  trial.vertices = mesh.positions.size();
  trial.triangles = mesh.triangles.size();
  trial.state = mesh.empty() ? TrialState::empty : TrialState::meshed;
  limit_cpu(HUGE_VAL);
  return mesh;
}

/// Measuring takes all cores, since it is no part of the time.
void mesh_and_measure(const Subject& subject, const MeshMethod& method, Trial trial,
                      const TrialOptions& options, int to) {
  Scene scene;
  const double before = cpu_seconds();
  const Result<CompiledScene> made = compiled(subject, scene);
  if (!made) return;
  trial.compile_cpu_seconds = cpu_seconds() - before;
  const TriangleMesh mesh = mesh_timed(*made, method, options, trial);
  send(to, trial);
  if (mesh.empty() || options.samples == 0) return;
  measure_mesh(made->parts.front(), mesh, options.samples, trial);
  send(to, trial);
}

}  // namespace

SubjectFacts facts_of(const Subject& subject) {
  constexpr double kLongest = 120.0;
  SubjectFacts facts;
  Child child([&](int to) { look_at(subject, to); });
  if (child.read(kLongest, facts) != Child::Answer::given) return {};
  return facts;
}

Trial run_trial(const Subject& subject, const MeshMethod& method, double size,
                const TrialOptions& options) {
  Trial trial;
  trial.size = size;
  constexpr double kByTheClock = 10.0;
  Child child([&](int to) { mesh_and_measure(subject, method, trial, options, to); });
  const Child::Answer meshed = child.read(kByTheClock * options.most_seconds, trial);
  if (meshed == Child::Answer::late) {
    trial.state = TrialState::cut_off;
    trial.seconds = options.most_seconds;
  }
  if (meshed != Child::Answer::given || trial.state == TrialState::empty || options.samples == 0) {
    return trial;
  }
  if (child.read(options.most_measure_seconds, trial) != Child::Answer::given) {
    trial.state = TrialState::not_measured;
  }
  return trial;
}

}  // namespace cs2mesh::bench
