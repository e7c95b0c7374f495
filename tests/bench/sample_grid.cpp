#include "tests/bench/sample_grid.h"

#include <tbb/parallel_for.h>

#include <cmath>

namespace cs2mesh::bench {
namespace {

/// A cube of blocks, 2^level along each axis.
struct Cube {
  std::array<int, 3> first{};  ///< block
  int level = 0;
};

class Sampler {
 public:
  Sampler(const ImplicitSurface& surface, SampleGrid& grid, bool keep_empty)
      : surface_(surface), grid_(grid), keep_empty_(keep_empty) {}

  void run(int level) {
    std::vector<Cube> cubes{{{0, 0, 0}, level}};
    for (; level >= 0; --level) cubes = survivors(cubes);
    tbb::parallel_for(std::size_t{0}, open_.size(), [&](std::size_t i) { evaluate(open_[i]); });
  }

 private:
  bool beyond(const std::array<int, 3>& block) const {
    return block[0] >= grid_.blocks[0] || block[1] >= grid_.blocks[1] ||
           block[2] >= grid_.blocks[2];
  }

  /// The box of the nodes and of the cells between them and the next ones.
  Aabb box_of(const Cube& cube) const {
    std::array<int, 3> low{}, high{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = kBlock * cube.first[axis] - 1;
      high[axis] = kBlock * (cube.first[axis] + (1 << cube.level));
    }
    return {grid_.node(low), grid_.node(high)};
  }

  /// The parts of the cubes that may hold surface; on level 0 they go to open_.
  std::vector<Cube> survivors(const std::vector<Cube>& cubes) {
    std::vector<Interval> ranges(cubes.size());
    tbb::parallel_for(std::size_t{0}, cubes.size(), [&](std::size_t i) {
      const Aabb box = box_of(cubes[i]);
      surface_.enclose_each({&box, 1}, {&ranges[i], 1});
    });
    std::vector<Cube> parts;
    for (std::size_t i = 0; i < cubes.size(); ++i) {
      const Cube& cube = cubes[i];
      if (ranges[i].lo > 0 || ranges[i].hi < 0) {
        if (keep_empty_) add_empty(cube, ranges[i].lo > 0);
      } else if (cube.level == 0) {
        open_.push_back(grid_.all.size());
        add(cube.first).empty = false;
      } else {
        for (int corner = 0; corner < 8; ++corner) {
          Cube part{cube.first, cube.level - 1};
          for (int axis = 0; axis < 3; ++axis) {
            part.first[static_cast<std::size_t>(axis)] += (corner >> axis & 1) << part.level;
          }
          if (!beyond(part.first)) parts.push_back(part);
        }
      }
    }
    return parts;
  }

  SampleBlock& add(const std::array<int, 3>& block) {
    SampleBlock& added = grid_.all.emplace_back();
    for (std::size_t axis = 0; axis < 3; ++axis) added.first[axis] = kBlock * block[axis];
    return added;
  }

  void add_empty(const Cube& cube, bool inside) {
    const int width = 1 << cube.level;
    for (int i = 0; i < width * width * width; ++i) {
      const std::array<int, 3> block{cube.first[0] + i / (width * width),
                                     cube.first[1] + i / width % width, cube.first[2] + i % width};
      if (!beyond(block)) add(block).inside = inside;
    }
  }

  void evaluate(std::size_t number) {
    SampleBlock& block = grid_.all[number];
    std::vector<Vec3d> points;
    Aabb box;
    for (int i = 0; i < kBlockNodes; ++i) {
      points.push_back(
          grid_.node({block.first[0] + i / (kBlock * kBlock), block.first[1] + i / kBlock % kBlock,
                      block.first[2] + i % kBlock}));
      box.include(points.back());
    }
    std::vector<double> values(points.size());
    surface_.restrict_to(box)->values(points, values);
    block.values.assign(values.begin(), values.end());
  }

  const ImplicitSurface& surface_;
  SampleGrid& grid_;
  bool keep_empty_;
  std::vector<std::size_t> open_;
};

}  // namespace

SampleGrid sample_grid(const ImplicitSurface& surface, double cell, bool keep_empty) {
  constexpr double kAir = 2.0;
  SampleGrid grid;
  grid.cell = cell;
  const Aabb box = surface.bounds().grown(kAir * cell);
  // Off the planes of symmetry of a shape, where a node would be on the surface.
  grid.origin = box.min - cell * Vec3d{0.137, 0.219, 0.171};
  int most = 1;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double nodes = box.extent()[axis] / cell + 2;
    grid.blocks[axis] = static_cast<int>(std::ceil(nodes / kBlock));
    most = std::max(most, grid.blocks[axis]);
  }
  Sampler(surface, grid, keep_empty).run(static_cast<int>(std::ceil(std::log2(most))));
  return grid;
}

}  // namespace cs2mesh::bench
