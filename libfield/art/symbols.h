// What a scene has given names to.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "libfield/base/vec.h"
#include "libfield/profile/profile.h"
#include "libfield/scene/scene.h"

namespace cs2mesh {

/// A `texture`: its layers with the target `strength`. Other targets do not act.
struct Texture {
  std::vector<StrengthProfile> strength;
};

/// Index into Scene::materials.
struct MaterialIndex {
  int value = 0;
};

/// The value of a variable whose definition was an error: it stands for any type, so that the
/// error is reported once and not at every use.
struct BrokenValue {};

using Value = std::variant<BrokenValue, double, Vec3d, Color, Texture, MaterialIndex>;

template <class T>
using NameMap = std::map<std::string, T, std::less<>>;

struct Symbols {
  NameMap<Value> variables;
  NameMap<Texture> textures;
  NameMap<MaterialIndex> surfaces;
};

template <class T>
const T* find(const NameMap<T>& map, std::string_view name) {
  const auto found = map.find(name);
  return found == map.end() ? nullptr : &found->second;
}

template <class T>
std::vector<std::string_view> names_of(const NameMap<T>& map) {
  std::vector<std::string_view> names;
  for (const auto& entry : map) names.push_back(entry.first);
  return names;
}

}  // namespace cs2mesh
