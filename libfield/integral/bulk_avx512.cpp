// The bulk integrals with AVX-512; its flags are in libfield/CMakeLists.txt.
#include "libfield/integral/bulk_pack.h"

namespace cs2mesh::detail {

extern const BulkTable kBulkAvx512;
constinit const BulkTable kBulkAvx512 = BulkPack<8>::table();

}  // namespace cs2mesh::detail
