#include "polygonize/offset_shell.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "polygonize/box_pairs.h"

namespace cs2mesh {
namespace {

bool share_a_corner(const TriangleMesh& mesh, std::size_t a, std::size_t b) {
  const auto& other = mesh.triangles[b];
  return std::any_of(mesh.triangles[a].begin(), mesh.triangles[a].end(), [&](auto v) {
    return std::find(other.begin(), other.end(), v) != other.end();
  });
}

}  // namespace

std::array<Vec3d, 6> prism_corners(const TriangleMesh& mesh, const OffsetShell& shell,
                                   std::size_t triangle) {
  std::array<Vec3d, 6> corners;
  for (std::size_t k = 0; k < 3; ++k) {
    corners[k] = shell.outer_place(mesh, mesh.triangles[triangle][k]);
    corners[k + 3] = shell.inner_place(mesh, mesh.triangles[triangle][k]);
  }
  return corners;
}

/// The normals of the layers from a triangle with the edges e1, e2 to one whose edges differ by d1,
/// d2 are a quadratic: these are Bernstein's coefficients of it.
std::array<Vec3d, 6> layer_normals(const TriangleMesh& mesh, const OffsetShell& shell,
                                   std::size_t triangle) {
  const auto& [a, b, c] = mesh.triangles[triangle];
  const Vec3d e1 = mesh.positions[b] - mesh.positions[a];
  const Vec3d e2 = mesh.positions[c] - mesh.positions[a];
  const Vec3d first = cross(e1, e2);
  std::array<Vec3d, 6> normals;
  std::size_t next = 0;
  const auto add = [&](const std::vector<double>& lengths, double sign) {
    const auto way = [&](TriangleMesh::Index v) { return sign * lengths[v] * shell.direction[v]; };
    const auto& t = mesh.triangles[triangle];
    const Vec3d d1 = way(t[1]) - way(t[0]), d2 = way(t[2]) - way(t[0]);
    normals[next++] = first;
    normals[next++] = first + 0.5 * (cross(e1, d2) + cross(d1, e2));
    normals[next++] = cross(e1 + d1, e2 + d2);
  };
  add(shell.outer, 1.0);
  add(shell.inner, -1.0);
  return normals;
}

std::array<bool, 3> leaves_directions_on_one_side(const TriangleMesh& mesh,
                                                  const OffsetShell& shell, std::size_t triangle) {
  std::array<bool, 3> straight{true, true, true};
  for (const Vec3d& normal : layer_normals(mesh, shell, triangle)) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d& direction = shell.direction[mesh.triangles[triangle][k]];
      straight[k] = straight[k] && dot(normal, direction) > 0;
    }
  }
  return straight;
}

bool are_apart(const std::array<Vec3d, 6>& a, const std::array<Vec3d, 6>& b) {
  const auto apart_along = [&](const Vec3d& axis) {
    double low[2], high[2];
    for (std::size_t s = 0; s < 2; ++s) {
      const auto& corners = s == 0 ? a : b;
      low[s] = high[s] = dot(corners[0], axis);
      for (const Vec3d& p : corners) {
        low[s] = std::min(low[s], dot(p, axis));
        high[s] = std::max(high[s], dot(p, axis));
      }
    }
    const double size = std::abs(low[0]) + std::abs(high[0]) + std::abs(low[1]) + std::abs(high[1]);
    return low[1] - high[0] > 1e-14 * size || low[0] - high[1] > 1e-14 * size;
  };
  const auto separated_by_faces_of = [&](const std::array<Vec3d, 6>& p) {
    for (const std::size_t k : {0U, 3U}) {
      if (apart_along(cross(p[k + 1] - p[k], p[k + 2] - p[k]))) return true;
    }
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t next = (k + 1) % 3;
      if (apart_along(cross(p[next] - p[k], p[k + 3] - p[k])) ||
          apart_along(cross(p[next + 3] - p[k + 3], p[next + 3] - p[next]))) {
        return true;
      }
    }
    return false;
  };
  if (separated_by_faces_of(a) || separated_by_faces_of(b)) return true;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      if (apart_along(cross(a[(i + 1) % 3] - a[i], b[(j + 1) % 3] - b[j]))) return true;
    }
  }
  return false;
}

std::vector<char> prisms_that_meet(const TriangleMesh& mesh, const OffsetShell& shell) {
  const std::size_t count = mesh.triangles.size();
  std::vector<std::array<Vec3d, 6>> prisms(count);
  std::vector<Aabb> boxes(count);
  for (std::size_t t = 0; t < count; ++t) {
    prisms[t] = prism_corners(mesh, shell, t);
    for (const Vec3d& p : prisms[t]) boxes[t].include(p);
  }
  const BoxPairs pairs(boxes);
  std::vector<std::vector<std::uint32_t>> found(pairs.group_count());
  tbb::parallel_for(std::size_t{0}, found.size(), [&](std::size_t group) {
    pairs.for_each_pair(group, [&](std::uint32_t a, std::uint32_t b) {
      if (share_a_corner(mesh, a, b) || are_apart(prisms[a], prisms[b])) return;
      found[group].insert(found[group].end(), {a, b});
    });
  });
  std::vector<char> meets(count, 0);
  for (const auto& triangles : found) {
    for (const std::uint32_t t : triangles) meets[t] = 1;
  }
  return meets;
}

}  // namespace cs2mesh
