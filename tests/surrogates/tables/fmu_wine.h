// The Windows binary of an FMU, called by a small program under wine.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "core/file.h"
#include "tests/support/support.h"

namespace underbody::test {

/// What runs Windows programs; empty where there is nothing that does.
inline std::string wine() {
    for (const char* place : {"/usr/lib/wine/wine64", "/usr/bin/wine64", "/usr/bin/wine"}) {
        if (std::filesystem::exists(place)) {
            return place;
        }
    }
    return {};
}

/// Skips the test, saying so, where Windows binaries cannot be made or run.
#define UNDERBODY_NEEDS_WINE()                                                                                      \
    if (::underbody::test::wine().empty() || std::system("command -v x86_64-w64-mingw32-gcc >/dev/null 2>&1") != 0) \
    GTEST_SKIP() << "skipped: the packages gcc-mingw-w64-x86-64 and wine64 are not installed"

/// Instantiates the DLL for co-simulation, initialises it and carries out commands, one a line: `set N REFERENCE
/// VALUE...`, `step TIME WIDTH`, `get N REFERENCE...`. Gives the values that were got, in their order; empty when
/// something failed.
inline std::vector<double> called_under_wine(const std::string& dll, const std::string& guid,
                                             const std::string& commands) {
    const core::TemporaryFolder folder;
    core::write_file(folder.path() / "model.dll", dll);
    core::write_file(folder.path() / "commands.txt", commands);
    core::write_file(folder.path() / "caller.c", R"(
#include <stdio.h>
#include <string.h>
#include <windows.h>
typedef int (*real_call)(void *, const unsigned *, size_t, double *);
int main(int count, char **arguments) {
    HMODULE library = LoadLibraryA("model.dll");
    void *(*instantiate)(const char *, int, const char *, const char *, const void *, int, int);
    int (*plain)(void *);
    int (*step)(void *, double, double, int);
    real_call set, get;
    FILE *in = fopen("commands.txt", "r");
    char word[16];
    void *c;
    if (count != 2 || library == NULL || in == NULL) return 1;
    instantiate = (void *)GetProcAddress(library, "fmi2Instantiate");
    step = (void *)GetProcAddress(library, "fmi2DoStep");
    set = (real_call)(void *)GetProcAddress(library, "fmi2SetReal");
    get = (real_call)(void *)GetProcAddress(library, "fmi2GetReal");
    c = instantiate("x", 1, arguments[1], "", NULL, 0, 0);
    if (c == NULL) return 2;
    plain = (void *)GetProcAddress(library, "fmi2EnterInitializationMode");
    if (plain(c) != 0) return 3;
    plain = (void *)GetProcAddress(library, "fmi2ExitInitializationMode");
    if (plain(c) != 0) return 4;
    while (fscanf(in, "%15s", word) == 1) {
        unsigned n, i, reference[64];
        double value[64], t, width;
        if (strcmp(word, "step") == 0) {
            if (fscanf(in, "%lf %lf", &t, &width) != 2 || step(c, t, width, 1) != 0) return 5;
            continue;
        }
        if (fscanf(in, "%u", &n) != 1 || n > 64) return 6;
        for (i = 0; i < n; ++i) {
            if (fscanf(in, "%u", &reference[i]) != 1) return 7;
            if (word[0] == 's' && fscanf(in, "%lf", &value[i]) != 1) return 8;
        }
        if (word[0] == 's') {
            if (set(c, reference, n, value) != 0) return 9;
        } else {
            if (get(c, reference, n, value) != 0) return 10;
            for (i = 0; i < n; ++i) printf("%.17g\n", value[i]);
        }
    }
    return 0;
}
)");
    const auto compiled =
        run_program("x86_64-w64-mingw32-gcc", {"-O1", "-w", "-o", "caller.exe", "caller.c"}, folder.path());
    if (compiled.exit_code != 0) {
        return {};
    }
    // One prefix for all tests of a build: making it takes seconds.
    const auto prefix = program_folder().parent_path() / "wine";
    const auto run = run_program(wine(), {"caller.exe", guid}, folder.path(),
                                 {{"WINEPREFIX", prefix.string()}, {"WINEDEBUG", "-all"}, {"DISPLAY", ""}});
    if (run.exit_code != 0) {
        return {};
    }
    std::vector<double> values;
    std::istringstream lines(run.output);
    for (std::string line; std::getline(lines, line);) {
        values.push_back(std::strtod(line.c_str(), nullptr));
    }
    return values;
}

}  // namespace underbody::test
