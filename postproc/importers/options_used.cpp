#include "postproc/importers/options_used.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "core/text.h"
#include "core/units.h"

namespace underbody::postproc {

namespace {

constexpr std::array<std::string_view, 4> with_times = {"CGNS", "EnSight Gold", "OpenFOAM", "ParaView collection"};
constexpr std::array<std::string_view, 2> with_companion = {"Fluent legacy", "Fluent HDF5"};

template <std::size_t size>
bool is_among(const std::array<std::string_view, size>& formats, const std::string& format) {
    return std::find(formats.begin(), formats.end(), format) != formats.end();
}

void check_units(Field& field, const ReadOptions& options, const core::Place& place) {
    std::vector<std::string> asked = options.asked_units->names();
    const bool all = options.arrays.empty() && options.zones.empty();
    for (const auto& [variable, unit] : options.units) {
        const std::string key = core::lower_case(variable);
        if (std::any_of(asked.begin(), asked.end(),
                        [&](const std::string& name) { return core::lower_case(name) == key; })) {
            continue;
        }
        std::erase_if(asked, [](const std::string& name) { return name.empty(); });
        const std::string near = core::nearest_name(variable, asked);
        const std::string what = "there is no variable '" + variable + "' whose unit (" + unit + ") could be stated";
        if (all || !near.empty()) {
            std::string list;
            for (std::size_t i = 0; i < std::min<std::size_t>(asked.size(), 12); ++i) {
                list += (i > 0 ? ", '" : "'") + asked[i] + "'";
            }
            throw core::InputError(
                "missing", what, place,
                !near.empty() ? "did you mean '" + near + "'?" : "the file has " + (list.empty() ? "none" : list));
        }
        // It may be in a zone that nobody asked for.
        field.problems.push_back({core::Problem::Severity::warning, what + " in what was read of the file", place});
    }
}

void check_length_unit(Field& field, const ReadOptions& options, const core::Place& place) {
    const auto stated = std::find_if(field.metadata.begin(), field.metadata.end(),
                                     [](const auto& entry) { return entry.first == "length unit"; });
    if (options.length_unit.empty() || stated == field.metadata.end() || !core::is_unit(stated->second)) {
        return;
    }
    if (std::abs(core::conversion(options.length_unit, "m").scale / core::conversion(stated->second, "m").scale - 1) >
        1e-9) {
        field.problems.push_back({core::Problem::Severity::warning,
                                  "its lengths are in " + stated->second + ", as it says: a length unit (" +
                                      options.length_unit + ") is for files that state none, and not used",
                                  place});
    }
}

}  // namespace

void refuse_useless_options(const std::string& format, const ReadOptions& options, const core::Place& place) {
    if (!options.length_unit.empty()) {
        (void)core::conversion(options.length_unit, "m");  // also where the file says its own
    }
    if (options.time && !is_among(with_times, format)) {
        throw core::InputError(
            "option",
            "the file states no times to choose from: those of the format " + format + " are of one time each", place,
            "leave option 'time' away, or give the file of that time");
    }
    if (!options.base.empty() && format != "CGNS") {
        throw core::InputError(
            "option", "a base is asked for ('" + options.base + "'), but files of the format " + format + " have none",
            place, "bases are parts of CGNS files: leave option 'cgns-base' away");
    }
    if (!options.companion.empty() && !is_among(with_companion, format)) {
        throw core::InputError("option",
                               "a mesh beside it is given (" + options.companion.string() +
                                   "), but files of the format " + format + " have their own",
                               place, "leave option 'mesh' away");
    }
}

void check_options_used(Field& field, const ReadOptions& options, const core::Place& place) {
    check_units(field, options, place);
    check_length_unit(field, options, place);
}

}  // namespace underbody::postproc
