// The lines of a session as they come, on disk at once: what was done after a crash is replayed from it.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "studio/desktop/state/history.h"

namespace underbody::studio {

/// Holds a lock on its file while it lives, so that another program does not take it for one of a crash. Its file goes
/// when the object does.
class ActionLog {
public:
    /// Makes `FOLDER/session-N.log`. Throws core::SystemError.
    explicit ActionLog(const std::filesystem::path& folder);
    ~ActionLog();
    ActionLog(const ActionLog&) = delete;
    ActionLog& operator=(const ActionLog&) = delete;
    void append(const std::string& line);
    [[nodiscard]] const std::filesystem::path& file() const { return file_; }

private:
    std::filesystem::path file_;
    int descriptor_ = -1;
};

/// Logs in the folder that nobody holds and that have lines: of programs that ended without winding up. Newest first.
std::vector<std::filesystem::path> left_over_logs(const std::filesystem::path& folder);

/// Carries out every line of a log: actions, "undo", "redo"; empty lines and comments are passed over. `load` gives the
/// session that a state needs (called when study or files changed). Throws core::Error with the line; what came before
/// it is done then. With `refused` the lines whose action is refused (what they name may have gone since) are passed
/// over and said there.
using SessionLoader = std::function<SessionPointer(const State&)>;
void replay(std::string_view text, const std::string& source, History& history, SessionPointer& session,
            const SessionLoader& load, std::vector<std::string>* refused = nullptr);

/// Opens what a program was started with, as its first step: a study, a SHAPE.toml, a CFD file; of a session (.ubs) the
/// history begins with its state. Throws core::Error: nothing of that name (with the nearest), a study or a shape that
/// is wrong, a session that lacks an input.
void start_with(const std::filesystem::path& path, History& history, SessionPointer& session,
                const SessionLoader& load);

/// Opens what the state names, as the window does in a job.
SessionPointer load_session(const State& state, const SessionPointer& known);

}  // namespace underbody::studio
