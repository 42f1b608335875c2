#include "postproc/loads/stated_loads.h"

#include <algorithm>

#include "core/file.h"
#include "core/text.h"
#include "postproc/field/beside.h"
#include "postproc/field/vector_math.h"
#include "postproc/importers/importer.h"
#include "postproc/importers/openfoam/openfoam_keys.h"
#include "postproc/importers/reports/cfx_output.h"
#include "postproc/importers/reports/openfoam_forces.h"
#include "postproc/importers/reports/reports.h"
#include "postproc/loads/stated_parts.h"

namespace underbody::postproc {

namespace {

namespace fs = std::filesystem;
using core::InputError;

std::string shown(const Vector& v) {
    return "(" + core::format_number(v[0], 4) + ", " + core::format_number(v[1], 4) + ", " +
           core::format_number(v[2], 4) + ")";
}

std::string described(bool moment, const Vector& direction, const Vector& centre) {
    return moment ? "moment about " + shown(direction) + " at " + shown(centre) + " m"
                  : "force along " + shown(direction);
}

void add_row(std::vector<StatedLoad>& loads, const StatedLoad& like, const ReportedForce& row) {
    for (const auto& [part, value] : {std::pair{LoadPart::total, row.total},
                                      {LoadPart::pressure, row.pressure},
                                      {LoadPart::viscous, row.viscous}}) {
        loads.push_back(like);
        loads.back().part = part;
        loads.back().value = value;
    }
}

bool same_quantity(const StatedLoad& a, const StatedLoad& b) {
    return a.moment == b.moment && a.part == b.part && a.direction == b.direction && a.centre == b.centre &&
           a.zones == b.zones;
}

/// A transcript reports the same thing again and again while the solver runs: the last of each, which is that of the
/// field.
std::vector<StatedLoad> last_of_each(const std::vector<StatedLoad>& loads) {
    std::vector<StatedLoad> last;
    for (const auto& load : loads) {
        const auto before =
            std::find_if(last.begin(), last.end(), [&](const StatedLoad& other) { return same_quantity(other, load); });
        if (before == last.end()) {
            last.push_back(load);
            continue;
        }
        const std::size_t earlier = before->earlier + 1;
        *before = load;
        before->earlier = earlier;
    }
    return last;
}

}  // namespace

std::vector<StatedLoad> stated_in_report(const fs::path& path) {
    std::vector<StatedLoad> loads;
    for (const auto& report : read_force_reports(path)) {
        const double size = norm(report.direction);
        if (!(size > 0)) {
            throw InputError("format", "a report of forces without a direction", {path.string(), {}, {}, {}},
                             "'Forces - Direction Vector (1 0 0)' is what is known");
        }
        StatedLoad like;
        like.file = path.string();
        like.moment = report.moments;
        like.direction = {report.direction[0] / size, report.direction[1] / size, report.direction[2] / size};
        like.centre = report.centre;
        like.quantity = described(like.moment, like.direction, like.centre);
        std::vector<std::string> covered;
        for (const auto& row : report.rows) {
            if (row.zone != "Net") {
                covered.push_back(row.zone);
                like.zones = {row.zone};
                add_row(loads, like, row);
            }
        }
        if (const auto* net = report.net(); net != nullptr && covered.size() != 1) {
            like.zones = covered;
            add_row(loads, like, *net);
        }
    }
    return last_of_each(loads);
}

namespace {

/// The integrated zones that OpenFOAM's list of patches (names and regular expressions) means; its own words when none.
std::vector<std::string> zones_of(const std::vector<std::string>& patches, const LoadsResult& result) {
    std::vector<std::string> zones;
    const auto fits_expression = [](const std::string& patch, const std::string& name) {
        try {
            return FoamKey(patch, true).fits(name);
        } catch (const InputError&) {
            return false;  // no expression: a plain name
        }
    };
    for (const auto& zone : result.zones) {
        for (const auto& patch : patches) {
            const bool fits = patch == zone.name || fits_expression(patch, zone.name);
            if (fits && std::find(zones.begin(), zones.end(), zone.name) == zones.end()) {
                zones.push_back(zone.name);
            }
        }
    }
    return zones.empty() ? patches : zones;
}

/// The row of the field's time, or the nearest; the last where the field has no time.
std::size_t row_of(const ForceHistory& history, const LoadsResult& result) {
    return result.time ? nearest_row(history.time, *result.time) : history.time.size() - 1;
}

/// One named load out of a history; moments about the reference point of `result`.
StatedLoad from_history(const ForceHistory& history, const NamedAxis& axis, LoadPart part, const LoadsResult& result) {
    const std::size_t count = row_of(history, result) + 1;  // what came later is not of this field
    std::vector<double> values(count, 0);
    const Vector arm = plus(history.centre, result.reference, -1);
    for (std::size_t i = 0; i < count; ++i) {
        const auto take = [&](const Vector& force, const std::vector<ForceHistory::Triple>& moments) {
            values[i] +=
                axis.moment ? dot(plus(moments[i], cross(arm, force)), axis.direction) : dot(force, axis.direction);
        };
        if (part != LoadPart::viscous) {
            take(history.pressure_force[i], history.pressure_moment);
        }
        if (part != LoadPart::pressure) {
            take(history.viscous_force[i], history.viscous_moment);
        }
    }
    StatedLoad load;
    load.file = history.files.front();
    load.quantity = axis.name;
    load.zones = zones_of(history.patches, result);
    load.zones_unknown = history.patches.empty();
    load.part = part;
    load.moment = axis.moment;
    load.direction = axis.direction;
    load.centre = result.reference;
    load.value = values.back();
    load.time = history.time[count - 1];
    if (part == LoadPart::total && count >= shortest_history) {
        load.history = iteration_scatter(values);
    }
    return load;
}

/// Line by line, without blanks at its ends, until `fits` says yes.
template <typename Fits>
bool any_line(std::string_view text, Fits&& fits) {
    while (!text.empty()) {
        const auto end = std::min(text.find('\n'), text.size());
        if (fits(core::trimmed(text.substr(0, end)))) {
            return true;
        }
        text.remove_prefix(std::min(end + 1, text.size()));
    }
    return false;
}

/// A text beside a CFD file that holds a force report.
bool holds_report(const fs::path& path) {
    std::error_code ignored;
    constexpr std::uintmax_t most = 1 << 28;
    const auto size = fs::file_size(path, ignored);
    if (ignored || size == 0 || size > most) {
        return false;
    }
    const core::MappedFile mapped(path);
    const std::string_view text = mapped.bytes();
    if (text.find('\0') != std::string_view::npos) {
        return false;
    }
    if (has_cfx_forces(text)) {
        return true;
    }
    return any_line(
        text, [](std::string_view line) { return line.starts_with("Forces - ") || line.starts_with("Moments - "); });
}

bool is_text_ending(const std::string& ending) {
    return ending == ".txt" || ending == ".out" || ending == ".frp" || ending == ".report" || ending == ".log" ||
           ending == ".trn";
}

/// Reports are those of the CFD file with the longest stem that fits: "case-coarse.txt" is of case-coarse.csv, not of
/// case.csv.
std::vector<fs::path> reports_beside(const fs::path& file) {
    const std::string stem = case_stem(file);
    std::vector<fs::path> reports;
    std::vector<fs::path> others;  // CFD files with a longer stem
    for (const auto& path : files_named_after(file)) {
        const std::string other = case_stem(path);
        if (is_text_ending(path.extension().string())) {
            reports.push_back(path);
        } else if (other != path.filename().string() && named_after(other, stem)) {
            others.push_back(path);
        }
    }
    std::erase_if(reports, [&](const fs::path& report) {
        const bool of_another = std::any_of(others.begin(), others.end(), [&](const fs::path& other) {
            return named_after(report.filename().string(), case_stem(other)) && importer_for(other) != nullptr;
        });
        return of_another || !holds_report(report);
    });
    std::sort(reports.begin(), reports.end());
    return reports;
}

}  // namespace

std::vector<StatedLoad> stated_by_openfoam(const fs::path& case_folder, const LoadsResult& result) {
    std::vector<StatedLoad> loads;
    for (const auto& history : read_openfoam_forces(case_folder)) {
        for (const auto& axis : named_axes(result)) {
            if (axis.moment && history.pressure_moment.empty()) {
                continue;
            }
            for (const LoadPart part : {LoadPart::total, LoadPart::pressure, LoadPart::viscous}) {
                loads.push_back(from_history(history, axis, part, result));
            }
        }
    }
    return loads;
}

std::vector<StatedLoad> stated_beside(const fs::path& file, const LoadsResult& result) {
    std::error_code ignored;
    fs::path folder = fs::is_directory(file, ignored) ? file : file.parent_path();
    if (file.filename() == "controlDict") {
        folder = folder.parent_path();
    }
    if (fs::is_directory(folder / "postProcessing", ignored) &&
        fs::is_directory(folder / "constant" / "polyMesh", ignored)) {
        return stated_by_openfoam(folder, result);
    }
    std::vector<StatedLoad> loads;
    if (!fs::is_directory(file, ignored)) {
        for (const auto& report : reports_beside(file)) {
            const auto more = stated_in_report(report);
            loads.insert(loads.end(), more.begin(), more.end());
        }
    }
    return loads;
}

}  // namespace underbody::postproc
