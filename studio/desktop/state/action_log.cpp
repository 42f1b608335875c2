#include "studio/desktop/state/action_log.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "core/file.h"
#include "postproc/importers/importer.h"
#include "studio/desktop/state/known_things.h"
#include "studio/desktop/state/session_file.h"

namespace underbody::studio {

namespace fs = std::filesystem;

ActionLog::ActionLog(const fs::path& folder) {
    fs::create_directories(folder);
    for (int number = 1; number < 10000; ++number) {
        file_ = folder / ("session-" + std::to_string(::getpid()) + "-" + std::to_string(number) + ".log");
        descriptor_ = ::open(file_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_APPEND | O_CLOEXEC, 0600);
        if (descriptor_ >= 0 || errno != EEXIST) {
            break;
        }
    }
    if (descriptor_ < 0) {
        throw core::SystemError("write", std::string("the log of the session cannot be made: ") + std::strerror(errno),
                                {file_.string(), {}, {}, {}});
    }
    ::flock(descriptor_, LOCK_EX | LOCK_NB);
}

ActionLog::~ActionLog() {
    std::error_code gone;
    fs::remove(file_, gone);
    ::close(descriptor_);
}

void ActionLog::append(const std::string& line) {
    const std::string text = line + "\n";
    std::size_t written = 0;
    while (written < text.size()) {
        const auto count = ::write(descriptor_, text.data() + written, text.size() - written);
        if (count < 0 && errno != EINTR) {
            return;  // a full disk must not stop the work that the log only records
        }
        written += count > 0 ? static_cast<std::size_t>(count) : 0;
    }
}

std::vector<fs::path> left_over_logs(const fs::path& folder) {
    std::vector<fs::path> logs;
    std::error_code none;
    for (const auto& entry : fs::directory_iterator(folder, none)) {
        const std::string name = entry.path().filename().string();
        if (!name.starts_with("session-") || entry.path().extension() != ".log") {
            continue;
        }
        const int descriptor = ::open(entry.path().c_str(), O_RDONLY | O_CLOEXEC);
        if (descriptor < 0) {
            continue;
        }
        const bool held = ::flock(descriptor, LOCK_EX | LOCK_NB) != 0;
        ::close(descriptor);
        if (!held && entry.file_size(none) > 0) {
            logs.push_back(entry.path());
        }
    }
    std::sort(logs.begin(), logs.end(),
              [](const fs::path& a, const fs::path& b) { return fs::last_write_time(a) > fs::last_write_time(b); });
    return logs;
}

SessionPointer load_session(const State& state, const SessionPointer& known) {
    const bool same = known && known->folder == fs::path(state.study);
    return with_models(same ? with_files(*known, state.files) : open_session(state.study, state.files), state.accepted);
}

void start_with(const fs::path& path, History& history, SessionPointer& session, const SessionLoader& load) {
    const std::string given = action::existing_path(path);
    const auto act = [&](const Words& words) {
        history.act(words, *session);
        session = load(*history.state());
    };
    if (fs::path(given).extension() == ".ubs") {
        const auto saved = read_session(given);
        if (!saved.missing.empty()) {
            throw core::InputError("missing", saved.problems.front().message, {given, {}, {}, {}});
        }
        history = History(saved.state);
        session = load(*history.state());
    } else if (fs::path(given).filename() == "study.toml" || fs::exists(fs::path(given) / "study.toml")) {
        act({"open", given});
    } else if (fs::path(given).extension() == ".toml") {
        act({"add", "shape", given});
        act({"shape", fs::path(given).stem().string()});
    } else if (fs::is_directory(given) && postproc::importer_for(given) == nullptr) {
        act({"open", given});  // says that there is no study in it
    } else {
        act({"add", "field", given});
        act({"select", "field/" + given});
    }
}

void replay(std::string_view text, const std::string& source, History& history, SessionPointer& session,
            const SessionLoader& load, std::vector<std::string>* refused) {
    std::int64_t number = 0;
    while (!text.empty()) {
        const auto end = text.find('\n');
        const std::string_view line = text.substr(0, end);
        text = end == std::string_view::npos ? std::string_view() : text.substr(end + 1);
        ++number;
        const StatePointer before = history.state();
        try {
            const Words words = words_of(line);
            if (words.empty()) {
                continue;
            }
            if (words.front() == "undo" || words.front() == "redo") {
                const bool moved = words.front() == "undo" ? history.undo() : history.redo();
                if (!moved) {
                    throw core::InputError("order", "there is nothing to " + words.front());
                }
            } else {
                history.act(words, *session);
            }
            if (history.state()->study != before->study || history.state()->files != before->files ||
                history.state()->accepted != before->accepted) {
                session = load(*history.state());
            }
        } catch (const core::Error& error) {
            if (refused != nullptr && history.state() == before) {
                refused->push_back(std::string(line) + ": " + error.message());
                continue;
            }
            throw core::InputError(error.kind(), error.message(), {source, number, {}, {}}, error.hint());
        }
    }
}

}  // namespace underbody::studio
