// The scene under construction: what the commands of the language act on.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "libfield/art/arguments.h"
#include "libfield/art/read_art.h"
#include "libfield/art/symbols.h"

namespace cs2mesh {

/// A file that a `read` asks for.
struct ReadRequest {
  std::string path;
  SourceLocation where;
};

class SceneBuilder {
 public:
  /// Most objects inside one another (thesis C.2, restrictions).
  static constexpr int kMaxObjectDepth = 16;

  explicit SceneBuilder(const ReadArtOptions& options) : options_(options) {}

  Scene& scene() { return scene_; }
  Symbols& symbols() { return symbols_; }
  DiagnosticLog& log() { return log_; }
  const ReadArtOptions& options() const { return options_; }

  // What a command asks the reader of files to do.
  std::vector<ReadRequest> reads;
  bool leave_file = false;  ///< `return`
  bool leave_all = false;   ///< `quit`, or a limit was reached

  /// The material that a primitive begins with: the chain's, or that of the name that is read.
  int read_material(Arguments& args);
  /// A surface by its name or by a material variable; fails where there is none.
  int material_named(Arguments& args);
  /// Adds a primitive to the innermost open object and returns it. Null, and without effect, if
  /// `args` has failed.
  Element* add(Arguments& args, ElementKind kind, const Primitive& skeleton, int material,
               std::optional<double> own_radius = std::nullopt, Spelling spelling = Spelling::plain,
               std::optional<SegmentWeight> taper = std::nullopt);

  /// As add(), for the shapes that the scene keeps in lists of their own.
  void add_polygon(Arguments& args, Polygon polygon, int material);
  void add_quadric(Arguments& args, const Quadric& quadric, int material);

  /// Opens an object; a chain if it has a material.
  void open_object(Arguments& args, std::string_view name, int chain_material = -1);
  /// Closes the innermost; false if none is open.
  bool close_object();
  bool in_object() const { return !open_.empty(); }
  bool in_chain() const { return !open_.empty() && open_.back().chain_material >= 0; }
  /// The innermost open object, nullptr outside of all.
  Object* innermost();
  /// Index of an object by name; fails at the next word where there is none.
  int object_named(Arguments& args);

  /// Makes `map` the last step of the transform of the named object, or without a name of the last
  /// object closed or primitive made.
  void apply(Arguments& args, const Affine& map);
  /// Copies an object with all below it into the innermost open object, under a new name.
  void clone(Arguments& args, int original, const std::string& name);
  /// Takes an object with all below it out of the scene.
  void remove(Arguments& args, int object);
  /// Forgets all primitives and objects; none is open.
  void clear_model();
  /// Whether one more surface, texture or variable fits; fails with Failure::limit if not.
  bool has_room_for_name(Arguments& args, std::size_t used);
  /// Gives a variable its value, unless it was given one that wins over the scene's.
  void set_variable(std::string_view name, Value value);
  /// From now on the variables that there are keep their values.
  void lock_variables() { locked_ = symbols_.variables; }
  /// Forgets the variables that are not locked.
  void clear_variables() { symbols_.variables = locked_; }

  /// The scene, once everything is read; reports objects that are still open.
  Scene finish();

 private:
  /// An object's elements and the objects below it are neighbours in the scene's lists.
  struct Extent {
    std::size_t first_element = 0, end_element = 0;
    std::size_t end_object = 0;
    bool open = true;
    bool removed = false;
  };
  struct OpenObject {
    int index;
    int chain_material;  // -1: no chain
  };
  enum class Target { nothing, element, object };

  bool has_room(Arguments& args, std::size_t elements, std::size_t objects);
  int height_of(int object) const;
  bool is_open(Arguments& args, int object);
  void drop_removed();

  ReadArtOptions options_;
  DiagnosticLog log_;
  Symbols symbols_;
  NameMap<Value> locked_;
  Scene scene_;
  NameMap<int> object_names_;
  std::vector<Extent> extents_;  // of scene_.objects
  std::vector<OpenObject> open_;
  Target last_ = Target::nothing;
  std::size_t last_index_ = 0;
  bool any_removed_ = false;
};

}  // namespace cs2mesh
