#include "libfield/field/exponents.h"

#include "libfield/field/exponents_pack.h"
#include "libfield/simd/isa.h"

namespace cs2mesh {
namespace detail {
namespace {
constinit const ExponentTable kExponentsPortable = ExponentsPack<2>::table();
}  // namespace
extern const ExponentTable kExponentsAvx2;
extern const ExponentTable kExponentsAvx512;
}  // namespace detail

const ExponentTable& exponent_table() {
#if CS2MESH_WIDE_ISAS
  if (active_isa() == Isa::avx512) return detail::kExponentsAvx512;
  if (active_isa() == Isa::avx2) return detail::kExponentsAvx2;
#endif
  return detail::kExponentsPortable;
}

}  // namespace cs2mesh
