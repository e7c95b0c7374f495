// The bulk integrals with what every machine has; its flags are in libfield/CMakeLists.txt.
#include "libfield/integral/bulk_pack.h"

namespace cs2mesh::detail {

extern const BulkTable kBulkPortable;
constinit const BulkTable kBulkPortable = BulkPack<2>::table();

}  // namespace cs2mesh::detail
