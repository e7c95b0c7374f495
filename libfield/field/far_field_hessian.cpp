#include "libfield/field/far_field.h"

namespace cs2mesh {

void FarField::add(std::span<const Vec3d> points, std::span<Symmetric3> sums) const {
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3d& p = points[i];
    const Parts parts = parts_at(p);
    if (parts.series != nullptr) {
      const double unit = 1 / parts.half;
      sums[i] += (unit * unit) * series_hessian(*parts.series, unit * (p - parts.center));
    }
    for (const std::uint32_t term : parts.terms) {
      accumulate((*terms_)[term], {&p, 1}, {&sums[i], 1});
    }
  }
}

}  // namespace cs2mesh
