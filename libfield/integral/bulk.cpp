#include "libfield/integral/bulk.h"

namespace cs2mesh {
namespace detail {
extern const BulkTable kBulkPortable;
extern const BulkTable kBulkAvx2;
extern const BulkTable kBulkAvx512;
}  // namespace detail

const BulkTable& bulk_table() {
#if CS2MESH_WIDE_ISAS
  if (active_isa() == Isa::avx512) return detail::kBulkAvx512;
  if (active_isa() == Isa::avx2) return detail::kBulkAvx2;
#endif
  return detail::kBulkPortable;
}

}  // namespace cs2mesh
