// Sums of exponents with AVX2; its flags are in libfield/CMakeLists.txt.
#include "libfield/field/exponents_pack.h"

namespace cs2mesh::detail {

extern const ExponentTable kExponentsAvx2;
constinit const ExponentTable kExponentsAvx2 = ExponentsPack<4>::table();

}  // namespace cs2mesh::detail
