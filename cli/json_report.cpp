#include "cli/json_report.h"

#include <algorithm>
#include <iostream>
#include <nlohmann/json.hpp>

#include "cli/interrupt.h"
#include "libfield/base/atomic_file.h"
#include "libfield/base/peak_memory.h"

namespace cs2mesh {
namespace {

double in_seconds(std::chrono::steady_clock::duration duration) {
  return std::chrono::duration<double>(duration).count();
}

}  // namespace

void Stopwatch::start(const std::string& stage) {
  stop();
  stage_ = stage;
  stage_begin_ = Clock::now();
  if (progress_ != nullptr) progress_->report(stage, 0.0);
}

void Stopwatch::stop() {
  if (!stage_.empty()) add(stage_, in_seconds(Clock::now() - stage_begin_));
  stage_.clear();
}

void Stopwatch::add(const std::string& stage, double seconds) {
  const auto known = std::find_if(spent_.begin(), spent_.end(),
                                  [&](const auto& entry) { return entry.first == stage; });
  if (known == spent_.end()) {
    spent_.emplace_back(stage, seconds);
  } else {
    known->second += seconds;
  }
}

Json Stopwatch::seconds() const {
  Json json = Json::object();
  for (const auto& [stage, seconds] : spent_) json[stage] = seconds;
  json["total"] = in_seconds(Clock::now() - begin_);
  return json;
}

Json to_json(const Evaluations& count) {
  return {{"value", count.values},
          {"gradient", count.gradients},
          {"hessian", count.hessians},
          {"enclosure", count.enclosures}};
}

void add_run(Json& report, const Stopwatch& watch, const Console& console) {
  report["seconds"] = watch.seconds();
  report["peak_memory_bytes"] = peak_memory_bytes();
  report["threads"] = console.threads();
  report["version"] = CS2MESH_VERSION;
}

void deliver(const Json& report, const std::string& path, Console& console) {
  // File names need not be UTF-8; such bytes are replaced rather than refused.
  const std::string text = report.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
  if (!path.empty()) {
    const WhileWriting guard;
    console.take(write_file(path, text));
  }
  if (!console.json()) return;
  std::cout << text << std::flush;
  if (!std::cout) console.fail(Failure::output, "cannot write to the standard output");
}

}  // namespace cs2mesh
