#include "cases/surroundings.h"

#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <regex>
#include <thread>

#include "cases/child_process.h"
#include "core/error.h"
#include "core/file.h"
#include "core/parallel.h"
#include "core/virtual_display.h"

namespace underbody::cases {

namespace fs = std::filesystem;

namespace {

/// What a program prints; empty when it cannot be started or takes longer than five seconds.
std::string said_by(const std::string& program, const std::vector<std::string>& arguments, core::Progress& progress) {
    const core::TemporaryFolder folder("underbody-doctor");
    std::vector<std::pair<std::string, std::string>> environment;
    if (std::getenv("WM_PROJECT_DIR") == nullptr) {
        environment.emplace_back("WM_PROJECT_DIR", "/usr/share/openfoam");  // as solves have it
    }
    try {
        ChildProcess child(program, arguments, folder.path(), folder.path() / "said", environment);
        const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(5);
        while (!child.ended() && std::chrono::steady_clock::now() < until) {
            progress.check();
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
        }
        if (!child.ended()) {
            child.stop();
            return {};
        }
        return core::read_file(folder.path() / "said");
    } catch (const core::SystemError&) {
        return {};
    }
}

/// A program, what tells its version, and the programs that belong to it.
struct Wanted {
    const char* name;
    const char* purpose;
    const char* package;
    std::vector<const char*> programs;  ///< the first is the main one; all are needed
    std::vector<std::string> arguments;
    const char* version;            ///< the expression whose first group is the version
    const char* refusal = nullptr;  ///< what it says instead where it is installed and cannot be used
    const char* set_up = nullptr;   ///< what to do then
};

const std::vector<Wanted>& wanted() {
    static const char* const number = R"((\d+(?:\.\d+)+))";
    static const std::vector<Wanted> all = {
        {"openfoam",
         "CFD of cases: solve, and sweep on this machine",
         "openfoam",
         {"simpleFoam", "blockMesh", "snappyHexMesh"},
         {"-help"},
         R"(OpenFOAM-\s*\(?v?(\d+))"},
        {"mpi", "one OpenFOAM case on several cores", "openmpi-bin", {"mpirun"}, {"--version"}, number},
        {"slurm",
         "CFD of cases: sweep on a cluster",
         "slurm-client",
         {"sbatch", "squeue", "scancel"},
         {"--version"},
         number,
         "configuration source",
         "the cluster's slurm.conf, in /etc/slurm or named by SLURM_CONF"},
        {"xvfb", "pictures of fields where there is no display: views, study run", "xvfb", {"Xvfb"}, {}, number},
        {"cc", "FMUs with a binary for Linux: export", "gcc libc6-dev", {"cc"}, {"--version"}, number},
        {"mingw",
         "FMUs with a binary for Windows",
         "gcc-mingw-w64-x86-64-win32",
         {"x86_64-w64-mingw32-gcc"},
         {"--version"},
         number},
        {"arm-gcc",
         "compiling exported C for Cortex-M",
         "gcc-arm-none-eabi libnewlib-arm-none-eabi",
         {"arm-none-eabi-gcc"},
         {"--version"},
         R"((\d+\.\d+\.\d+))"},
        {"qemu-arm",
         "running exported C for Cortex-M without a board",
         "qemu-system-arm",
         {"qemu-system-arm"},
         {"--version"},
         number},
        {"octave", "reading exported .mat files without MATLAB", "octave", {"octave-cli"}, {"--version"}, number},
    };
    return all;
}

Surrounding look_for(const Wanted& want, core::Progress& progress) {
    Surrounding result{want.name, want.purpose, std::string("apt install ") + want.package, {}, {}, {}, {}};
    for (const char* program : want.programs) {
        const auto path = find_program(program);
        if (!path) {
            result.note += std::string(result.note.empty() ? "not on the PATH: " : ", ") + program;
        } else if (result.path.empty()) {
            result.path = path->string();
        }
    }
    result.found = result.note.empty();
    if (result.found && !want.arguments.empty()) {
        std::smatch match;
        const std::string said = said_by(result.path, want.arguments, progress);
        if (std::regex_search(said, match, std::regex(want.version))) {
            result.version = match[1];
        } else if (want.refusal != nullptr && said.find(want.refusal) != std::string::npos) {
            result.found = false;
            result.note = result.path + " is here, but not set up";
            result.get = want.set_up;
        }
    }
    return result;
}

Surrounding display() {
    Surrounding result{"display",
                       "the desktop underbody-studio; pictures of fields need it or xvfb",
                       "log in at a desktop, or ssh -X; without one, apt install xvfb",
                       {},
                       {},
                       {},
                       {}};
    const char* name = std::getenv("DISPLAY");
    result.found = core::display_answers();
    result.path = name == nullptr ? "" : name;
    if (!result.found) {
        result.note = name == nullptr ? "DISPLAY is not set" : "no X server answers at DISPLAY";
    }
    return result;
}

/// Debian's Python with the module of this program; `modules` that others use with it.
Surrounding python(core::Progress& progress) {
    Surrounding result{
        "python", "the module `underbody` for scripts and notebooks", "apt install python3-underbody", {}, {}, {}, {}};
    const char* const program = "/usr/bin/python3";
    if (!fs::exists(program)) {
        result.note = "there is no /usr/bin/python3";
        return result;
    }
    result.path = program;
    const std::string said = said_by(
        program,
        {"-c",
         "import sys, importlib.util as u\n"
         "print('version', sys.version.split()[0])\n"
         "print('missing', *[m for m in ('underbody', 'numpy', 'vtkmodules', 'meshio') if u.find_spec(m) is None])"},
        progress);
    std::smatch match;
    if (std::regex_search(said, match, std::regex(R"(version (\S+))"))) {
        result.version = match[1];
    }
    if (std::regex_search(said, match, std::regex(R"(missing ([^\n]+))"))) {
        result.note = "without the modules " + match[1].str();
    }
    result.found = !result.version.empty() && result.note.find(" underbody") == std::string::npos &&
                   result.note.find(" numpy") == std::string::npos;
    return result;
}

}  // namespace

std::vector<Surrounding> surroundings(core::Progress& progress) {
    const auto& programs = wanted();
    std::vector<Surrounding> all(programs.size() + 2);
    core::parallel_for(
        all.size(),
        [&](std::size_t i) {
            all[i] = i < programs.size()    ? look_for(programs[i], progress)
                     : i == programs.size() ? display()
                                            : python(progress);
        },
        progress);
    return all;
}

void to_json(nlohmann::json& json, const Surrounding& one) {
    json = {{"name", one.name}, {"for", one.purpose}, {"found", one.found}, {"version", one.version},
            {"path", one.path}, {"get", one.get},     {"note", one.note}};
}

nlohmann::json machine_json() {
    std::error_code ignored;
    const auto space = fs::space(fs::current_path(ignored), ignored);
    return {{"cores", std::thread::hardware_concurrency()},
            {"memory", static_cast<std::int64_t>(::sysconf(_SC_PHYS_PAGES)) * ::sysconf(_SC_PAGE_SIZE)},
            {"free_disk", static_cast<std::int64_t>(space.available)}};
}

}  // namespace underbody::cases
