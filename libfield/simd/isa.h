// The instruction sets that hot loops are compiled for.
#pragma once

#include <string_view>
#include <vector>

namespace cs2mesh {

/// In the order of their width: 2, 4 and 8 doubles at a time.
enum class Isa { portable, avx2, avx512 };

std::string_view name_of(Isa isa);

/// Those that this machine runs and this build has, the widest last.
const std::vector<Isa>& available_isas();

/// The one in use: the widest available, or what use_isa() said last.
Isa active_isa();

/// For tests and benchmarks: which to use from now on, in all threads. It must be available.
void use_isa(Isa isa);

}  // namespace cs2mesh
