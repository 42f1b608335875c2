#include "postproc/stated_loads.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <regex>

#include "core/file.h"
#include "core/text.h"
#include "core/units.h"
#include "postproc/importers/cfx_output.h"
#include "postproc/importers/openfoam_forces.h"
#include "postproc/importers/reports.h"
#include "postproc/vector_math.h"

namespace underbody::postproc {

namespace {

namespace fs = std::filesystem;
using core::InputError;

std::string shown(const Vector& v) {
    return "(" + core::format_number(v[0], 4) + ", " + core::format_number(v[1], 4) + ", " + core::format_number(v[2], 4) + ")";
}

/// The six named loads as force or moment along an axis of the file.
struct NamedAxis {
    std::string name;
    bool moment;
    Vector direction;
};

std::vector<NamedAxis> named_axes(const LoadsResult& result) {
    const Vector astern = {-result.forward[0], -result.forward[1], -result.forward[2]};
    const Vector down = {-result.up[0], -result.up[1], -result.up[2]};
    return {{"lift_force", false, result.up},           {"drag_force", false, astern},        {"side_force", false, result.starboard},
            {"pitch_moment", true, result.starboard}, {"roll_moment", true, result.forward}, {"yaw_moment", true, down}};
}

std::vector<std::string> named_loads() { return {"lift_force", "drag_force", "side_force", "pitch_moment", "roll_moment", "yaw_moment"}; }

// ---- reading ----

std::string described(bool moment, const Vector& direction, const Vector& centre) {
    return moment ? "moment about " + shown(direction) + " at " + shown(centre) + " m" : "force along " + shown(direction);
}

void add_row(std::vector<StatedLoad>& loads, const StatedLoad& like, const ReportedForce& row) {
    for (const auto& [part, value] : {std::pair{LoadPart::total, row.total}, {LoadPart::pressure, row.pressure}, {LoadPart::viscous, row.viscous}}) {
        loads.push_back(like);
        loads.back().part = part;
        loads.back().value = value;
    }
}

bool same_quantity(const StatedLoad& a, const StatedLoad& b) {
    return a.moment == b.moment && a.part == b.part && a.direction == b.direction && a.centre == b.centre && a.zones == b.zones;
}

/// A transcript reports the same thing again and again while the solver runs: the last of each, which is that of the field.
std::vector<StatedLoad> last_of_each(const std::vector<StatedLoad>& loads) {
    std::vector<StatedLoad> last;
    for (const auto& load : loads) {
        const auto before = std::find_if(last.begin(), last.end(), [&](const StatedLoad& other) { return same_quantity(other, load); });
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
            throw InputError("format", "a report of forces without a direction", {path.string(), {}, {}, {}}, "'Forces - Direction Vector (1 0 0)' is what is known");
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

MonitorSource monitor_source(const std::string& text) {
    const char* example = "for instance --monitor lift_force=lift-rfile.out, or \"drag_force [N]=report.out:drag\"";
    const auto equals = text.find('=');
    if (equals == std::string::npos || equals + 1 == text.size()) {
        throw core::UsageError("usage", "'" + text + "' is no QUANTITY=FILE", {}, example);
    }
    MonitorSource source;
    std::string head(core::trimmed(std::string_view(text).substr(0, equals)));
    if (const auto open = head.find('['); open != std::string::npos) {
        if (head.back() != ']') {
            throw core::UsageError("usage", "'" + head + "': the bracket of the unit is not closed", {}, example);
        }
        source.unit = std::string(core::trimmed(std::string_view(head).substr(open + 1, head.size() - open - 2)));
        head = std::string(core::trimmed(std::string_view(head).substr(0, open)));
        if (const auto number = source.unit.find_first_not_of("+-.0123456789eE"); number != 0 && number != std::string::npos && source.unit[number] == ' ') {
            const core::Quantity scaled = core::parse_quantity(source.unit);
            source.scale = scaled.value;
            source.unit = scaled.unit;
        }
    }
    source.quantity = head;
    const auto names = named_loads();
    if (std::find(names.begin(), names.end(), head) == names.end()) {
        throw core::UsageError("usage", "'" + head + "' is no load that a monitor can give", {}, core::did_you_mean(head, names));
    }
    const std::string si = core::find_quantity(head)->unit;
    if (!source.unit.empty() && (!core::is_unit(source.unit) || !core::same_dimension(source.unit, si))) {
        throw core::UsageError("unit", "'" + source.unit + "' is no unit of " + head, {}, "it is measured in " + si);
    }
    source.file = text.substr(equals + 1);
    // FILE:COLUMN, unless the whole is a file.
    if (const auto colon = source.file.rfind(':'); colon != std::string::npos && !fs::exists(source.file)) {
        source.column = source.file.substr(colon + 1);
        source.file.resize(colon);
    }
    return source;
}

StatedLoad stated_by_monitor(const MonitorSource& source, const LoadsResult& result) {
    const Monitor monitor = read_monitor(source.file);
    std::string column = source.column;
    if (column.empty()) {
        std::vector<std::string> candidates(monitor.columns.begin() + 1, monitor.columns.end());
        std::erase_if(candidates, [](const std::string& name) { return core::lower_case(name) == "flow-time" || core::lower_case(name) == "delta-time"; });
        if (candidates.size() != 1) {
            throw InputError("missing", "the monitor has several columns: which one is " + source.quantity + "?", {monitor.file, {}, {}, {}},
                             core::did_you_mean("", candidates) + "; say --monitor " + source.quantity + "=" + source.file + ":COLUMN");
        }
        column = candidates.front();
    }
    const auto* values = monitor.find(column);
    if (values == nullptr) {
        throw InputError("missing", "the monitor has no column '" + column + "'", {monitor.file, {}, {}, {}}, core::did_you_mean(column, monitor.columns));
    }
    std::vector<double> history = *values;
    if (!source.unit.empty()) {
        const auto to_si = core::conversion(source.unit, core::find_quantity(source.quantity)->unit);
        std::transform(history.begin(), history.end(), history.begin(), [&](double value) { return to_si(source.scale * value); });
    }
    StatedLoad load;
    load.file = monitor.file;
    load.quantity = source.quantity;
    const auto axes = named_axes(result);
    const auto& axis = *std::find_if(axes.begin(), axes.end(), [&](const NamedAxis& a) { return a.name == source.quantity; });
    load.moment = axis.moment;
    load.direction = axis.direction;
    load.centre = result.reference;
    try {
        load.history = iteration_scatter(history);
    } catch (const InputError& error) {
        throw InputError(error.kind(), "column '" + column + "': " + error.message(), {monitor.file, {}, {}, {}}, error.hint());
    }
    load.value = history.back();
    return load;
}

namespace {

/// The integrated zones that OpenFOAM's list of patches (names and regular expressions) means; its own words when none.
std::vector<std::string> zones_of(const std::vector<std::string>& patches, const LoadsResult& result) {
    std::vector<std::string> zones;
    for (const auto& zone : result.zones) {
        for (const auto& patch : patches) {
            bool fits = patch == zone.name;
            try {
                fits = fits || std::regex_match(zone.name, std::regex(patch));
            } catch (const std::regex_error&) {
                // no expression: a plain name
            }
            if (fits && std::find(zones.begin(), zones.end(), zone.name) == zones.end()) {
                zones.push_back(zone.name);
            }
        }
    }
    return zones.empty() ? patches : zones;
}

/// The row of the field's time, or the nearest; the last where the field has no time.
std::size_t row_of(const ForceHistory& history, const LoadsResult& result) {
    if (!result.time) {
        return history.time.size() - 1;
    }
    const auto nearest = std::min_element(history.time.begin(), history.time.end(), [&](double a, double b) { return std::abs(a - *result.time) < std::abs(b - *result.time); });
    return static_cast<std::size_t>(nearest - history.time.begin());
}

/// One named load out of a history; moments about the reference point of `result`.
StatedLoad from_history(const ForceHistory& history, const NamedAxis& axis, LoadPart part, const LoadsResult& result) {
    const std::size_t count = row_of(history, result) + 1;  // what came later is not of this field
    std::vector<double> values(count, 0);
    const Vector arm = plus(history.centre, result.reference, -1);
    for (std::size_t i = 0; i < count; ++i) {
        const auto take = [&](const Vector& force, const std::vector<ForceHistory::Triple>& moments) {
            values[i] += axis.moment ? dot(plus(moments[i], cross(arm, force)), axis.direction) : dot(force, axis.direction);
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
    if (part == LoadPart::total && count >= 8) {
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
    return any_line(text, [](std::string_view line) { return line.starts_with("Forces - ") || line.starts_with("Moments - "); });
}

std::vector<fs::path> reports_beside(const fs::path& file) {
    const std::string stem = case_stem(file);
    std::vector<fs::path> reports;
    std::error_code ignored;
    const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
    for (const auto& entry : fs::directory_iterator(folder, ignored)) {
        const std::string name = entry.path().filename().string();
        const std::string ending = entry.path().extension().string();
        const bool named_after = name.size() > stem.size() && name.starts_with(stem) && std::string_view("._-").find(name[stem.size()]) != std::string_view::npos;
        const bool text = ending == ".txt" || ending == ".out" || ending == ".frp" || ending == ".report" || ending == ".log" || ending == ".trn";
        if (named_after && text && entry.is_regular_file() && holds_report(entry.path())) {
            reports.push_back(file.has_parent_path() ? entry.path() : entry.path().filename());
        }
    }
    std::sort(reports.begin(), reports.end());
    return reports;
}

}  // namespace

std::string case_stem(const fs::path& file) {
    std::string stem = (file.has_filename() ? file : file.parent_path()).filename().string();
    for (bool cut = true; cut;) {
        cut = false;
        for (const std::string_view ending : {".gz", ".csv", ".cas", ".dat", ".msh", ".h5", ".case", ".encas", ".cgns", ".vtp", ".vtu", ".vtm", ".foam"}) {
            if (stem.size() > ending.size() && stem.ends_with(ending)) {
                stem.resize(stem.size() - ending.size());
                cut = true;
            }
        }
    }
    return stem;
}

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
    if (fs::is_directory(folder / "postProcessing", ignored) && fs::is_directory(folder / "constant" / "polyMesh", ignored)) {
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

// ---- comparing ----

namespace {

struct Covered {
    Wrench total, pressure, viscous;
    double area = 0;
    std::string missing;  ///< a zone that is not there
};

void add_to(Wrench& sum, const Wrench& more) { sum = {plus(sum.force, more.force), plus(sum.moment, more.moment)}; }

Covered covered_by(const LoadsResult& result, const std::vector<std::string>& zones) {
    if (zones.empty()) {
        return {result.total, result.pressure, result.viscous, result.area, {}};
    }
    Covered sum;
    for (const auto& name : zones) {
        const auto zone = std::find_if(result.zones.begin(), result.zones.end(), [&](const ZoneLoads& z) { return core::lower_case(z.name) == core::lower_case(name); });
        if (zone == result.zones.end()) {
            sum.missing = name;
            return sum;
        }
        add_to(sum.pressure, zone->pressure);
        add_to(sum.viscous, zone->viscous);
        sum.area += zone->area;
    }
    add_to(sum.total, sum.pressure);
    add_to(sum.total, sum.viscous);
    return sum;
}

/// Both halves of a body cancel this quantity, or one half's number says nothing about it.
bool cancelled_by_symmetry(const LoadsResult& result, const StatedLoad& load) {
    if (result.mirror_axis < 0) {
        return false;
    }
    const double along = std::abs(load.direction[static_cast<std::size_t>(result.mirror_axis)]);
    return load.moment ? along < 1 - 1e-6 : along > 1e-6;
}

std::string label(const LoadsResult& result, const StatedLoad& load) {
    std::string text = load.quantity;
    for (const auto& axis : named_axes(result)) {
        const bool here = !load.moment || norm(plus(load.centre, result.reference, -1)) < 1e-9 + 1e-6 * std::sqrt(result.area);
        if (axis.moment == load.moment && here && dot(axis.direction, load.direction) > 1 - 1e-9) {
            text = axis.name;
        }
    }
    text = load.part == LoadPart::pressure ? "pressure part of " + text : load.part == LoadPart::viscous ? "viscous part of " + text : text;
    if (!load.zones.empty() && load.zones.size() < result.zones.size()) {
        text += " on";
        for (const auto& zone : load.zones) {
            text += " '" + zone + "'";
        }
    }
    return text;
}

/// A report of another time than the field's: OpenFOAM writes times with six digits unless told otherwise.
bool of_another_time(const LoadsResult& result, const StatedLoad& load) {
    constexpr double written = 1e-5;
    return result.time && load.time && std::abs(*load.time - *result.time) > written * std::max(std::abs(*load.time), std::abs(*result.time));
}

/// What is no more than this share of a force is nothing beside it: symmetry leaves such rests, which never settle.
constexpr double rounding = 1e-9;

/// The largest component of the whole force that the same file states of the same zones.
double largest_stated_force(const std::vector<StatedLoad>& stated, const StatedLoad& like) {
    double largest = 0;
    for (const auto& load : stated) {
        if (!load.moment && load.part == LoadPart::total && load.file == like.file && load.zones == like.zones) {
            largest = std::max(largest, std::abs(load.value));
        }
    }
    return largest;
}

}  // namespace

double share_of(double difference, double force, double fallback) {
    const double scale = force > 0 ? force : fallback;
    return scale > 0 ? std::abs(difference) / scale : 0;
}

std::vector<Comparison> compare_with_solver(const LoadsResult& result, const std::vector<StatedLoad>& stated, core::Problems& notes) {
    std::vector<Comparison> comparisons;
    std::vector<std::string> missing;
    std::vector<std::string> of_other_times;
    std::vector<std::string> of_unknown_zones;
    std::vector<std::string> repeated;
    const double halves = result.mirror_axis >= 0 ? 2 : 1;
    std::size_t cancelled = 0;
    for (const auto& load : stated) {
        if (cancelled_by_symmetry(result, load)) {
            ++cancelled;
            continue;
        }
        if (load.earlier > 0 && std::find(repeated.begin(), repeated.end(), load.file) == repeated.end()) {
            repeated.push_back(load.file);
            notes.push_back({core::Problem::Severity::note, std::to_string(load.earlier + 1) + " reports of the " + load.quantity + ": the last of each quantity is compared", {load.file, {}, {}, {}}});
        }
        if (load.zones_unknown && std::find(of_unknown_zones.begin(), of_unknown_zones.end(), load.file) == of_unknown_zones.end()) {
            of_unknown_zones.push_back(load.file);
            notes.push_back({core::Problem::Severity::warning,
                             "system/controlDict does not say which patches these forces are of: compared with those on all zones summed",
                             {load.file, {}, {}, {}}});
        }
        const Covered body = covered_by(result, load.zones);
        if (!body.missing.empty()) {
            if (std::find(missing.begin(), missing.end(), body.missing) == missing.end()) {
                missing.push_back(body.missing);
                notes.push_back({core::Problem::Severity::warning, "the report's zone '" + body.missing + "' is not among those integrated: its rows are not compared", {load.file, {}, {}, {}}});
            }
            continue;
        }
        if (of_another_time(result, load) && std::find(of_other_times.begin(), of_other_times.end(), load.file) == of_other_times.end()) {
            of_other_times.push_back(load.file);
            notes.push_back({core::Problem::Severity::warning, "there is no row of the field's time " + core::format_number(*result.time, 9) + ": the field is compared with the row of " +
                                                                   core::format_number(*load.time, 9), {load.file, {}, {}, {}}});
        }
        const Wrench& wrench = load.part == LoadPart::pressure ? body.pressure : load.part == LoadPart::viscous ? body.viscous : body.total;
        const Vector moment = plus(wrench.moment, cross(plus(result.reference, load.centre, -1), wrench.force));
        Comparison one;
        one.file = result.file;
        one.quantity = label(result, load);
        one.stated_in = load.file;
        one.value = dot(load.moment ? moment : wrench.force, load.direction);
        one.stated = halves * load.value;
        const double own = norm(body.total.force);
        const double theirs = halves * largest_stated_force(stated, load);
        const double force = own > rounding * theirs ? own : theirs;  // nought is no measure
        one.of_force = share_of(one.value - one.stated, force * (load.moment ? std::sqrt(body.area) : 1), std::max(std::abs(one.value), std::abs(one.stated)));
        comparisons.push_back(std::move(one));
    }
    if (result.mirror_axis >= 0 && !stated.empty()) {
        notes.push_back({core::Problem::Severity::note, "a half model: the solver's numbers are doubled" +
                                                            (cancelled > 0 ? ", and " + std::to_string(cancelled) + " that both halves cancel are left out" : std::string()), {}});
    }
    return comparisons;
}

void to_json(nlohmann::json& json, const Comparison& c) {
    json = {{"quantity", c.quantity}, {"value", c.value}, {"stated", c.stated}, {"difference", c.value - c.stated}, {"of_force", c.of_force}};
    if (!c.stated_in.empty()) {
        json["stated_in"] = c.stated_in;
    }
}

core::Problems unsettled(const LoadsResult& result, const std::vector<StatedLoad>& stated) {
    core::Problems problems;
    for (const auto& load : stated) {
        if (!load.history || load.part != LoadPart::total || load.history->settled) {
            continue;
        }
        const Covered body = covered_by(result, load.zones);
        const double force = std::max(norm(body.total.force), largest_stated_force(stated, load)) * (load.moment ? std::sqrt(body.area) : 1);
        if (std::abs(load.history->mean) + load.history->deviation + std::abs(load.history->drift) > rounding * force) {
            problems.push_back({core::Problem::Severity::warning, load.quantity + " has not settled: " + load.history->text, {load.file, {}, {}, {}}});
        }
    }
    return problems;
}

std::vector<std::pair<std::string, double>> iteration_sigmas(const LoadsResult& result, const std::vector<StatedLoad>& stated) {
    std::vector<std::pair<std::string, double>> sigmas;
    for (const auto& load : stated) {
        if (!load.history || load.part != LoadPart::total || cancelled_by_symmetry(result, load)) {
            continue;
        }
        if (!load.zones.empty() && load.zones.size() < result.zones.size()) {
            continue;  // not the whole body
        }
        const double sigma = (result.mirror_axis >= 0 ? 2 : 1) * load.history->standard_uncertainty;
        const auto found = std::find_if(sigmas.begin(), sigmas.end(), [&](const auto& entry) { return entry.first == load.quantity; });
        if (found == sigmas.end()) {
            sigmas.emplace_back(load.quantity, sigma);
        } else {
            found->second = sigma;  // what the user named counts over what lies beside
        }
    }
    return sigmas;
}

}  // namespace underbody::postproc
