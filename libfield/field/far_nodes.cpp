#include "libfield/field/far_nodes.h"

#include "libfield/integral/gauss_legendre.h"

namespace cs2mesh {
namespace {

template <std::size_t N>
void append_rule(const FarElement& element, const PointSource& law,
                 std::vector<PointSource>& points) {
  constexpr const UnitRule<N>& rule = kUnitRule<static_cast<int>(N)>;
  for (std::size_t i = 0; i < N; ++i) {
    PointSource point = law;
    const double weight = element.length * rule.weight[i];
    point.position = element.a + rule.node[i] * (element.b - element.a);
    point.gain *= weight;
    point.slope *= weight;
    points.push_back(point);
  }
}

}  // namespace

double node_factor(double two_nu, int n) {
  double factor = 1.0;
  for (int m = 1; m <= 2 * n; ++m) factor *= (m + two_nu - 1) / m;
  for (int m = 1; m <= n; ++m) {
    const double ratio = static_cast<double>(m) / (n + m);  // (n!)^2 / (2n)!, squared
    factor *= ratio * ratio;
  }
  return factor / (2 * n + 1) * (1 + 1e-12);
}

void append_nodes(const FarElement& element, const PointSource& law, int nodes,
                  std::vector<PointSource>& points) {
  switch (nodes) {
    case 1:
      points.push_back(law);
      return;
    case 2:
      return append_rule<2>(element, law, points);
    case 4:
      return append_rule<4>(element, law, points);
    case 6:
      return append_rule<6>(element, law, points);
    default:
      return append_rule<8>(element, law, points);
  }
}

}  // namespace cs2mesh
