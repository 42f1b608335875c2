#include "postproc/field/beside.h"

#include <algorithm>
#include <memory>
#include <mutex>

#include "core/file.h"
#include "core/inputs.h"
#include "core/text.h"
#include "postproc/importers/importer.h"

namespace underbody::postproc {

namespace fs = std::filesystem;

namespace {

using Names = std::vector<std::string>;

/// Names in a folder, in their order, folders with '/' behind. Of ten thousand cases in one folder each asks for its
/// own: it is listed again only when it changed, or has changed just now.
std::shared_ptr<const Names> listing(const fs::path& folder) {
    constexpr std::int64_t calm = 3'000'000'000;  // ns
    static std::mutex mutex;
    static fs::path known_folder;
    static core::FileStamp known_stamp;
    static std::shared_ptr<const Names> known;
    const core::FileStamp stamp = core::stamp_of(folder);
    const std::lock_guard lock(mutex);
    if (known != nullptr && folder == known_folder && stamp == known_stamp &&
        core::now_in_nanoseconds() - stamp.changed > calm) {
        return known;
    }
    known = std::make_shared<const Names>(core::names_in_folder(folder, "*"));
    known_folder = folder;
    known_stamp = stamp;
    return known;
}

/// Of the files that the importers read (postproc/importers/registry.cpp).
constexpr std::string_view cfd_endings[] = {".csv", ".cas", ".dat", ".msh", ".h5",  ".case", ".encas", ".cgns",
                                            ".pvd", ".vtp", ".vtu", ".vtm", ".vtk", ".plt",  ".foam"};
constexpr std::string_view packed = ".gz";

bool is_cfd_name(const std::string& name) {
    std::string plain = name;
    if (plain.ends_with(packed)) {
        plain.resize(plain.size() - packed.size());
    }
    return std::any_of(std::begin(cfd_endings), std::end(cfd_endings),
                       [&](std::string_view ending) { return plain.ends_with(ending); });
}

fs::path folder_of(const fs::path& file) { return file.has_parent_path() ? file.parent_path() : fs::path("."); }

bool is_openfoam_case(const fs::path& folder) {
    std::error_code ignored;
    return fs::is_directory(folder / "constant" / "polyMesh", ignored) ||
           fs::is_directory(folder / "processor0" / "constant" / "polyMesh", ignored);
}

/// "simpleFoam" of "application simpleFoam;".
std::string application_of(const fs::path& folder) {
    std::error_code ignored;
    const fs::path control = folder / "system" / "controlDict";
    if (!fs::is_regular_file(control, ignored)) {
        return {};
    }
    const std::string text = core::read_file(control);
    for (const auto line : core::split(text, '\n')) {
        const auto bare = core::trimmed(line);
        if (bare.starts_with("application ")) {
            return std::string(core::trimmed(bare.substr(12, bare.find(';') - 12)));
        }
    }
    return {};
}

/// log.simpleFoam, simpleFoam.log, log: of the solver. Those of the mesher, or of the potential flow that a run began
/// with, say nothing of it.
std::vector<fs::path> logs_of(const fs::path& folder) {
    core::note_names(folder, "*log*");
    const std::string application = application_of(folder);
    std::vector<fs::path> logs;
    for (const auto& name : *listing(folder)) {
        if (!application.empty() && (name == "log." + application || name == application + ".log")) {
            return {folder / name};
        }
        const bool log = name == "log" || name.starts_with("log.") || name.ends_with(".log");
        const bool solver = name == "log" ||
                            (name.find("Foam") != std::string::npos && name.find("potentialFoam") == std::string::npos);
        if (log && solver) {
            logs.push_back(folder / name);
        }
    }
    return logs;
}

bool is_history(const std::string& ending) {
    return ending == ".out" || ending == ".trn" || ending == ".log" || ending == ".txt";
}

}  // namespace

std::string case_stem(const fs::path& file) {
    std::string stem = (file.has_filename() ? file : file.parent_path()).filename().string();
    for (bool cut = true; cut;) {
        cut = false;
        const auto without = [&](std::string_view ending) {
            if (stem.size() > ending.size() && stem.ends_with(ending)) {
                stem.resize(stem.size() - ending.size());
                cut = true;
            }
        };
        without(packed);
        std::for_each(std::begin(cfd_endings), std::end(cfd_endings), without);
    }
    return stem;
}

bool named_after(const std::string& name, const std::string& stem) {
    return name.size() > stem.size() && name.starts_with(stem) &&
           std::string_view("._-").find(name[stem.size()]) != std::string_view::npos;
}

std::vector<fs::path> files_named_after(const fs::path& file) {
    const std::string stem = case_stem(file);
    core::note_names(folder_of(file), stem + "*");
    const auto names = listing(folder_of(file));
    std::vector<fs::path> found;
    for (auto name = std::lower_bound(names->begin(), names->end(), stem);
         name != names->end() && name->starts_with(stem); ++name) {
        if (named_after(*name, stem) && name->back() != '/' && *name != file.filename().string()) {
            found.push_back(file.has_parent_path() ? file.parent_path() / *name : fs::path(*name));
        }
    }
    return found;
}

std::vector<fs::path> histories_beside(const fs::path& file) {
    std::error_code ignored;
    fs::path folder = fs::is_directory(file, ignored) ? file : folder_of(file);
    if (file.filename() == "controlDict") {
        folder = folder.parent_path().empty() ? folder / ".." : folder.parent_path();
    }
    if (is_openfoam_case(folder)) {
        return logs_of(folder);
    }
    std::vector<fs::path> found;
    if (fs::is_directory(file, ignored)) {
        return found;
    }
    std::vector<std::string> others;  // longer stems: "case-coarse" beside "case"
    const std::string stem = case_stem(file);
    const auto named = files_named_after(file);
    for (const auto& other : named) {
        const std::string name = other.filename().string();
        if (is_cfd_name(name) && !is_history(other.extension().string()) && case_stem(other) != stem) {
            others.push_back(case_stem(other));
        }
    }
    for (const auto& text : named) {
        const std::string name = text.filename().string();
        const bool of_another = std::any_of(others.begin(), others.end(),
                                            [&](const std::string& other) { return named_after(name, other); });
        if (is_history(text.extension().string()) && !of_another) {
            found.push_back(text);
        }
    }
    constexpr std::size_t most = 64;  // files of a folder that is one case's
    const auto names = listing(folder);
    const bool alone = std::none_of(names->begin(), names->end(), [&](const std::string& name) {
        return is_cfd_name(name) && case_stem(name) != stem;
    });
    if (alone) {
        core::note_names(folder, "*.out");
        core::note_names(folder, "*.trn");
    }
    for (std::size_t i = 0; alone && i < names->size(); ++i) {
        const std::string& name = (*names)[i];
        const bool of_case = name.ends_with(".out") || name.ends_with(".trn");
        const fs::path path = file.has_parent_path() ? file.parent_path() / name : fs::path(name);
        if (of_case && found.size() < most && std::find(found.begin(), found.end(), path) == found.end()) {
            found.push_back(path);
        }
    }
    return found;
}

}  // namespace underbody::postproc
