#include "core/inputs.h"

#include <dirent.h>
#include <fnmatch.h>
#include <sys/stat.h>

#include <algorithm>
#include <chrono>
#include <memory>

namespace underbody::core {

namespace fs = std::filesystem;

namespace {

thread_local const RecordInputs* current_scope = nullptr;

std::int64_t nanoseconds(const timespec& time) {
    return std::int64_t{time.tv_sec} * 1'000'000'000 + std::int64_t{time.tv_nsec};
}

}  // namespace

FileStamp stamp_of(const fs::path& path) { return stamp_of(path.c_str()); }

FileStamp stamp_of(const char* path) {
    struct stat status {};
    if (::stat(path, &status) != 0) {
        return {};
    }
    FileStamp stamp;
    stamp.kind = S_ISREG(status.st_mode)   ? FileStamp::Kind::file
                 : S_ISDIR(status.st_mode) ? FileStamp::Kind::folder
                                           : FileStamp::Kind::other;
    stamp.device = status.st_dev;
    stamp.inode = status.st_ino;
    stamp.size = status.st_size;
    stamp.modified = nanoseconds(status.st_mtim);
    stamp.changed = nanoseconds(status.st_ctim);
    return stamp;
}

std::int64_t now_in_nanoseconds() {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::system_clock::now().time_since_epoch())
        .count();
}

std::vector<std::string> names_in_folder(const fs::path& folder, const std::string& pattern) {
    std::vector<std::string> names;
    const std::unique_ptr<DIR, int (*)(DIR*)> open(::opendir(folder.c_str()), ::closedir);
    if (open == nullptr) {
        return names;
    }
    while (const dirent* entry = ::readdir(open.get())) {
        std::string name = entry->d_name;
        if (name == "." || name == ".." || ::fnmatch(pattern.c_str(), name.c_str(), 0) != 0) {
            continue;
        }
        const bool may_be_folder = entry->d_type == DT_LNK || entry->d_type == DT_UNKNOWN;
        if (entry->d_type == DT_DIR || (may_be_folder && stamp_of(folder / name).kind == FileStamp::Kind::folder)) {
            name += '/';
        }
        names.push_back(std::move(name));
    }
    std::sort(names.begin(), names.end());
    return names;
}

std::vector<std::string> names_that_fit(const std::vector<std::string>& sorted, const std::string& pattern) {
    const std::string beginning = pattern.substr(0, pattern.find_first_of("*?[\\"));
    std::vector<std::string> names;
    for (auto name = std::lower_bound(sorted.begin(), sorted.end(), beginning);
         name != sorted.end() && name->starts_with(beginning); ++name) {
        const std::string own = name->ends_with('/') ? name->substr(0, name->size() - 1) : *name;
        if (::fnmatch(pattern.c_str(), own.c_str(), 0) == 0) {
            names.push_back(*name);
        }
    }
    return names;
}

void InputRecord::add(Input input) {
    const std::string kind(1, "cpn"[static_cast<int>(input.kind)]);
    std::pair<std::string, std::string> key(input.path.string(), kind + input.pattern);
    {
        const std::lock_guard lock(mutex_);
        if (entries_.contains(key)) {
            return;
        }
    }
    std::string state = state_of_(input);
    const std::lock_guard lock(mutex_);
    entries_.try_emplace(std::move(key), Entry{std::move(input), std::move(state)});
}

void InputRecord::add(const std::vector<Entry>& entries) {
    const std::lock_guard lock(mutex_);
    for (const auto& entry : entries) {
        const std::string kind(1, "cpn"[static_cast<int>(entry.input.kind)]);
        entries_.emplace(std::pair(entry.input.path.string(), kind + entry.input.pattern), entry);
    }
}

std::vector<InputRecord::Entry> InputRecord::entries() const {
    const std::lock_guard lock(mutex_);
    std::vector<Entry> all;
    for (const auto& [key, entry] : entries_) {
        if (entry.input.kind != Input::Kind::presence || !entries_.contains({key.first, "c"})) {
            all.push_back(entry);
        }
    }
    return all;
}

RecordInputs::RecordInputs(InputRecord& record) : record_(&record), outer_(current_scope) { current_scope = this; }
RecordInputs::RecordInputs(fs::path own_folder) : own_folder_(std::move(own_folder)), outer_(current_scope) {
    current_scope = this;
}
RecordInputs::~RecordInputs() { current_scope = outer_; }

void note(const Input& input) {
    for (const RecordInputs* scope = current_scope; scope != nullptr; scope = scope->outer_) {
        if (scope->record_ != nullptr) {
            scope->record_->add(input);
        } else if (input.path.native().starts_with(scope->own_folder_.native() + "/") ||
                   input.path == scope->own_folder_) {
            return;
        }
    }
}

void note(const std::vector<InputRecord::Entry>& entries) {
    for (const RecordInputs* scope = current_scope; scope != nullptr; scope = scope->outer_) {
        if (scope->record_ != nullptr) {
            scope->record_->add(entries);
        }
    }
}

void note_content(const fs::path& path) {
    if (current_scope != nullptr) {
        note(Input{Input::Kind::content, path, {}});
    }
}

void note_presence(const fs::path& path) {
    if (current_scope != nullptr) {
        note(Input{Input::Kind::presence, path, {}});
    }
}

void note_names(const fs::path& folder, const std::string& pattern) {
    if (current_scope != nullptr) {
        note(Input{Input::Kind::names, folder, pattern});
    }
}

const RecordInputs* InputScope::current() { return current_scope; }
InputScope::InputScope(const RecordInputs* scope) : before_(current_scope) { current_scope = scope; }
InputScope::~InputScope() { current_scope = before_; }

}  // namespace underbody::core
