// The kernels by name.
#pragma once

#include <array>
#include <optional>
#include <string_view>

namespace cs2mesh {

enum class KernelKind { cauchy, gaussian, inverse, squared, metaball, soft, quartic };

inline constexpr std::array<KernelKind, 7> kAllKernels = {
    KernelKind::cauchy,   KernelKind::gaussian, KernelKind::inverse, KernelKind::squared,
    KernelKind::metaball, KernelKind::soft,     KernelKind::quartic};

/// The word of the scene language for a kernel.
constexpr std::string_view name_of(KernelKind kind) {
  constexpr std::array<std::string_view, 7> kNames = {"cauchy",   "gaussian", "inverse", "squared",
                                                      "metaball", "soft",     "quartic"};
  return kNames[static_cast<std::size_t>(kind)];
}

/// The kernel of that name; `invsquared` and `metaballs` are synonyms.
constexpr std::optional<KernelKind> kernel_of(std::string_view name) {
  if (name == "invsquared") return KernelKind::squared;
  if (name == "metaballs") return KernelKind::metaball;
  for (const KernelKind kind : kAllKernels) {
    if (name == name_of(kind)) return kind;
  }
  return std::nullopt;
}

}  // namespace cs2mesh
