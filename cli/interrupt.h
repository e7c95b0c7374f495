// Ctrl-C: the first asks the running stage to stop, the second ends the program at once. Neither
// leaves a half-written file behind.
#pragma once

namespace cs2mesh {

/// Takes SIGINT and SIGTERM over, for the whole program.
void install_interrupt_handler();

/// Whether the user has asked to stop.
bool interrupted();

/// While one lives the second request waits too: temporary files exist, and whoever made them looks
/// at interrupted() before they get their names.
class WhileWriting {
 public:
  WhileWriting();
  ~WhileWriting();
  WhileWriting(const WhileWriting&) = delete;
  WhileWriting& operator=(const WhileWriting&) = delete;
};

}  // namespace cs2mesh
