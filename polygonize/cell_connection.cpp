#include "polygonize/cell_connection.h"

#include <algorithm>
#include <bit>

#include "polygonize/cell_table.h"
#include "polygonize/lattice.h"

namespace cs2mesh {
namespace {

/// The grid has so many steps along each side, and so many places.
constexpr int kSteps = 4, kSide = kSteps + 1;
constexpr std::size_t kPlaces = std::size_t{kSide} * kSide * kSide;

std::size_t number(const Int3& at) {
  return static_cast<std::size_t>((at.z * kSide + at.y) * kSide + at.x);
}
Int3 place(std::size_t number) {
  const int n = static_cast<int>(number);
  return {n % kSide, n / kSide % kSide, n / kSide / kSide};
}
Int3 corner_place(int corner) {
  return kSteps * corner_step(corner);
}

/// A square of the grid has its lowest corner there, and its sides along the other two axes.
std::size_t square(std::size_t lowest, std::size_t axis) {
  return axis * kPlaces + lowest;
}
Int3 along(std::size_t axis) {
  return corner_step(1 << axis);
}

class CellGrid {
 public:
  CellGrid(const ImplicitSurface& surface, const std::array<Vec3d, 8>& corners, unsigned inside) {
    for (std::size_t i = 0; i < kPlaces; ++i) points_[i] = between(corners, place(i));
    std::array<double, kPlaces> values;
    surface.values(points_, values);
    for (std::size_t i = 0; i < kPlaces; ++i) inside_[i] = values[i] >= 0;
    for (int c = 0; c < 8; ++c) inside_[number(corner_place(c))] = ((inside >> c) & 1U) != 0;
    look_into_squares(surface);
  }

  const Vec3d& point(std::size_t i) const { return points_[i]; }
  std::size_t values() const { return values_; }

  using Places = std::array<bool, kPlaces>;
  /// What is joined with a corner, on its side, within low <= place <= high.
  Places joined_with(int corner, const Int3& low, const Int3& high) const {
    Places joined{};
    std::vector<std::size_t> open;
    const auto reach = [&](const Int3& at) {
      const std::size_t i = number(at);
      if (joined[i]) return;
      joined[i] = true;
      open.push_back(i);
    };
    reach(corner_place(corner));
    while (!open.empty()) {
      const std::size_t from = open.back();
      open.pop_back();
      const Int3 at = place(from);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        for (const int sign : {1, -1}) {
          const Int3 next = at + sign * along(axis);
          if (is_within(next, low, high) && inside_[number(next)] == inside_[from]) reach(next);
        }
        const Int3 u = along((axis + 1) % 3), v = along((axis + 2) % 3);
        for (int way = 0; way < 4; ++way) {
          const Int3 du = ((way & 1) != 0 ? 1 : -1) * u, dv = ((way & 2) != 0 ? 1 : -1) * v;
          const Int3 next = at + du + dv;
          if (!is_within(next, low, high)) continue;
          const std::size_t lowest = number(lower(lower(at, next), lower(at + du, at + dv)));
          if (joins_diagonally(square(lowest, axis), from, number(next))) reach(next);
        }
      }
    }
    return joined;
  }

 private:
  static Int3 lower(const Int3& a, const Int3& b) {
    return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)};
  }
  static bool is_within(const Int3& at, const Int3& low, const Int3& high) {
    return low.x <= at.x && low.y <= at.y && low.z <= at.z && at.x <= high.x && at.y <= high.y &&
           at.z <= high.z;
  }
  bool joins_diagonally(std::size_t square, std::size_t a, std::size_t b) const {
    return alternating_[square] && inside_[a] == inside_[b] && middle_inside_[square] == inside_[a];
  }

  /// Samples the middles of squares around which signs alternate.
  void look_into_squares(const ImplicitSurface& surface) {
    std::vector<std::size_t> squares;
    std::vector<Vec3d> middles;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const Int3 u = along((axis + 1) % 3), v = along((axis + 2) % 3);
      for (std::size_t i = 0; i < kPlaces; ++i) {
        const Int3 at = place(i), opposite = at + u + v;
        if (std::max({opposite.x, opposite.y, opposite.z}) > kSteps) continue;
        const std::array<std::size_t, 4> around{i, number(at + u), number(at + v),
                                                number(opposite)};
        if (inside_[around[0]] != inside_[around[3]] || inside_[around[1]] != inside_[around[2]] ||
            inside_[around[0]] == inside_[around[1]]) {
          continue;
        }
        Vec3d middle{};
        for (const std::size_t j : around) middle += 0.25 * points_[j];
        squares.push_back(square(i, axis));
        middles.push_back(middle);
      }
    }
    std::vector<double> values(middles.size());
    if (!middles.empty()) surface.values(middles, values);
    for (std::size_t k = 0; k < squares.size(); ++k) {
      alternating_[squares[k]] = true;
      middle_inside_[squares[k]] = values[k] >= 0;
    }
    values_ += values.size();
  }

  /// On a face to the bit the same for both cells at it: what the other corners add is 0.
  static Vec3d between(const std::array<Vec3d, 8>& corners, const Int3& at) {
    const std::array<double, 3> t{double(at.x) / kSteps, double(at.y) / kSteps,
                                  double(at.z) / kSteps};
    Vec3d sum{};
    for (unsigned c = 0; c < 8; ++c) {
      double weight = 1.0;
      for (unsigned axis = 0; axis < 3; ++axis) {
        weight *= ((c >> axis) & 1U) != 0 ? t[axis] : 1.0 - t[axis];
      }
      sum += weight * corners[c];
    }
    return sum;
  }

  std::array<Vec3d, kPlaces> points_;
  std::array<bool, kPlaces> inside_{};
  std::array<bool, 3 * kPlaces> alternating_{}, middle_inside_{};  ///< by square
  std::size_t values_ = kPlaces;
};

/// Whether the inside corners of an ambiguous face are joined on it.
bool joined_on(const CellGrid& grid, const std::vector<int>& face, unsigned inside) {
  Int3 low{kSteps, kSteps, kSteps}, high{};
  for (const int c : face) {
    const Int3 at = corner_place(c);
    low = {std::min(low.x, at.x), std::min(low.y, at.y), std::min(low.z, at.z)};
    high = {std::max(high.x, at.x), std::max(high.y, at.y), std::max(high.z, at.z)};
  }
  const std::size_t first = ((inside >> face[0]) & 1U) != 0 ? 0 : 1;
  return grid.joined_with(face[first], low, high)[number(corner_place(face[first + 2]))];
}

/// What is joined with the corners of a side in the cell, if they all are.
std::optional<CellGrid::Places> all_joined(const CellGrid& grid, unsigned side) {
  const auto joined = grid.joined_with(std::countr_zero(side), {}, Int3{kSteps, kSteps, kSteps});
  for (int c = 0; c < 8; ++c) {
    if (((side >> c) & 1U) != 0 && !joined[number(corner_place(c))]) return std::nullopt;
  }
  return joined;
}

/// How far a place is from the middle, squared; negative where it is on a face.
int from_middle(const Int3& at) {
  const auto on_face = [](int t) { return t == 0 || t == kSteps; };
  if (on_face(at.x) || on_face(at.y) || on_face(at.z)) return -1;
  const Int3 way = 2 * at + Int3{-kSteps, -kSteps, -kSteps};
  return way.x * way.x + way.y * way.y + way.z * way.z;
}

}  // namespace

CellConnection connect_cell(const ImplicitSurface& surface, const std::array<Vec3d, 8>& corners,
                            unsigned inside) {
  const CellGrid grid(surface, corners, inside);
  CellConnection found;
  found.values = grid.values();
  for (unsigned faces = ambiguous_faces(inside); faces != 0; faces &= faces - 1) {
    const auto face = static_cast<std::size_t>(std::countr_zero(faces));
    if (joined_on(grid, cube_shape().faces[face], inside)) {
      found.joined |= static_cast<std::uint8_t>(1U << face);
    }
  }
  const auto within = all_joined(grid, inside);
  const auto without = all_joined(grid, ~inside & 0xffU);
  if (within.has_value() == without.has_value()) return found;
  found.side = within.has_value();
  const CellGrid::Places& joined = within ? *within : *without;
  std::vector<std::size_t> inner;
  for (std::size_t i = 0; i < kPlaces; ++i) {
    if (joined[i] && from_middle(place(i)) >= 0) inner.push_back(i);
  }
  std::stable_sort(inner.begin(), inner.end(), [](std::size_t a, std::size_t b) {
    return from_middle(place(a)) < from_middle(place(b));
  });
  for (const std::size_t i : inner) found.places.push_back(grid.point(i));
  return found;
}

}  // namespace cs2mesh
