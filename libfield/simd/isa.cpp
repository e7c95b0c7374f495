#include "libfield/simd/isa.h"

#include <algorithm>
#include <atomic>

#include "libfield/base/check.h"

namespace cs2mesh {
namespace {

std::vector<Isa> detect() {
  std::vector<Isa> found{Isa::portable};
#if CS2MESH_WIDE_ISAS
  // As the flags in CMakeLists.txt; the operating system's consent is part of the answer.
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx2")) found.push_back(Isa::avx2);
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512vl")) {
    found.push_back(Isa::avx512);
  }
#endif
  return found;
}

std::atomic<Isa>& active() {
  static std::atomic<Isa> isa{available_isas().back()};
  return isa;
}

}  // namespace

std::string_view name_of(Isa isa) {
  switch (isa) {
    case Isa::portable:
      return "portable";
    case Isa::avx2:
      return "avx2";
    case Isa::avx512:
      break;
  }
  return "avx512";
}

const std::vector<Isa>& available_isas() {
  static const std::vector<Isa> isas = detect();
  return isas;
}

Isa active_isa() {
  return active().load(std::memory_order_relaxed);
}

void use_isa(Isa isa) {
  const std::vector<Isa>& isas = available_isas();
  require(std::find(isas.begin(), isas.end(), isa) != isas.end(), "no such instructions here");
  active().store(isa, std::memory_order_relaxed);
}

}  // namespace cs2mesh
