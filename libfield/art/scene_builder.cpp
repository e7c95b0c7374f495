#include "libfield/art/scene_builder.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace cs2mesh {
namespace {

std::size_t at(int index) {
  return static_cast<std::size_t>(index);
}

/// Whether the map and its inverse are finite in double precision.
bool is_usable(const Affine& map) {
  const double volume = determinant(map.linear);
  if (!std::isfinite(volume) || volume == 0.0) return false;
  const Affine back = inverse(map);
  for (const Affine& m : {map, back}) {
    if (!is_finite(m.translation)) return false;
    for (const Vec3d& row : m.linear.row) {
      if (!is_finite(row)) return false;
    }
  }
  return true;
}

std::string taken(std::string_view name) {
  return "there is an object " + in_quotes(name) + " already, expected a new name";
}

}  // namespace

int SceneBuilder::material_named(Arguments& args) {
  const std::string_view name = args.peek();
  if (const MaterialIndex* index = find(symbols_.surfaces, name)) {
    args.skip();
    return index->value;
  }
  if (const Value* value = find(symbols_.variables, name)) {
    if (const MaterialIndex* index = std::get_if<MaterialIndex>(value)) {
      args.skip();
      return index->value;
    }
  }
  if (args.more()) {
    args.fail(args.here(), "unknown surface " + in_quotes(name) +
                               ", expected the name of a surface" +
                               did_you_mean(name, names_of(symbols_.surfaces)));
  } else {
    args.word("the name of a surface");
  }
  return 0;
}

int SceneBuilder::read_material(Arguments& args) {
  return in_chain() ? open_.back().chain_material : material_named(args);
}

bool SceneBuilder::has_room(Arguments& args, std::size_t elements, std::size_t objects) {
  const std::size_t most = options_.max_elements;
  const auto fits = [most](std::size_t used, std::size_t more) {
    return more <= most && used <= most - more;
  };
  const bool few_elements = fits(scene_.elements.size(), elements);
  if (few_elements && fits(scene_.objects.size(), objects)) return true;
  args.fail(args.opcode_location(),
            std::string("too many ") + (few_elements ? "objects" : "primitives") +
                ", expected at most " + std::to_string(most),
            Failure::limit);
  leave_all = true;
  return false;
}

Element* SceneBuilder::add(Arguments& args, ElementKind kind, const Primitive& skeleton,
                           int material, std::optional<double> own_radius, Spelling spelling,
                           std::optional<SegmentWeight> taper) {
  if (!args.finish() || !has_room(args, 1, 0)) return nullptr;
  Element element;
  element.kind = kind;
  element.spelling = spelling;
  element.skeleton = skeleton;
  element.own_radius = own_radius;
  element.taper = taper;
  element.material = material;
  element.object = open_.empty() ? -1 : open_.back().index;
  element.where = args.opcode_location();
  last_ = Target::element;
  last_index_ = scene_.elements.size();
  scene_.elements.push_back(std::move(element));
  return &scene_.elements.back();
}

void SceneBuilder::add_polygon(Arguments& args, Polygon polygon, int material) {
  const Triangle corner{{polygon.vertex[0], polygon.vertex[1], polygon.vertex.back()}};
  Element* element = add(args, ElementKind::polygon, corner, material);
  if (element == nullptr) return;
  element->shape = static_cast<int>(scene_.polygons.size());
  scene_.polygons.push_back(std::move(polygon));
}

void SceneBuilder::add_quadric(Arguments& args, const Quadric& quadric, int material) {
  Element* element = add(args, ElementKind::quadric, Point{}, material);
  if (element == nullptr) return;
  element->shape = static_cast<int>(scene_.quadrics.size());
  scene_.quadrics.push_back(quadric);
}

void SceneBuilder::open_object(Arguments& args, std::string_view name, int chain_material) {
  const SourceLocation where = args.opcode_location();
  if (!has_room(args, 0, 1)) return;
  if (in_chain()) {
    args.fail(where, "an object inside a chain, expected 'close' before it");
  } else if (open_.size() >= kMaxObjectDepth) {
    args.fail(where, "objects are nested too deeply, expected at most " +
                         std::to_string(kMaxObjectDepth) + " inside one another");
  }
  const int index = static_cast<int>(scene_.objects.size());
  const bool is_new = object_names_.emplace(name, index).second;
  if (!is_new) args.fail(where, taken(name));
  Object object;
  object.name = name;
  object.parent = open_.empty() ? -1 : open_.back().index;
  object.where = where;
  scene_.objects.push_back(std::move(object));
  extents_.push_back({scene_.elements.size(), 0, 0, true, false});
  open_.push_back({index, chain_material});
}

bool SceneBuilder::close_object() {
  if (open_.empty()) return false;
  last_ = Target::object;
  last_index_ = at(open_.back().index);
  Extent& extent = extents_[last_index_];
  extent.open = false;
  extent.end_element = scene_.elements.size();
  extent.end_object = scene_.objects.size();
  open_.pop_back();
  return true;
}

Object* SceneBuilder::innermost() {
  return open_.empty() ? nullptr : &scene_.objects[at(open_.back().index)];
}

int SceneBuilder::object_named(Arguments& args) {
  const SourceLocation where = args.here();
  const std::string_view name = args.word("the name of an object");
  if (args.failed()) return -1;
  if (const int* index = find(object_names_, name)) return *index;
  args.fail(where, "unknown object " + in_quotes(name) + ", expected the name of an object" +
                       did_you_mean(name, names_of(object_names_)));
  return -1;
}

void SceneBuilder::apply(Arguments& args, const Affine& map) {
  Affine* transform = nullptr;
  if (args.more()) {
    const int object = object_named(args);
    if (!args.failed()) transform = &scene_.objects[at(object)].transform;
  } else if (last_ == Target::element) {
    transform = &scene_.elements[last_index_].transform;
  } else if (last_ == Target::object) {
    transform = &scene_.objects[last_index_].transform;
  } else {
    args.fail(args.opcode_location(),
              "there is nothing to transform yet, expected a primitive or an object before it");
  }
  if (!args.finish()) return;
  const Affine product = map * *transform;
  if (!is_usable(product)) {
    args.fail(args.opcode_location(),
              "the transform leaves the range of double precision, expected less extreme numbers");
    return;
  }
  *transform = product;
}

bool SceneBuilder::is_open(Arguments& args, int object) {
  if (args.failed() || !extents_[at(object)].open) return args.failed();
  args.fail(args.opcode_location(), "the object " + in_quotes(scene_.objects[at(object)].name) +
                                        " is still open, expected 'close' before it");
  return true;
}

/// Levels of the object and those below it, at least 1.
int SceneBuilder::height_of(int object) const {
  std::vector<int> level(extents_[at(object)].end_object - at(object), 1);
  int height = 1;
  for (std::size_t i = 1; i < level.size(); ++i) {
    level[i] = level[at(scene_.objects[at(object) + i].parent - object)] + 1;
    height = std::max(height, level[i]);
  }
  return height;
}

void SceneBuilder::clone(Arguments& args, int original, const std::string& name) {
  if (args.failed() || is_open(args, original)) return;
  const Extent extent = extents_[at(original)];
  const std::size_t objects = extent.end_object - at(original);
  if (!has_room(args, extent.end_element - extent.first_element, objects)) return;
  if (static_cast<int>(open_.size()) + height_of(original) > kMaxObjectDepth) {
    args.fail(args.opcode_location(), "objects are nested too deeply, expected at most " +
                                          std::to_string(kMaxObjectDepth) + " inside one another");
    return;
  }
  if (in_chain()) {
    args.fail(args.opcode_location(), "an object inside a chain, expected 'close' before it");
    return;
  }

  // Copy the objects; those below are renamed "name/inner", as all names are global.
  const int first = static_cast<int>(scene_.objects.size());
  const int object_shift = first - original;
  const std::string old_prefix = scene_.objects[at(original)].name + "/";
  for (std::size_t i = at(original); i < extent.end_object; ++i) {
    Object copy = scene_.objects[i];
    if (i == at(original)) {
      copy.name = name;
      copy.parent = open_.empty() ? -1 : open_.back().index;
    } else {
      copy.parent += object_shift;
      const bool prefixed = copy.name.starts_with(old_prefix);
      copy.name = name + "/" + (prefixed ? copy.name.substr(old_prefix.size()) : copy.name);
    }
    if (!object_names_.emplace(copy.name, static_cast<int>(scene_.objects.size())).second) {
      args.fail(args.opcode_location(), taken(copy.name));
    }
    Extent moved = extents_[i];
    moved.first_element += scene_.elements.size() - extent.first_element;
    moved.end_element += scene_.elements.size() - extent.first_element;
    moved.end_object += at(object_shift);
    scene_.objects.push_back(std::move(copy));
    extents_.push_back(moved);
  }

  // Copy the elements.
  for (std::size_t i = extent.first_element; i < extent.end_element; ++i) {
    Element copy = scene_.elements[i];
    copy.object += object_shift;
    scene_.elements.push_back(std::move(copy));
  }
  last_ = Target::object;
  last_index_ = at(first);
}

void SceneBuilder::remove(Arguments& args, int object) {
  if (args.failed() || is_open(args, object)) return;
  const Extent& extent = extents_[at(object)];
  for (std::size_t i = at(object); i < extent.end_object; ++i) {
    if (extents_[i].removed) continue;
    extents_[i].removed = true;
    object_names_.erase(scene_.objects[i].name);
  }
  any_removed_ = true;
  int owner = static_cast<int>(last_index_);
  if (last_ == Target::element) owner = scene_.elements[last_index_].object;
  if (last_ != Target::nothing && owner >= 0 && extents_[at(owner)].removed) {
    last_ = Target::nothing;
  }
}

void SceneBuilder::clear_model() {
  scene_.elements.clear();
  scene_.objects.clear();
  scene_.polygons.clear();
  scene_.quadrics.clear();
  extents_.clear();
  object_names_.clear();
  last_ = Target::nothing;
  any_removed_ = false;
}

bool SceneBuilder::has_room_for_name(Arguments& args, std::size_t used) {
  if (used < options_.max_elements) return true;
  args.fail(
      args.opcode_location(),
      "too many names, expected at most " + std::to_string(options_.max_elements) + " of a kind",
      Failure::limit);
  leave_all = true;
  return false;
}

void SceneBuilder::set_variable(std::string_view name, Value value) {
  if (find(locked_, name) == nullptr) {
    symbols_.variables.insert_or_assign(std::string(name), std::move(value));
  }
}

void SceneBuilder::drop_removed() {
  std::vector<int> kept(scene_.objects.size(), -1);
  int count = 0;
  for (std::size_t i = 0; i < kept.size(); ++i) {
    if (!extents_[i].removed) kept[i] = count++;
  }
  std::erase_if(scene_.elements,
                [&](const Element& e) { return e.object >= 0 && extents_[at(e.object)].removed; });
  for (Element& e : scene_.elements) {
    if (e.object >= 0) e.object = kept[at(e.object)];
  }
  std::vector<Object> objects;
  for (std::size_t i = 0; i < kept.size(); ++i) {
    if (kept[i] < 0) continue;
    Object& object = scene_.objects[i];
    if (object.parent >= 0) object.parent = kept[at(object.parent)];
    objects.push_back(std::move(object));
  }
  scene_.objects = std::move(objects);
}

Scene SceneBuilder::finish() {
  for (const OpenObject& open : open_) {
    const Object& object = scene_.objects[at(open.index)];
    log_.error(object.where,
               "the object " + in_quotes(object.name) + " is never closed, expected 'close'");
  }
  open_.clear();
  if (any_removed_) drop_removed();
  std::vector<Affine> world(scene_.objects.size());
  for (std::size_t i = 0; i < world.size(); ++i) {
    const Object& object = scene_.objects[i];
    world[i] = object.parent < 0 ? object.transform : world[at(object.parent)] * object.transform;
    if (!is_usable(world[i])) {
      log_.error(object.where, "the transforms of the object " + in_quotes(object.name) +
                                   " leave the range of double precision, expected less extreme"
                                   " numbers");
    }
  }
  return std::move(scene_);
}

}  // namespace cs2mesh
