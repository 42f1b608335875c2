#include "surrogates/tables/exports/fmu_package.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>

#include "core/file.h"
#include "core/hash.h"
#include "core/inputs.h"
#include "surrogates/tables/exports/zip.h"

extern char** environ;

namespace underbody::tables {

namespace {

/// Compiles in a folder with relative names, so that the bytes do not depend on where. False when there is no compiler
/// or it failed.
bool compiled(const std::filesystem::path& folder, const std::string& command) {
    std::string script = "cd \"$0\" && exec " + command;
    std::string shell = "sh";
    std::string option = "-c";
    std::string where = folder.string();
    char* arguments[] = {shell.data(), option.data(), script.data(), where.data(), nullptr};
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, 1, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_addopen(&actions, 2, "/dev/null", O_WRONLY, 0);
    pid_t child = 0;
    const int failed = posix_spawnp(&child, "sh", &actions, nullptr, arguments, environ);
    posix_spawn_file_actions_destroy(&actions);
    int status = 1;
    return failed == 0 && waitpid(child, &status, 0) == child && status == 0;
}

void remark(core::Problems& remarks, std::string text) {
    remarks.push_back({core::Problem::Severity::warning, std::move(text), {}});
}

}  // namespace

std::string fmu_guid(const std::string& content) {
    const std::string hash = core::content_hash(content);
    return "{" + hash.substr(0, 8) + "-" + hash.substr(8, 4) + "-" + hash.substr(12, 4) + "-" + hash.substr(16, 4) +
           "-" + hash.substr(20, 12) + "}";
}

void write_fmu(const std::filesystem::path& path, const std::string& name, const std::string& description,
               const FmuSources& sources, core::Problems& remarks) {
    core::TemporaryFolder folder("underbody-fmu");
    const core::RecordInputs own(folder.path());  // nothing there is an input
    for (const auto& [file, text] : sources) {
        core::write_file(folder.path() / file, text);
    }
    const std::string common = "-std=c99 -O2 -shared -s ", from = sources.front().first;
    std::vector<std::pair<std::string, std::string>> entries = {{"modelDescription.xml", description}};
#if defined(__x86_64__)
    if (compiled(folder.path(),
                 "cc " + common + "-fPIC -fvisibility=hidden -Wl,--build-id=none -o linux64.so " + from + " -lm")) {
        entries.emplace_back("binaries/linux64/" + name + ".so", core::read_file(folder.path() / "linux64.so"));
    } else {
        remark(remarks, "there is no working C compiler 'cc': the FMU has no binary for Linux, its source is in it");
    }
#else
    remark(remarks, "this machine is not x86-64: the FMU has no binary for Linux, its source is in it");
#endif
    // Without this compiler an FMU is as it always was: for Linux, with its source for all others.
    if (compiled(folder.path(), "x86_64-w64-mingw32-gcc " + common +
                                    "-static-libgcc -Wl,--no-insert-timestamp -o win64.dll " + from)) {
        entries.emplace_back("binaries/win64/" + name + ".dll", core::read_file(folder.path() / "win64.dll"));
    }
    for (const auto& [file, text] : sources) {
        entries.emplace_back("sources/" + file, text);
    }
    core::write_file(path, zip_archive(entries, "Underbody"));
}

}  // namespace underbody::tables
