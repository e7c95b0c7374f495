#include "libfield/art/read_art.h"

#include <deque>
#include <filesystem>
#include <memory>
#include <system_error>
#include <utility>
#include <vector>

#include "libfield/art/command_table.h"
#include "libfield/art/file_text.h"
#include "libfield/art/lexer.h"
#include "libfield/art/number.h"
#include "libfield/art/scene_builder.h"

namespace cs2mesh {
namespace {

namespace fs = std::filesystem;

// Files that read one another twice each would be read exponentially often: these limits end that.
constexpr int kMaxFilesRead = 10'000;
constexpr std::size_t kMaxTotalFactor = 4;  // of ReadArtOptions::max_file_bytes

/// A file that is being read.
struct OpenFile {
  OpenFile(std::string content, const std::string& name, DiagnosticLog& log)
      : text(std::move(content)), lexer(text, name, log) {}
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;

  std::string text;
  Lexer lexer;
  fs::path identity;                 ///< to find cycles
  std::deque<ReadRequest> requests;  ///< of its last `read`, in order
};

/// Runs the commands of a file and of those that it reads.
class ArtReader {
 public:
  explicit ArtReader(const ReadArtOptions& options) : options_(options), builder_(options) {}

  Result<Scene> run_file(const std::string& path);
  Result<Scene> run_text(std::string_view text, const std::string& name);

 private:
  void define_variables();
  void open(const ReadRequest& request, const std::string& name);
  void open_requested();
  void start(std::string text, const std::string& name, fs::path identity);
  void run();
  Result<Scene> finish(const std::string& name);

  const ReadArtOptions& options_;
  SceneBuilder builder_;
  std::vector<std::unique_ptr<OpenFile>> files_;
  int files_read_ = 0;
  std::size_t bytes_read_ = 0;
};

/// Each definition is a `var` line of its own.
void ArtReader::define_variables() {
  for (const auto& [name, value] : options_.defines) {
    const std::string text = std::string("var ").append(name).append(" = ").append(value);
    const std::string place = std::string("-D ").append(name).append("=").append(value);
    DiagnosticLog& log = builder_.log();
    if (const auto error = check_is_text(text, place)) {
      log.error({place, 0, 0}, "this is not text, expected name=value");
      continue;
    }
    Lexer lexer(text, place, log, 0);
    Command command;
    bool first = true;
    while (lexer.next(command)) {
      if (first && command.opcode.text == "var") {
        execute(command, place, builder_);
      } else {
        log.error({place, 0, 0}, "found another line, expected a value");
      }
      first = false;
    }
  }
  builder_.lock_variables();
}

void ArtReader::start(std::string text, const std::string& name, fs::path identity) {
  if (auto error = check_is_text(text, name)) {
    builder_.log().error(std::move(error->where), std::move(error->message));
    return;
  }
  files_.push_back(std::make_unique<OpenFile>(std::move(text), name, builder_.log()));
  files_.back()->identity = std::move(identity);
}

void ArtReader::open(const ReadRequest& request, const std::string& name) {
  DiagnosticLog& log = builder_.log();
  const auto limit = [&](const std::string& message) {
    log.error(request.where, message, Failure::limit);
    builder_.leave_all = true;
  };
  if (static_cast<int>(files_.size()) >= options_.max_depth) {
    log.error(request.where, "files are nested too deeply, expected at most " +
                                 std::to_string(options_.max_depth) + " inside one another");
    return;
  }
  if (++files_read_ > kMaxFilesRead) {
    limit("too many files are read, expected at most " + std::to_string(kMaxFilesRead));
    return;
  }
  std::error_code error;
  fs::path identity = fs::weakly_canonical(name, error);
  if (error) identity = name;
  for (const auto& file : files_) {
    if (file->identity == identity) {
      log.error(request.where, "the file '" + name + "' reads itself, expected no cycle");
      return;
    }
  }
  Result<std::string> text = read_file_text(name, request.where, options_.max_file_bytes);
  if (!text) {
    const Diagnostic& problem = text.diagnostics().front();
    log.error(problem.where, problem.message, problem.failure);
    return;
  }
  bytes_read_ += text->size();
  if (bytes_read_ / kMaxTotalFactor > options_.max_file_bytes) {
    limit("the files are too large together, expected at most " +
          std::to_string(kMaxTotalFactor * options_.max_file_bytes) + " bytes");
    return;
  }
  start(*std::move(text), name, std::move(identity));
}

/// Opens the next file that the innermost file has asked for.
void ArtReader::open_requested() {
  OpenFile& file = *files_.back();
  const ReadRequest request = std::move(file.requests.front());
  file.requests.pop_front();
  if (!options_.allow_read) {
    builder_.log().error(request.where, "'read' is not allowed here, expected no 'read'");
    return;
  }
  open(request, (fs::path(file.lexer.file()).parent_path() / request.path).string());
}

void ArtReader::run() {
  Command command;
  while (!files_.empty() && !builder_.leave_all && !builder_.log().full()) {
    OpenFile& file = *files_.back();
    if (!file.requests.empty()) {
      open_requested();
      continue;
    }
    if (!file.lexer.next(command)) {
      files_.pop_back();
      continue;
    }
    execute(command, file.lexer.file(), builder_);
    file.requests.assign(builder_.reads.begin(), builder_.reads.end());
    builder_.reads.clear();
    if (builder_.leave_file) files_.pop_back();
    builder_.leave_file = false;
  }
}

Result<Scene> ArtReader::finish(const std::string& name) {
  run();
  Scene scene = builder_.finish();
  scene.file = name;
  const bool failed = builder_.log().failed();
  std::vector<Diagnostic> diagnostics = builder_.log().take(failed);
  if (failed) return Result<Scene>::failure(std::move(diagnostics));
  return {std::move(scene), std::move(diagnostics)};
}

Result<Scene> ArtReader::run_file(const std::string& path) {
  define_variables();
  open({path, {path, 0, 0}}, path);
  return finish(path);
}

Result<Scene> ArtReader::run_text(std::string_view text, const std::string& name) {
  define_variables();
  std::error_code error;
  fs::path identity = options_.allow_read ? fs::weakly_canonical(name, error) : fs::path(name);
  if (error) identity = name;
  start(std::string(text), name, std::move(identity));
  return finish(name);
}

}  // namespace

Result<Scene> read_art(const std::string& path, const ReadArtOptions& options) {
  return ArtReader(options).run_file(path);
}

Result<Scene> parse_art(std::string_view text, const std::string& name,
                        const ReadArtOptions& options) {
  return ArtReader(options).run_text(text, name);
}

}  // namespace cs2mesh
