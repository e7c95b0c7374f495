#include "polygonize/lattice_nodes.h"

#include <tbb/parallel_for.h>

#include <array>
#include <atomic>
#include <cmath>
#include <limits>

#include "libfield/base/check.h"

namespace cs2mesh {
namespace {

bool is_inside(double f) {
  return f >= 0;
}

/// Bits of the nodes of one row that end a crossed edge.
unsigned edge_ends(const PaddedNodes& inside, const PaddedNodes& sampled, int x, int y) {
  const unsigned i = inside.row(x, y);
  const unsigned s = sampled.row(x, y);
  unsigned ends = ((i ^ (i << 1)) & s & (s << 1)) | ((i ^ (i >> 1)) & s & (s >> 1));
  constexpr std::array<std::array<int, 2>, 4> kSteps{{{-1, 0}, {1, 0}, {0, -1}, {0, 1}}};
  for (const auto& [dx, dy] : kSteps) {
    ends |= (i ^ inside.row(x + dx, y + dy)) & s & sampled.row(x + dx, y + dy);
  }
  return ends;
}

/// Bits of the faces with corners a, b, c, d (d opposite a) whose signs alternate.
unsigned alternating(unsigned a, unsigned b, unsigned c, unsigned d) {
  return (a ^ b) & (a ^ c) & ~(a ^ d);
}

/// Ambiguous cells with lowest node x, y, z in -1 .. 7, as rows of bits z + 1.
struct PaddedCells {
  unsigned rows[9][9] = {};
};

PaddedCells ambiguous_cells(const PaddedNodes& inside, const PaddedNodes& sampled) {
  constexpr unsigned kCells = 0x1ff;
  PaddedCells cells;
  for (int x = -1; x <= 8; ++x) {
    for (int y = -1; y <= 8; ++y) {
      const unsigned i = inside.row(x, y);
      const unsigned s = sampled.row(x, y) & (sampled.row(x, y) >> 1U);
      const auto add = [&](int cell_x, int cell_y, unsigned bits) {
        if (cell_x >= -1 && cell_x <= 7 && cell_y >= -1 && cell_y <= 7) {
          cells.rows[cell_x + 1][cell_y + 1] |= bits & kCells;
        }
      };
      // Faces across x, between rows y and y + 1, bound the cells on both of their sides.
      if (y <= 7) {
        const unsigned j = inside.row(x, y + 1);
        const unsigned both = s & sampled.row(x, y + 1) & (sampled.row(x, y + 1) >> 1U);
        const unsigned faces = alternating(i, j, i >> 1, j >> 1) & both;
        add(x - 1, y, faces);
        add(x, y, faces);
      }
      // Faces across y, between rows x and x + 1.
      if (x <= 7) {
        const unsigned j = inside.row(x + 1, y);
        const unsigned both = s & sampled.row(x + 1, y) & (sampled.row(x + 1, y) >> 1U);
        const unsigned faces = alternating(i, j, i >> 1, j >> 1) & both;
        add(x, y - 1, faces);
        add(x, y, faces);
      }
      // Faces across z.
      if (x <= 7 && y <= 7) {
        const unsigned all = sampled.row(x, y) & sampled.row(x + 1, y) & sampled.row(x, y + 1) &
                             sampled.row(x + 1, y + 1);
        const unsigned faces =
            alternating(i, inside.row(x + 1, y), inside.row(x, y + 1), inside.row(x + 1, y + 1)) &
            all;
        add(x, y, faces | (faces >> 1));
      }
    }
  }
  return cells;
}

bool any_sign_differs(const PaddedNodes& inside, const PaddedNodes& sampled) {
  bool in = false;
  bool out = false;
  for (int x = -1; x <= 8; ++x) {
    for (int y = -1; y <= 8; ++y) {
      in = in || (inside.row(x, y) & sampled.row(x, y)) != 0;
      out = out || (~inside.row(x, y) & sampled.row(x, y)) != 0;
    }
  }
  return in && out;
}

}  // namespace

double clearance(const Jet& jet) {
  const double slope = norm(jet.gradient);
  if (!std::isfinite(jet.value) || !std::isfinite(slope)) return 0;
  if (slope == 0) return jet.value == 0 ? 0 : std::numeric_limits<double>::infinity();
  return std::abs(jet.value) / slope;
}

Vec3d NodeMover::first_place(const Vec3d& p, const Jet& jet, double cell) {
  const double slope = norm(jet.gradient);
  if (!(slope > 0 && std::isfinite(slope))) return p;
  const double away = is_inside(jet.value) ? 1 : -1;
  return p + (away * (kClear * cell - clearance(jet)) / slope) * jet.gradient;
}

Vec3d NodeMover::other_place(const Vec3d& p, const Jet& jet, double cell, int i) {
  const double slope = norm(jet.gradient);
  const bool has_normal = slope > 0 && std::isfinite(slope);
  if (i < 2 && has_normal) {
    const double away = (is_inside(jet.value) ? 1 : -1) * (i == 0 ? 1 : -1);
    return p + (away * kFarthest * cell / slope) * jet.gradient;
  }
  if (i < 8) {
    Vec3d step;
    step[static_cast<std::size_t>(i % 3)] = (i < 5 ? 1 : -1) * kFarthest * cell;
    return p + step;
  }
  const double side = kFarthest * cell / std::sqrt(3.0);
  return p + Vec3d{i & 1 ? side : -side, i & 2 ? side : -side, i & 4 ? side : -side};
}

/// The nodes that become known in one round of one block.
struct LatticeNodes::Fresh {
  std::vector<std::uint16_t> offsets;
  std::vector<Vec3d> positions;
  std::vector<Jet> jets;
  std::vector<bool> moved;
};

LatticeNodes::LatticeNodes(const NarrowBand& band) : band_(band), blocks_(band.block_count()) {
  tbb::parallel_for(std::size_t{0}, blocks_.size(), [this](std::size_t i) {
    Block& block = blocks_[i];
    block.sampled = band_.sampled(i);
    const auto values = band_.values(i);
    block.sampled.for_each([&](int offset) {
      if (is_inside(values[static_cast<std::size_t>(offset)])) block.inside.insert(offset);
    });
  });
}

bool LatticeNodes::settle(Progress* progress) {
  // A sign that changes may cross edges whose other ends nobody has looked at: look again. Few
  // nodes are moved, fewer change sign; what is left after the rounds is merely known, not moved.
  constexpr int kMostRounds = 4;
  for (int round = 0; round < kMostRounds; ++round) {
    std::atomic<bool> any{false};
    std::atomic<bool> stopped{false};
    const auto each_block = [&](auto&& f) {
      tbb::parallel_for(std::size_t{0}, blocks_.size(), [&](std::size_t i) {
        if (cancelled(progress)) stopped = true;
        if (!stopped) f(i);
      });
    };
    // Signs are only read here ...
    each_block([&](std::size_t i) {
      bool affected = false;
      for (int slot = 0; slot < 27 && !affected; ++slot) {
        const std::uint32_t n = band_.neighbour(i, {slot / 9 - 1, slot / 3 % 3 - 1, slot % 3 - 1});
        affected = n != NarrowBand::kNone && blocks_[n].changed;
      }
      blocks_[i].wanted = affected ? find_wanted(i) : NodeSet{};
      if (blocks_[i].wanted.count() > 0) any = true;
    });
    // ... and only written here, each by its own block.
    const bool last = round + 1 == kMostRounds;
    each_block([&](std::size_t i) {
      blocks_[i].changed = false;
      if (blocks_[i].wanted.count() > 0) make_known(i, !last);
    });
    if (stopped) return false;
    if (!any) break;
  }
  for (const Block& block : blocks_) {
    counts_.jets += block.counts.jets;
    counts_.moved += block.counts.moved;
    counts_.flipped += block.counts.flipped;
    counts_.stuck += block.counts.stuck;
  }
  return true;
}

PaddedNodes LatticeNodes::padded(std::size_t block, NodeSet Block::*set) const {
  std::array<const NodeSet*, 27> around{};
  for (int slot = 0; slot < 27; ++slot) {
    const std::uint32_t n = band_.neighbour(block, {slot / 9 - 1, slot / 3 % 3 - 1, slot % 3 - 1});
    around[static_cast<std::size_t>(slot)] = n == NarrowBand::kNone ? nullptr : &(blocks_[n].*set);
  }
  PaddedNodes result;
  for (int x = -1; x <= 8; ++x) {
    for (int y = -1; y <= 8; ++y) {
      const std::size_t slot = static_cast<std::size_t>(9 * ((x + 8) / 8) + 3 * ((y + 8) / 8));
      const auto byte = [&](const NodeSet* nodes) -> unsigned {
        return nodes == nullptr ? 0 : (nodes->word[x & 7] >> (8 * (y & 7))) & 0xff;
      };
      const unsigned row = (byte(around[slot]) >> 7) | (byte(around[slot + 1]) << 1) |
                           ((byte(around[slot + 2]) & 1) << 9);
      result.rows[x + 1][y + 1] = static_cast<std::uint16_t>(row);
    }
  }
  return result;
}

PaddedNodes LatticeNodes::padded_inside(std::size_t block) const {
  return padded(block, &Block::inside);
}

NodeSet LatticeNodes::find_wanted(std::size_t block) const {
  const PaddedNodes inside = padded(block, &Block::inside);
  const PaddedNodes sampled = padded(block, &Block::sampled);
  NodeSet wanted;
  if (!any_sign_differs(inside, sampled)) return wanted;
  const PaddedCells cells = ambiguous_cells(inside, sampled);
  for (int x = 0; x < 8; ++x) {
    for (int y = 0; y < 8; ++y) {
      const unsigned around =
          cells.rows[x][y] | cells.rows[x + 1][y] | cells.rows[x][y + 1] | cells.rows[x + 1][y + 1];
      const unsigned bits = edge_ends(inside, sampled, x, y) | around | (around << 1);
      wanted.word[x] |= std::uint64_t{(bits >> 1) & 0xff} << (8 * y);
    }
  }
  const Block& own = blocks_[block];
  for (int x = 0; x < 8; ++x) wanted.word[x] &= own.sampled.word[x] & ~own.known.word[x];
  return wanted;
}

void LatticeNodes::make_known(std::size_t index, bool may_move) {
  Block& block = blocks_[index];
  Fresh fresh;
  block.wanted.for_each([&](int offset) {
    fresh.offsets.push_back(static_cast<std::uint16_t>(offset));
    fresh.positions.push_back(band_.node_position(index, offset));
  });
  fresh.jets.resize(fresh.offsets.size());
  fresh.moved.assign(fresh.offsets.size(), false);
  band_.jets(index, fresh.offsets, fresh.positions, fresh.jets);
  block.counts.jets += fresh.offsets.size();
  if (may_move) move_near(index, fresh);

  for (std::size_t i = 0; i < fresh.offsets.size(); ++i) {
    const int offset = fresh.offsets[i];
    double& f = fresh.jets[i].value;
    if (fresh.moved[i] && is_inside(f) != block.inside.contains(offset)) {
      block.inside.assign(offset, is_inside(f));
      block.changed = true;
      ++block.counts.flipped;
    }
    // values() and jets() may disagree in the last bits; the sign is what values() said.
    if (block.inside.contains(offset) != is_inside(f)) {
      f = is_inside(f) ? -std::numeric_limits<double>::denorm_min() : 0.0;
    }
  }
  merge(block, fresh);
}

/// Moves the fresh nodes that are near the surface, where there is a clearer place.
void LatticeNodes::move_near(std::size_t index, Fresh& fresh) {
  Block& block = blocks_[index];
  const double cell = band_.lattice().cell;
  const auto allowed = [&](std::size_t i, const Jet& jet) {
    return is_inside(jet.value) == block.inside.contains(fresh.offsets[i]) ||
           band_.surrounded(index, fresh.offsets[i]);
  };
  std::vector<std::size_t> near;
  for (std::size_t i = 0; i < fresh.jets.size(); ++i) {
    if (NodeMover::near(fresh.jets[i], cell)) near.push_back(i);
  }

  // First along the gradient, which is enough for all but the wildest of functions ...
  std::vector<std::uint16_t> offsets;
  std::vector<Vec3d> places;
  for (const std::size_t i : near) {
    offsets.push_back(fresh.offsets[i]);
    places.push_back(NodeMover::first_place(fresh.positions[i], fresh.jets[i], cell));
  }
  std::vector<Jet> jets(places.size());
  band_.jets(index, offsets, places, jets);
  block.counts.jets += places.size();
  std::vector<std::size_t> stuck;
  for (std::size_t n = 0; n < near.size(); ++n) {
    const std::size_t i = near[n];
    if (NodeMover::near(jets[n], cell) || !allowed(i, jets[n])) {
      stuck.push_back(i);
      continue;
    }
    fresh.positions[i] = places[n];
    fresh.jets[i] = jets[n];
    fresh.moved[i] = true;
    ++block.counts.moved;
  }

  // ... then all around, keeping the clearest place.
  for (const std::size_t i : stuck) {
    offsets.assign(NodeMover::kTrials, fresh.offsets[i]);
    places.clear();
    for (int k = 0; k < NodeMover::kTrials; ++k) {
      places.push_back(NodeMover::other_place(fresh.positions[i], fresh.jets[i], cell, k));
    }
    jets.resize(places.size());
    band_.jets(index, offsets, places, jets);
    block.counts.jets += places.size();
    double best = clearance(fresh.jets[i]);
    std::size_t choice = places.size();
    for (std::size_t k = 0; k < places.size(); ++k) {
      if (!allowed(i, jets[k]) || !(clearance(jets[k]) > best)) continue;
      best = clearance(jets[k]);
      choice = k;
    }
    if (choice < places.size()) {
      fresh.positions[i] = places[choice];
      fresh.jets[i] = jets[choice];
      fresh.moved[i] = true;
      ++block.counts.moved;
    }
    if (!(best >= NodeMover::kNear * cell)) ++block.counts.stuck;
  }
}

/// Adds the fresh nodes, keeping jets and positions in the order of their ranks.
void LatticeNodes::merge(Block& block, const Fresh& fresh) {
  const NodeSet known = block.known;
  const NodeSet moved = block.moved;
  for (std::size_t i = 0; i < fresh.offsets.size(); ++i) {
    block.known.insert(fresh.offsets[i]);
    if (fresh.moved[i]) block.moved.insert(fresh.offsets[i]);
  }
  std::vector<Jet> jets;
  jets.reserve(static_cast<std::size_t>(block.known.count()));
  std::vector<Vec3d> positions;
  std::size_t next = 0;
  block.known.for_each([&](int offset) {
    const bool old = known.contains(offset);
    if (old) {
      jets.push_back(block.jets[static_cast<std::size_t>(known.rank(offset))]);
      if (moved.contains(offset)) {
        positions.push_back(block.positions[static_cast<std::size_t>(moved.rank(offset))]);
      }
      return;
    }
    jets.push_back(fresh.jets[next]);
    if (fresh.moved[next]) positions.push_back(fresh.positions[next]);
    ++next;
  });
  block.jets = std::move(jets);
  block.positions = std::move(positions);
}

Vec3d LatticeNodes::position(std::size_t block, int offset) const {
  const Block& b = blocks_[block];
  if (b.moved.contains(offset)) {
    return b.positions[static_cast<std::size_t>(b.moved.rank(offset))];
  }
  return band_.node_position(block, offset);
}

const Jet& LatticeNodes::jet(std::size_t block, int offset) const {
  const Block& b = blocks_[block];
  require(b.known.contains(offset), "LatticeNodes: the node is not known");
  return b.jets[static_cast<std::size_t>(b.known.rank(offset))];
}

}  // namespace cs2mesh
