// libFuzzer target: any bytes are a scene or an error, and a scene prints as a scene.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "tests/fuzz/art_fuzz_case.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (!cs2mesh::fuzz_case_holds({reinterpret_cast<const char*>(data), size})) std::abort();
  return 0;
}
