// Sums of exponents with AVX-512; its flags are in libfield/CMakeLists.txt.
#include "libfield/field/exponents_pack.h"

namespace cs2mesh::detail {

extern const ExponentTable kExponentsAvx512;
constinit const ExponentTable kExponentsAvx512 = ExponentsPack<8>::table();

}  // namespace cs2mesh::detail
