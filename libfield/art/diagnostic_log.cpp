#include "libfield/art/diagnostic_log.h"

#include <utility>

namespace cs2mesh {

void DiagnosticLog::error(SourceLocation where, std::string message, Failure failure) {
  if (full()) return;
  ++errors_;
  diagnostics_.push_back({Severity::error, failure, std::move(where), std::move(message)});
}

void DiagnosticLog::once(Severity severity, std::string_view key, SourceLocation where,
                         std::string message) {
  if (const auto found = repeated_.find(key); found != repeated_.end()) {
    ++found->second.count;
    return;
  }
  repeated_.emplace(key, Repeated{diagnostics_.size(), 1});
  diagnostics_.push_back({severity, Failure::none, std::move(where), std::move(message)});
}

std::vector<Diagnostic> DiagnosticLog::take(bool errors_only) {
  for (const auto& [key, repeated] : repeated_) {
    if (repeated.count < 2) continue;
    diagnostics_[repeated.index].message +=
        " (and " + std::to_string(repeated.count - 1) + " more)";
  }
  repeated_.clear();
  if (errors_only) {
    std::erase_if(diagnostics_, [](const Diagnostic& d) { return d.severity != Severity::error; });
  }
  return std::exchange(diagnostics_, {});
}

std::string in_quotes(std::string_view text) {
  constexpr std::size_t kLongest = 40;
  if (text.size() <= kLongest) return "'" + std::string(text) + "'";
  std::size_t cut = kLongest;
  // Do not cut a UTF-8 sequence: its later bytes are 10xxxxxx.
  while (cut > 0 && (static_cast<unsigned char>(text[cut]) & 0xC0) == 0x80) --cut;
  return "'" + std::string(text.substr(0, cut)) + "...'";
}

std::string did_you_mean(std::string_view word, const std::vector<std::string_view>& candidates) {
  const std::string_view nearest = nearest_word(word, candidates);
  return nearest.empty() ? "" : ", did you mean " + in_quotes(nearest) + "?";
}

}  // namespace cs2mesh
