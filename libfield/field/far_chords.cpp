#include "libfield/field/far_chords.h"

namespace cs2mesh {

double chord_factor(double two_nu, int n) {
  double factor = 1.0;
  for (int m = 1; m <= 2 * n; ++m) factor *= (m + two_nu - 1) / m;
  for (int m = 1; m <= n; ++m) {
    const double ratio = static_cast<double>(m) / (n + m);  // (n!)^2 / (2n)!, squared
    factor *= ratio * ratio;
  }
  // (n + 1)!^2 / ((n + 1) (2n + 1)^2) is (n + 1) / (2n + 1)^2 times n!^2.
  return factor * (n + 1) / ((2.0 * n + 1) * (2.0 * n + 1)) * (1 + 1e-12);
}

SegmentSource chord_source(const FarElement& triangle, const Chord& chord) {
  const Vec3d to_base = 0.5 * (triangle.a + triangle.b) - triangle.apex;
  return {triangle.apex + chord.at * to_base, (0.5 * chord.at) * (triangle.b - triangle.a),
          chord.part * triangle.weight * triangle.area, triangle.tau};
}

void ChordSources::set(std::span<const FarChord> chords, std::span<const FarElement> elements) {
  sources_.resize(chords.size());
  for (std::size_t i = 0; i < chords.size(); ++i) {
    const FarChord& chord = chords[i];
    sources_[i] = chord_source(elements[chord.element], chord_rule(chord.rule)[chord.number]);
  }
  while (places_.size() < sources_.size()) {
    places_.push_back(static_cast<std::uint32_t>(places_.size()));
  }
}

}  // namespace cs2mesh
