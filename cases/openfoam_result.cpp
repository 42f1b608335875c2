#include "cases/openfoam_result.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>

#include "core/error.h"
#include "core/file.h"
#include "core/text.h"
#include "postproc/importers/byte_stream.h"
#include "postproc/importers/reports/openfoam_forces.h"

namespace underbody::cases {

namespace fs = std::filesystem;

namespace {

std::string text_of(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

/// Comments become blanks.
std::string without_comments(std::string text) {
    for (std::size_t at = 0; (at = text.find('/', at)) != std::string::npos && at + 1 < text.size();) {
        const bool line = text[at + 1] == '/';
        if (!line && text[at + 1] != '*') {
            ++at;
            continue;
        }
        const std::size_t end = line ? text.find('\n', at) : text.find("*/", at + 2);
        const std::size_t stop = end == std::string::npos ? text.size() : end + (line ? 0 : 2);
        std::fill(text.begin() + static_cast<std::ptrdiff_t>(at), text.begin() + static_cast<std::ptrdiff_t>(stop),
                  ' ');
        at = stop;
    }
    return text;
}

/// What stands behind a word up to its ';': "simpleFoam" of "application simpleFoam;".
std::string entry_in(const std::string& text, const std::string& word) {
    for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) {
        const bool begins = at == 0 || std::string_view("\n\t ;{}").find(text[at - 1]) != std::string_view::npos;
        const std::size_t after = at + word.size();
        const std::size_t end = text.find(';', after);
        if (begins && end != std::string::npos &&
            std::string_view(" \t\n").find(text[after]) != std::string_view::npos) {
            return std::string(core::trimmed(std::string_view(text).substr(after, end - after)));
        }
    }
    return {};
}

std::string control_of(const fs::path& folder) { return without_comments(text_of(folder / "system" / "controlDict")); }

/// The number behind "nCells:" in the note of a mesh file's header.
std::optional<std::uint64_t> noted(const std::string& header, const std::string& what) {
    const auto at = header.find(what + ":");
    if (at == std::string::npos) {
        return {};
    }
    const std::string_view rest = core::trimmed(std::string_view(header).substr(at + what.size() + 1));
    const auto value = core::parse_integer(rest.substr(0, rest.find_first_not_of("0123456789")));
    return value ? std::optional<std::uint64_t>(static_cast<std::uint64_t>(*value)) : std::nullopt;
}

std::string head_of(const fs::path& file, std::size_t bytes) {
    std::ifstream in(file, std::ios::binary);
    std::string text(bytes, '\0');
    in.read(text.data(), static_cast<std::streamsize>(bytes));
    text.resize(static_cast<std::size_t>(in.gcount()));
    return text;
}

/// Beginning and end of a file, which may be compressed. Throws core::InputError for one that cannot be unpacked.
std::pair<std::string, std::string> ends_of(const fs::path& file) {
    constexpr std::size_t most = 8192;
    if (file.extension() != ".gz") {
        return {head_of(file, most), tail_of(file, 256)};
    }
    postproc::ByteStream in(file);
    in.ensure(most);
    std::string head(in.here(), std::min<std::size_t>(most, static_cast<std::size_t>(in.end() - in.here())));
    std::string tail;
    while (in.ensure(1)) {
        tail.append(in.here(), in.end());
        tail.erase(0, tail.size() - std::min<std::size_t>(tail.size(), 256));
        in.move_to(in.end());
    }
    return {head, tail};
}

/// What is wrong with a field's file; empty when it is whole. OpenFOAM writes a line of asterisks behind everything,
/// which a full disk or a kill leaves out; its list has one value for each cell (or each inner face).
std::string fault_of(const fs::path& file, const std::string& mesh_note) {
    const std::string name = file.filename().string();
    std::pair<std::string, std::string> ends;
    try {
        ends = ends_of(file);
    } catch (const core::InputError&) {
        return name + " cannot be unpacked";
    }
    const auto& [head, tail] = ends;
    if (!core::trimmed(tail).ends_with("* //")) {
        return name + (head.empty() ? " is empty" : " stops before its end");
    }
    const std::string kind = entry_in(head, "class");
    const std::string counted = kind.starts_with("vol")       ? "nCells"
                                : kind.starts_with("surface") ? "nInternalFaces"
                                                              : "";
    const auto wanted = counted.empty() ? std::nullopt : noted(mesh_note, counted);
    const auto inside = head.find("internalField");
    const auto list = inside == std::string::npos ? inside : head.find("nonuniform", inside);
    if (!wanted || list == std::string::npos || head.find(';', inside) < list) {
        return {};
    }
    const auto open = head.find('>', list);
    if (open == std::string::npos) {
        return {};
    }
    const std::string_view rest = core::trimmed(std::string_view(head).substr(open + 1));
    const auto count = core::parse_integer(rest.substr(0, rest.find_first_not_of("0123456789")));
    if (count && static_cast<std::uint64_t>(*count) != *wanted) {
        return name + " has " + std::to_string(*count) + " values for " + std::to_string(*wanted) +
               (counted == "nCells" ? " cells" : " inner faces");
    }
    return {};
}

fs::path log_of(const fs::path& folder, const std::string& control) {
    const std::string application = entry_in(control, "application");
    const fs::path log = folder / ("log." + application);
    std::error_code ignored;
    return !application.empty() && fs::is_regular_file(log, ignored) ? log : fs::path();
}

/// The solver's last words: "End" on a line of its own behind its last time.
bool says_end(const std::string& tail) {
    const auto end = tail.rfind("\nEnd\n");
    const auto time = tail.rfind("\nTime = ");
    return end != std::string::npos && (time == std::string::npos || end > time);
}

/// OpenFOAM removes the file that ends a run as the run ends; its log keeps that it was there.
bool ended_by_file(const std::string& tail) {
    const auto asked = tail.rfind("USER REQUESTED ABORT");
    const auto last = tail.rfind("\nTime = ");
    const auto before = last == std::string::npos || last == 0 ? last : tail.rfind("\nTime = ", last - 1);
    return asked != std::string::npos && (before == std::string::npos || asked > before);
}

/// What is wrong with the forces that should reach `time`; empty when nothing is, or none are written.
std::string fault_of_forces(const fs::path& folder, const std::string& control, double time, bool& diverged) {
    std::vector<postproc::ForceHistory> histories;
    try {
        histories = postproc::read_openfoam_forces(folder);
    } catch (const core::InputError& error) {
        const std::string words = core::lower_case(error.message());
        diverged = words.find("'nan") != std::string::npos || words.find("'-nan") != std::string::npos ||
                   words.find("inf'") != std::string::npos;
        return diverged ? "its forces are not finite: the solution diverged"
                        : std::string("its forces are cut: ") + error.what();
    }
    if (histories.empty()) {
        return solves_anew(folder) && control.find("forces") != std::string::npos
                   ? "its forces are missing (postProcessing)"
                   : "";
    }
    for (const auto& history : histories) {
        const auto& times = history.time;
        const double step = times.size() > 1 ? times.back() - times[times.size() - 2] : 0;
        const bool row_is_missing =
            step > 0 ? times.back() + step <= time * (1 + 1e-9) : times.back() < time * (1 - 1e-6);
        if (row_is_missing) {
            return "its forces '" + history.name + "' end at " + core::format_number(times.back()) +
                   ", the fields are of " + core::format_number(time);
        }
        for (const auto& force : {history.pressure_force.back(), history.viscous_force.back()}) {
            if (!std::all_of(force.begin(), force.end(), [](double x) { return std::isfinite(x); })) {
                diverged = true;
                return "its forces '" + history.name + "' are not finite: the solution diverged";
            }
        }
        for (const auto& file : history.files) {
            if (!tail_of(file, 1).ends_with('\n')) {
                return "its forces '" + history.name + "' stop within a line";
            }
        }
    }
    return {};
}

/// A kill may leave half a row at the end of a file of forces: it goes.
void drop_half_rows(const fs::path& folder) {
    std::error_code error;
    for (auto entry = fs::recursive_directory_iterator(folder / "postProcessing", error);
         !error && entry != fs::recursive_directory_iterator(); entry.increment(error)) {
        if (entry->is_regular_file(error) && entry->path().extension() == ".dat" &&
            !tail_of(entry->path(), 1).ends_with('\n')) {
            const std::string text = text_of(entry->path());
            core::write_file(entry->path(), text.substr(0, text.rfind('\n') + 1));
        }
    }
}

/// The last time that all forces reach; nothing when none are written.
std::optional<double> end_of_forces(const fs::path& folder) {
    std::optional<double> end;
    for (const auto& history : postproc::read_openfoam_forces(folder)) {
        end = std::min(end.value_or(HUGE_VAL), history.time.back());
    }
    return end;
}

bool newer(const fs::path& file, const fs::path& than) {
    std::error_code error;
    const auto a = fs::last_write_time(file, error);
    if (error) {
        return false;
    }
    const auto b = fs::last_write_time(than, error);
    return !error && a > b;
}

/// Its mesh was made and checked, of what the case holds now.
bool mesh_is_whole(const fs::path& folder) {
    const fs::path check = folder / "log.checkMesh";
    if (!says_end("\n" + tail_of(check, 4096)) || !fs::is_regular_file(folder / "constant" / "polyMesh" / "owner")) {
        return false;
    }
    std::error_code ignored;
    for (const char* name : {"blockMeshDict", "surfaceFeatureExtractDict", "snappyHexMeshDict", "meshQualityDict"}) {
        if (newer(folder / "system" / name, check)) {
            return false;
        }
    }
    for (const auto& entry : fs::directory_iterator(folder / "constant" / "triSurface", ignored)) {
        if (entry.path().extension() == ".stl" && newer(entry.path(), check)) {
            return false;
        }
    }
    return true;
}

/// Of an Allrun that Underbody wrote.
bool makes_its_mesh(const std::string& script) {
    return script.find("# Makes the mesh and runs the case. Needs OpenFOAM") != std::string::npos;
}

fs::path free_name(const fs::path& wanted) {
    fs::path name = wanted;
    for (int i = 2; fs::exists(fs::symlink_status(name)); ++i) {
        name = wanted.string() + "-" + std::to_string(i);
    }
    return name;
}

}  // namespace

std::optional<double> dictionary_number(const fs::path& dictionary, const std::string& word) {
    return core::parse_number(entry_in(without_comments(text_of(dictionary)), word));
}

std::string tail_of(const fs::path& file, long bytes) {
    std::ifstream in(file, std::ios::binary | std::ios::ate);
    if (!in) {
        return {};
    }
    const std::streamoff size = in.tellg();
    in.seekg(std::max<std::streamoff>(0, size - bytes));
    return {std::istreambuf_iterator<char>(in), {}};
}

bool solves_anew(const fs::path& folder) {
    const std::string script = text_of(folder / "Allrun");
    return makes_its_mesh(script) ||
           script.find("# Checks the mesh that is there and runs the case. Needs OpenFOAM") != std::string::npos;
}

std::vector<TimeFolder> times_of(const fs::path& case_folder) {
    std::vector<TimeFolder> times;
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(case_folder, ignored)) {
        const auto time = core::parse_number(entry.path().filename().string());
        if (time && std::isfinite(*time) && *time > 0 && entry.is_directory(ignored)) {
            times.push_back({*time, entry.path()});
        }
    }
    std::sort(times.begin(), times.end(), [](const TimeFolder& a, const TimeFolder& b) { return a.time < b.time; });
    return times;
}

std::string missing_in(const TimeFolder& time) {
    const fs::path folder = time.folder.parent_path();
    const std::string note = head_of(folder / "constant" / "polyMesh" / "owner", 2048);
    std::error_code ignored;
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(time.folder, ignored)) {
        if (entry.is_regular_file(ignored)) {
            files.push_back(entry.path());
        }
    }
    std::sort(files.begin(), files.end());
    const auto there = [&](const std::string& name) {
        return fs::exists(time.folder / name, ignored) || fs::exists(time.folder / (name + ".gz"), ignored);
    };
    if (!there("U")) {
        return "there is no U";
    }
    if (!there("p") && !there("p_rgh")) {
        return "there is no p";
    }
    if (solves_anew(folder)) {
        for (const auto& entry : fs::directory_iterator(folder / "0", ignored)) {
            if (entry.is_regular_file(ignored) && !there(entry.path().filename().string())) {
                return "there is no " + entry.path().filename().string();
            }
        }
    }
    for (const auto& file : files) {
        const std::string fault = fault_of(file, note);
        if (!fault.empty()) {
            return fault;
        }
    }
    return {};
}

SolveEnd solve_end(const fs::path& folder) {
    SolveEnd end;
    std::error_code ignored;
    if (!fs::is_directory(folder / "constant" / "polyMesh", ignored)) {
        end.why = "there is no mesh";
        return end;
    }
    const auto times = times_of(folder);
    if (times.empty()) {
        end.why = "there is no time but 0: the solver has written no solution";
        return end;
    }
    end.time = times.back().time;
    const std::string control = control_of(folder);
    const fs::path log = log_of(folder, control);
    const std::string words = log.empty() ? "" : tail_of(log, 1 << 14);
    end.settled = fs::exists(folder / settled_file, ignored) || ended_by_file(words);
    end.converged = end.settled || words.find("solution converged") != std::string::npos;
    const auto wanted = core::parse_number(entry_in(control, "endTime"));
    const std::string time = core::format_number(end.time);
    if (!end.converged && !(wanted && end.time >= *wanted * (1 - 1e-9))) {
        end.why = "its last time is " + time + (wanted ? " of " + core::format_number(*wanted) : "");
    } else if (!log.empty() && !says_end(words)) {
        end.why = "the solver was cut: " + log.filename().string() + " has no End";
    } else if (log.empty() && solves_anew(folder)) {
        end.why = "the solver's log is missing";
    } else if (const std::string fault = missing_in(times.back()); !fault.empty()) {
        end.why = "time " + time + " is not whole: " + fault;
    } else {
        end.why = fault_of_forces(folder, control, end.time, end.diverged);
    }
    end.solved = end.why.empty();
    return end;
}

std::optional<double> ready_to_go_on(const fs::path& folder) {
    const bool knows_how = text_of(folder / "Allrun").find("./Allrun solve") != std::string::npos;
    if (!knows_how || !mesh_is_whole(folder)) {
        return {};
    }
    drop_half_rows(folder);
    bool diverged = false;
    const bool readable = fault_of_forces(folder, {}, 0, diverged).empty();
    if (diverged || !readable) {
        return {};
    }
    const auto forces = end_of_forces(folder);
    auto times = times_of(folder);
    if (!forces && !times.empty() && control_of(folder).find("forces") != std::string::npos) {
        return {};  // lost, and not to be had but by solving again
    }
    while (!times.empty() &&
           ((forces && times.back().time > *forces * (1 + 1e-9)) || !missing_in(times.back()).empty())) {
        const fs::path& cut = times.back().folder;
        fs::rename(cut, free_name(folder / ("incomplete-" + cut.filename().string())));
        times.pop_back();
    }
    return times.empty() ? 0 : times.back().time;
}

bool set_results_aside(const fs::path& folder) {
    std::vector<fs::path> results;
    std::error_code ignored;
    for (const auto& time : times_of(folder)) {
        results.push_back(time.folder);
    }
    for (const auto& entry : fs::directory_iterator(folder, ignored)) {
        const std::string name = entry.path().filename().string();
        if (name.starts_with("log.") || name.starts_with("incomplete-") || name == "postProcessing" ||
            name == settled_file) {
            results.push_back(entry.path());
        }
    }
    if (results.empty()) {
        return false;
    }
    const fs::path aside = free_name(folder / "previous");
    fs::create_directory(aside);
    for (const auto& path : results) {
        fs::rename(path, aside / path.filename());
    }
    if (makes_its_mesh(text_of(folder / "Allrun")) && fs::is_directory(folder / "constant" / "polyMesh", ignored)) {
        fs::create_directory(aside / "constant");
        fs::rename(folder / "constant" / "polyMesh", aside / "constant" / "polyMesh");
    }
    return true;
}

}  // namespace underbody::cases
