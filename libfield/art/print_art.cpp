#include "libfield/art/print_art.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <set>

#include "libfield/art/decompose.h"

namespace cs2mesh {
namespace {

constexpr double kDegreesPerRadian = 180.0 / std::numbers::pi;

/// A name as one word of the language.
std::string as_word(const std::string& name) {
  std::string word = name;
  for (char& c : word) {
    if (static_cast<unsigned char>(c) <= ' ' || c == 0x7F ||
        std::string_view(",<>{}=#").find(c) != std::string_view::npos) {
      c = '_';
    }
  }
  return word.empty() ? "_" : word;
}

class Printer {
 public:
  explicit Printer(const Scene& scene) : scene_(scene) {}
  std::string print();

 private:
  Printer& operator<<(std::string_view text) {
    text_ += text;
    return *this;
  }
  Printer& operator<<(double x) {
    char digits[32];
    text_.append(digits, std::to_chars(digits, digits + sizeof digits, x).ptr);
    return *this;
  }
  Printer& operator<<(int x) { return *this << static_cast<double>(x); }
  Printer& operator<<(const Vec3d& v) { return *this << v.x << " " << v.y << " " << v.z; }
  Printer& operator<<(const Color& c) { return *this << c.r << " " << c.g << " " << c.b; }

  void name_materials();
  void print_options();
  void print_fragile();
  void print_profile(const StrengthProfile& profile, const std::string& name);
  void print_material(std::size_t index);
  void print_element(const Element& element);
  void print_curve(const Element& element);
  void print_taper(const SegmentWeight& weight);
  void print_quadric(const Quadric& quadric);
  void print_transform(const Affine& map, const std::string& indent);
  void print_level(int object);
  std::string indent() const { return std::string(2 * static_cast<std::size_t>(depth_), ' '); }

  const Scene& scene_;
  std::string text_;
  std::vector<std::string> material_names_;
  std::vector<std::vector<int>> children_;          // objects below object i - 1; 0: the scene
  std::vector<std::vector<std::size_t>> elements_;  // likewise
  std::vector<std::size_t> first_element_;          // the least index at or below object i
  int depth_ = 0;
};

void Printer::name_materials() {
  std::set<std::string> taken;
  for (const Material& material : scene_.materials) taken.insert(as_word(material.name));
  std::set<std::string> used;
  for (const Material& material : scene_.materials) {
    const std::string word = as_word(material.name);
    std::string name = word;
    for (int n = 2; used.contains(name) || (n > 2 && taken.contains(name)); ++n) {
      name = word + "_" + std::to_string(n);
    }
    used.insert(name);
    material_names_.push_back(name);
  }
}

void Printer::print_fragile() {
  const Fragile& f = scene_.fragile;
  const std::pair<bool, std::string_view> kinds[] = {
      {f.arc, "arc"},           {f.arch, "arch"}, {f.torus, "torus"},  {f.pipe, "pipe"},
      {f.cylinder, "cylinder"}, {f.cone, "cone"}, {f.sphere, "sphere"}};
  std::string words;
  for (const auto& [set, word] : kinds) {
    if (set) words += " " + std::string(word);
  }
  *this << "fragile" << (words.empty() ? " none" : words) << "\n";
}

void Printer::print_options() {
  const Camera& camera = scene_.camera;
  *this << "soft " << (scene_.soft ? "on" : "off") << "\n";
  print_fragile();
  if (camera.has_eye) *this << "eyep " << camera.eye << "\n";
  *this << "vrp " << camera.look_at << "\nvup " << camera.up << "\n";
  *this << "fov " << camera.fov_horizontal << " " << camera.fov_vertical << "\n";
  *this << "framesize " << camera.width << " " << camera.height << "\n";
  *this << "sample " << camera.samples << "\n";
  *this << "background " << scene_.background << "\n";
  for (const Light& light : scene_.lights) {
    *this << "light " << light.color << " point position " << light.position << " intensity "
          << light.intensity << (light.shadow ? "\n" : " noshadow\n");
  }
  if (scene_.mesh.tolerance) *this << "mesh tolerance " << *scene_.mesh.tolerance << "\n";
  if (scene_.mesh.cell) *this << "mesh cell " << *scene_.mesh.cell << "\n";
  if (scene_.mesh.bounds) {
    *this << "mesh bounds " << scene_.mesh.bounds->min << ", " << scene_.mesh.bounds->max << "\n";
  }
}

void Printer::print_profile(const StrengthProfile& p, const std::string& name) {
  *this << "texture " << name << " strength " << kProfileNames[static_cast<std::size_t>(p.along_u)]
        << " " << kProfileNames[static_cast<std::size_t>(p.along_v)];
  *this << " scale " << Vec3d{p.scale_u, p.scale_v, 1.0};
  *this << " translate " << Vec3d{p.translate_u, p.translate_v, 0.0};
  *this << " times " << Vec3d{p.times, p.times, p.times};
  if (std::isfinite(p.lower) || std::isfinite(p.upper)) {
    constexpr double kLargest = std::numeric_limits<double>::max();
    const double lo = std::max(p.lower, -kLargest);
    const double hi = std::min(p.upper, kLargest);
    *this << " bounds " << Vec3d{lo, lo, lo} << ", " << Vec3d{hi, hi, hi};
  }
  *this << "\n";
}

void Printer::print_material(std::size_t index) {
  const Material& m = scene_.materials[index];
  std::string textures;
  for (std::size_t i = 0; i < m.profiles.size(); ++i) {
    const std::string name = "t" + std::to_string(index + 1) + "_" + std::to_string(i + 1);
    print_profile(m.profiles[i], name);
    textures += (i == 0 ? " texture " : " + ") + name;
  }
  *this << "surface " << material_names_[index] << " diffuse " << m.diffuse;
  *this << " ambient " << m.ambient << " specular " << m.specular << " shine " << m.shine;
  if (m.radius) *this << " radius " << *m.radius;
  if (m.blobbiness) *this << " blobbiness " << *m.blobbiness;
  if (m.kernel) *this << " kernel " << name_of(*m.kernel);
  if (m.width) *this << " width " << *m.width;
  *this << " strength " << m.strength << textures << "\n";
}

void Printer::print_transform(const Affine& map, const std::string& indent) {
  for (const TransformStep& step : decompose(map)) {
    *this << indent;
    switch (step.kind) {
      case TransformStep::Kind::rotate:
        *this << "rotate " << step.vector << " " << step.degrees;
        break;
      case TransformStep::Kind::scale:
        *this << "scale " << step.vector;
        break;
      case TransformStep::Kind::translate:
        *this << "translate " << step.vector;
        break;
    }
    *this << "\n";
  }
}

/// An `arc`, `torus` or `arch`.
void Printer::print_curve(const Element& element) {
  if (const Segment* segment = std::get_if<Segment>(&element.skeleton)) {
    *this << segment->a << ", " << 0.5 * segment->a + 0.5 * segment->b << ", " << segment->b;
    return;
  }
  const Arc& arc = std::get<Arc>(element.skeleton);
  if (element.kind == ElementKind::arch) {
    const double half = arc.sweep / 2;
    const Vec3d along = arc.radius * std::cos(half) * arc.ex;
    const Vec3d across = arc.radius * std::sin(half) * arc.ey;
    *this << arc.center + along - across << ", " << arc.center + arc.radius * arc.ex << ", "
          << arc.center + along + across;
    return;
  }
  // The angle of the middle, in the frame that the language gives to the normal.
  const Vec3d w = dot(cross(arc.ex, arc.ey), arc.normal) < 0 ? -arc.normal : arc.normal;
  *this << arc.center << ", " << w;
  if (element.spelling == Spelling::torus) return;
  const Vec3d u = reference_axis(w);
  const double middle = std::atan2(dot(arc.ex, cross(w, u)), dot(arc.ex, u));
  *this << " " << (middle - arc.sweep / 2) * kDegreesPerRadian << " "
        << std::min(360.0, arc.sweep * kDegreesPerRadian);
}

void Printer::print_taper(const SegmentWeight& weight) {
  *this << " taper " << weight.b0 << " " << weight.b2;
  if (weight != linear_weight(weight.b0, weight.b2)) *this << " " << middle_value(weight);
}

void Printer::print_quadric(const Quadric& q) {
  const Symmetric3& s = q.square;
  *this << Vec3d{s.xx, s.yy, s.zz} << ", " << 2.0 * Vec3d{s.xy, s.xz, s.yz} << ", " << q.linear
        << ", " << q.constant;
  if (q.bounds) *this << " bounds " << q.bounds->min << ", " << q.bounds->max;
}

void Printer::print_element(const Element& element) {
  const std::string_view command = element.spelling == Spelling::pipe    ? "pipe"
                                   : element.spelling == Spelling::torus ? "torus"
                                                                         : name_of(element.kind);
  *this << indent() << command << " "
        << material_names_[static_cast<std::size_t>(element.material)];
  const bool sweeps = element.kind == ElementKind::arc;
  if (sweeps) *this << " " << std::get<Arc>(element.skeleton).radius;
  if (element.own_radius) *this << " " << *element.own_radius;
  *this << " ";
  switch (element.kind) {
    case ElementKind::sphere:
    case ElementKind::dot:
    case ElementKind::gauss:
      *this << std::get<Point>(element.skeleton).position;
      break;
    case ElementKind::cylinder:
    case ElementKind::line:
      *this << std::get<Segment>(element.skeleton).a << ", "
            << std::get<Segment>(element.skeleton).b;
      if (element.taper) print_taper(*element.taper);
      break;
    case ElementKind::cone:
      *this << std::get<Segment>(element.skeleton).a << ", " << element.apex_radius << " "
            << std::get<Segment>(element.skeleton).b;
      break;
    case ElementKind::box:
      *this << std::get<Segment>(element.skeleton).a << ", "
            << std::get<Segment>(element.skeleton).b;
      break;
    case ElementKind::polygon:
      for (const Vec3d& vertex : scene_.polygons[static_cast<std::size_t>(element.shape)].vertex) {
        *this << vertex << ", ";
      }
      break;
    case ElementKind::quadric:
      print_quadric(scene_.quadrics[static_cast<std::size_t>(element.shape)]);
      break;
    case ElementKind::triangle:
      for (const Vec3d& vertex : std::get<Triangle>(element.skeleton).vertex) {
        *this << vertex << ", ";
      }
      break;
    case ElementKind::plane:
      *this << std::get<Plane>(element.skeleton).point << ", "
            << std::get<Plane>(element.skeleton).normal;
      break;
    case ElementKind::arc:
    case ElementKind::arch:
      print_curve(element);
      break;
  }
  *this << "\n";
  print_transform(element.transform, indent());
}

/// What is directly below an object (-1: the scene), in the order of the scene's lists.
void Printer::print_level(int object) {
  const auto level = static_cast<std::size_t>(object + 1);
  auto element = elements_[level].begin();
  const auto end = elements_[level].end();
  for (const int child : children_[level]) {
    const auto c = static_cast<std::size_t>(child);
    for (; element != end && *element < first_element_[c]; ++element) {
      print_element(scene_.elements[*element]);
    }
    const Object& below = scene_.objects[c];
    *this << indent() << "object " << as_word(below.name) << "\n";
    ++depth_;
    if (below.blend) {
      *this << indent() << "blend" << (below.blend->empty() ? "" : " " + as_word(*below.blend))
            << "\n";
    }
    print_level(child);
    --depth_;
    *this << indent() << "close\n";
    print_transform(below.transform, indent());
  }
  for (; element != end; ++element) print_element(scene_.elements[*element]);
}

std::string Printer::print() {
  name_materials();
  print_options();
  for (std::size_t i = 0; i < scene_.materials.size(); ++i) print_material(i);

  // Sort elements and objects under those that hold them.
  const std::size_t count = scene_.objects.size();
  children_.resize(count + 1);
  elements_.resize(count + 1);
  first_element_.assign(count, 0);
  std::vector<std::size_t> least(count, std::numeric_limits<std::size_t>::max());
  for (std::size_t i = scene_.elements.size(); i-- > 0;) {
    const int object = scene_.elements[i].object;
    if (object >= 0) least[static_cast<std::size_t>(object)] = i;
  }
  for (std::size_t i = count; i-- > 0;) {
    const int parent = scene_.objects[i].parent;
    if (parent < 0) continue;
    std::size_t& above = least[static_cast<std::size_t>(parent)];
    above = std::min(above, least[i]);
  }
  for (std::size_t i = 0; i < count; ++i) {
    // An object without elements stands anywhere among them: at once.
    if (least[i] != std::numeric_limits<std::size_t>::max()) first_element_[i] = least[i];
    children_[static_cast<std::size_t>(scene_.objects[i].parent + 1)].push_back(
        static_cast<int>(i));
  }
  for (std::size_t i = 0; i < scene_.elements.size(); ++i) {
    elements_[static_cast<std::size_t>(scene_.elements[i].object + 1)].push_back(i);
  }
  print_level(-1);
  return std::move(text_);
}

}  // namespace

std::string print_art(const Scene& scene) {
  return Printer(scene).print();
}

}  // namespace cs2mesh
