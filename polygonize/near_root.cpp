#include "polygonize/near_root.h"

#include <algorithm>
#include <vector>

#include "libfield/base/check.h"
#include "polygonize/edge_root.h"

namespace cs2mesh {
namespace {

/// A query on its way.
struct Stretch {
  std::size_t query = 0;
  double reach = 0.0;
};

bool inside(const Jet& jet) {
  return jet.value >= 0;
}

}  // namespace

void find_near_roots(const ImplicitSurface& surface, std::span<const RootQuery> queries,
                     std::span<std::optional<Vec3d>> roots) {
  require(queries.size() == roots.size(), "find_near_roots: one root a query");
  // Beyond the guess, so that F has changed its sign where it is nearly linear; never nothing, as
  // the point may be on the surface already.
  constexpr double kBeyond = 1.05, kLeast = 1e-3;
  std::vector<Stretch> open;
  Aabb box;
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const RootQuery& q = queries[i];
    roots[i].reset();
    open.push_back({i, std::min(kBeyond * q.guess + kLeast * q.limit, q.limit)});
    box.include(Aabb{q.point, q.point}.grown(q.limit));
  }
  if (open.empty()) return;
  const auto local = surface.restrict_to(box);

  // Grow the stretches to changes of sign.
  std::vector<CrossedEdge> crossed;
  std::vector<std::size_t> found;
  while (!open.empty()) {
    std::vector<Vec3d> ends;
    for (const Stretch& s : open) {
      const RootQuery& q = queries[s.query];
      ends.push_back(q.point - s.reach * q.direction);
      ends.push_back(q.point + s.reach * q.direction);
    }
    std::vector<Jet> jets(ends.size());
    local->jets(ends, jets);
    std::vector<Stretch> still;
    for (std::size_t k = 0; k < open.size(); ++k) {
      const Stretch& s = open[k];
      const double limit = queries[s.query].limit;
      if (inside(jets[2 * k]) != inside(jets[2 * k + 1])) {
        crossed.push_back({ends[2 * k], ends[2 * k + 1], jets[2 * k], jets[2 * k + 1]});
        found.push_back(s.query);
      } else if (s.reach < limit) {
        still.push_back({s.query, std::min(2 * s.reach, limit)});
      }
    }
    open = std::move(still);
  }

  std::vector<Vec3d> exact(crossed.size());
  EdgeRootCounts counts;
  find_roots(*local, crossed, exact, counts);
  for (std::size_t k = 0; k < found.size(); ++k) roots[found[k]] = exact[k];
}

}  // namespace cs2mesh
