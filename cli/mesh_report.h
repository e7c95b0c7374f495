// What a check found, for programs and for people.
#pragma once

#include <string>
#include <vector>

#include "cli/json_report.h"
#include "polygonize/check.h"

namespace cs2mesh {

Json to_json(const Vec3d& v);

/// Adds vertices, triangles, components, genus, closed, manifold, ... of all parts together, and
/// `listed`: the defects with position and reason. self_intersections is null where unchecked.
void add_check(Json& report, const std::vector<PartReport>& parts);

/// The same of one part, without its defects.
Json to_json(const PartReport& part);

/// "12 vertices, 20 triangles, closed, manifold, ..." of all parts together.
std::string summary(const std::vector<PartReport>& parts);

/// An error a kind of defect and part, with the place of the first; empty if there are none.
std::vector<Diagnostic> defect_messages(const std::vector<PartReport>& parts,
                                        const std::string& file);

/// A warning where self-intersections could not be looked for, as in a build without CGAL.
void warn_if_unchecked(const std::vector<PartReport>& parts, const std::string& file,
                       Console& console);

}  // namespace cs2mesh
