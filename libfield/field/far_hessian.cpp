#include "libfield/field/far_cell.h"
#include "libfield/field/far_field.h"

namespace cs2mesh {

void FarField::add(std::span<const Vec3d> points, std::span<Symmetric3> sums) const {
  const auto add_element = [&](std::uint32_t element, std::size_t i) {
    accumulate((*terms_)[tree_.elements()[element].term], points.subspan(i, 1), sums.subspan(i, 1));
  };
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (root_->holds(points[i])) {
      const Cell& cell = leaf_of(points[i]);
      const double unit = 1 / cell.half;
      sums[i] += (unit * unit) * series_hessian(cell.series, unit * (points[i] - cell.center));
      visit_unresolved(cell, [&](std::uint32_t element) { add_element(element, i); });
    } else {
      for (std::uint32_t e = 0; e < tree_.elements().size(); ++e) add_element(e, i);
    }
  }
}

}  // namespace cs2mesh
