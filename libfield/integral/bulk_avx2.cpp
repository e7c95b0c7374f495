// The bulk integrals with AVX2; its flags are in libfield/CMakeLists.txt.
#include "libfield/integral/bulk_pack.h"

namespace cs2mesh::detail {

extern const BulkTable kBulkAvx2;
constinit const BulkTable kBulkAvx2 = BulkPack<4>::table();

}  // namespace cs2mesh::detail
