#include "cases/prove_export.h"

#include <chrono>
#include <optional>
#include <thread>

#include "cases/child_process.h"
#include "core/error.h"
#include "core/file.h"
#include "core/text.h"

namespace underbody::cases {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t points_proved = 10000;

struct Run {
    int code = 0;
    std::string said;
};

/// Ends with the program, or when somebody cancels. What the rest takes is not known: the bar creeps from `from` on.
Run run(const std::string& program, const std::vector<std::string>& arguments, const fs::path& folder, double from,
        const std::string& what, core::Progress& progress) {
    ChildProcess child(program, arguments, folder, folder / "said");
    std::optional<int> code;
    for (int waits = 0; !(code = child.ended()); ++waits) {
        progress.check();
        progress.report(from + 0.3 * waits / (waits + 60.0), what);
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return {*code, std::string(core::trimmed(core::read_file(folder / "said")))};
}

std::string between(const std::string& text, const std::string& before, const std::string& behind) {
    const auto begin = text.find(before), end = text.find(behind);
    return begin == std::string::npos || end == std::string::npos
               ? std::string()
               : text.substr(begin + before.size(), end - begin - before.size());
}

}  // namespace

Proof prove_export(const std::vector<tables::ForceTable>& tables, tables::ExportOptions options,
                   core::Progress& progress) {
    Proof proof;
    const auto compiler = find_program("cc");
    if (!compiler) {
        proof.sentence = "Not proved: there is no C compiler (cc) on this machine";
        return proof;
    }
    const core::TemporaryFolder folder;
    options.self_test = true;
    options.self_test_points = points_proved;
    progress.report(0, "writing the header");
    const std::string name = options.name.empty() ? "table" : tables::identifier(options.name);
    const auto result = tables::export_tables(tables, "c", folder.path() / (name + ".h"), options);
    progress.check();
    const Run compiled =
        run(compiler->string(), {"-std=c99", "-O1", "-o", "proof", result.files.back().filename().string(), "-lm"},
            folder.path(), 0.3, "compiling", progress);
    if (compiled.code != 0) {
        proof.sentence = "It could not be compiled: " + compiled.said;
        return proof;
    }
    const Run compared = run((folder.path() / "proof").string(), {}, folder.path(), 0.7, "comparing", progress);
    proof.equal = compared.code == 0;
    proof.points = points_proved;
    const std::string off = between(compared.said, "a value by ", " at most");  // "2.22e-16", "1 units"
    const std::string unit = options.fixed_point  ? " in the last place"
                             : tables.size() == 1 ? " " + tables.front().unit()
                                                  : " of their units";
    proof.sentence =
        proof.equal ? "Compiled, run and equal: value, slope and error at 10,000 points, within the table and beyond; "
                      "values differ by at most " +
                          off + unit
                    : "NOT equal: " + (compared.said.empty() ? "it did not end" : compared.said);
    return proof;
}

}  // namespace underbody::cases
