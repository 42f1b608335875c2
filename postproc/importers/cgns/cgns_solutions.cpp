// Grids and solutions of a zone.
#include <cgnslib.h>

#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "postproc/importers/cgns/cgns_file.h"
#include "postproc/importers/import_context.h"
#include "postproc/importers/mesh/variable_reading.h"

namespace underbody::postproc {

/// An array at the library's place with one value a node, without the rind round them.
void CgnsFile::read_nodes(const CgnsZone& zone, int array, Buffer<double>& column) const {
    std::array<char, 33> name{};
    CGNS_ENUMT(DataType_t) type{};
    int dimensions = 0;
    std::array<cgsize_t, 12> sizes{};
    ok(zone, cg_array_info(array, name.data(), &type, &dimensions, sizes.data()), "coordinate");
    std::array<int, 6> rind{};
    if (cg_rind_read(rind.data()) != CG_OK) {
        rind = {};
    }
    std::array<std::int64_t, 3> all = {1, 1, 1};
    std::array<std::int64_t, 3> before{};
    const int indices = zone.structured ? cell_dimension_ : 1;
    bool fits = dimensions == indices;
    double count = 1;
    for (int d = 0; d < indices; ++d) {
        const auto k = static_cast<std::size_t>(d);
        before[k] = rind[2 * k];
        all[k] = zone.nodes[k] + rind[2 * k] + rind[2 * k + 1];
        fits = fits && rind[2 * k] >= 0 && rind[2 * k + 1] >= 0 && sizes[k] == all[k];
        count *= static_cast<double>(all[k]);
    }
    if (!fits) {
        fail(zone, "its coordinates are not as many as its nodes");
    }
    check_room(zone, count);
    if (count == static_cast<double>(column.size())) {
        ok(zone, cg_array_read_as(array, CGNS_ENUMV(RealDouble), column.data()), "coordinates");
        return;
    }
    Buffer<double> whole(static_cast<std::size_t>(count));
    ok(zone, cg_array_read_as(array, CGNS_ENUMV(RealDouble), whole.data()), "coordinates");
    std::size_t at = 0;
    for (std::int64_t k = 0; k < zone.nodes[2]; ++k) {
        for (std::int64_t j = 0; j < zone.nodes[1]; ++j) {
            for (std::int64_t i = 0; i < zone.nodes[0]; ++i) {
                column[at++] = whole[static_cast<std::size_t>(((k + before[2]) * all[1] + j + before[1]) * all[0] + i +
                                                              before[0])];
            }
        }
    }
}

Buffer<double> CgnsFile::points(const CgnsZone& zone, const std::string& length_unit) {
    const double count =
        static_cast<double>(zone.nodes[0]) * static_cast<double>(zone.nodes[1]) * static_cast<double>(zone.nodes[2]);
    check_room(zone, count);
    if (count < 1 || count > 2147483647.0) {
        fail(zone, "it has " + core::format_number(count) + " nodes");
    }
    const auto nodes = static_cast<std::size_t>(count);
    const int grid = grid_of_step(zone);
    const auto go = [&] { return cg_goto(file_, base_, "Zone_t", zone.index, "GridCoordinates_t", grid, "end"); };
    int coordinates = 0;
    ok(zone, go(), "grid");
    ok(zone, cg_narrays(&coordinates), "coordinates");
    Buffer<double> points(3 * nodes);
    points.fill(0);
    Buffer<double> column(nodes);
    std::array<bool, 3> read{};
    for (int c = 1; c <= coordinates; ++c) {
        std::array<char, 33> coordinate{};
        CGNS_ENUMT(DataType_t) type{};
        int dimensions = 0;
        std::array<cgsize_t, 12> sizes{};
        ok(zone, go(), "grid");
        ok(zone, cg_array_info(c, coordinate.data(), &type, &dimensions, sizes.data()), "coordinate");
        const std::string_view word(coordinate.data());
        const int axis = word.starts_with("Coordinate") && word.size() == 11 ? word[10] - 'X' : -1;
        if (axis < 0 || axis > 2) {
            fail(zone, "coordinates '" + std::string(word) + "' are not read (cylindrical and others)");
        }
        read_nodes(zone, c, column);
        read[static_cast<std::size_t>(axis)] = true;
        const core::Conversion stated =
            to_si({{"Zone_t", zone.index}, {"GridCoordinates_t", grid}, {"DataArray_t", c}}, coordinate.data(), "m");
        const core::Conversion convert =
            length_unit.empty() || units_stated_ ? stated : core::conversion(length_unit, "m");
        for (std::size_t i = 0; i < nodes; ++i) {
            if (!std::isfinite(column[i])) {
                fail(zone, "a coordinate that is not a number");
            }
            points[3 * i + static_cast<std::size_t>(axis)] = convert(column[i]);
        }
    }
    for (int axis = 0; axis < std::min(3, physical_dimension_); ++axis) {
        if (!read[static_cast<std::size_t>(axis)]) {
            fail(zone, "it has no Coordinate" + std::string(1, static_cast<char>('X' + axis)));
        }
    }
    return points;
}

/// Which field of which solution is read for a variable.
struct CgnsFile::Choice {
    int solution = 0;
    int field = 0;
    std::string variable;
    std::string solution_name;
    bool nodal = true;
    bool of_step = false;         ///< the zone says that it is of the step
    bool one_of_several = false;  ///< that hold the variable, of which the zone says nothing
};

/// The zone's words for the step decide, else the last solution that holds a variable.
void CgnsFile::choose(std::vector<Choice>& choices, Choice&& found) {
    const auto before = std::find_if(choices.begin(), choices.end(), [&](const Choice& c) {
        return c.variable == found.variable && c.nodal == found.nodal;
    });
    if (before == choices.end()) {
        choices.push_back(std::move(found));
        return;
    }
    found.one_of_several = before->of_step == found.of_step;
    if (found.of_step || !before->of_step) {
        *before = std::move(found);
    }
}

/// Solutions of which nobody knows the time.
void CgnsFile::tell_of_unsaid_times(const CgnsZone& zone, const std::vector<Choice>& choices, bool says) {
    std::vector<std::string> several;
    std::string last;
    for (const auto& choice : choices) {
        if (choice.one_of_several) {
            several.push_back(choice.variable);
            last = choice.solution_name;
        }
    }
    if (!several.empty()) {
        const std::string what = "zone '" + zone.name + "' holds " + listed(several) +
                                 " in several solutions and does not say of which times they are";
        if (time_asked_) {
            refuse_time(what + " (FlowSolutionPointers)");
        }
        warn(what + ": the last is read, '" + last + "'");
    } else if (time_asked_ && steps_ > 1 && !says && !zones_by_step_ && !choices.empty()) {
        warn("zone '" + zone.name + "' does not say of which time its solution '" + choices.front().solution_name +
             "' is: it is taken as it stands");
    }
}

std::vector<CgnsFile::Choice> CgnsFile::choices(const CgnsZone& zone, const ReadOptions& options, int& left) {
    std::vector<Choice> result;
    int count = 0;
    if (cg_nsols(file_, base_, zone.index, &count) != CG_OK) {
        return result;
    }
    const auto by_step =
        pointers(zone, {"FlowSolutionPointers", "FlowSolutionVertexPointers", "FlowSolutionCellPointers"});
    const auto is_at = [](const std::vector<std::string>& names, const char* name) {
        return std::find(names.begin(), names.end(), name) != names.end();
    };
    for (int s = 1; s <= count; ++s) {
        std::array<char, 33> solution{};
        CGNS_ENUMT(GridLocation_t) location{};
        int fields = 0;
        if (cg_sol_info(file_, base_, zone.index, s, solution.data(), &location) != CG_OK ||
            cg_nfields(file_, base_, zone.index, s, &fields) != CG_OK) {
            continue;
        }
        CGNS_ENUMT(PointSetType_t) points{};
        cgsize_t named = 0;
        const bool of_some = cg_sol_ptset_info(file_, base_, zone.index, s, &points, &named) == CG_OK &&
                             points != CGNS_ENUMV(PointSetTypeNull);
        if (of_some || (location != CGNS_ENUMV(Vertex) && location != CGNS_ENUMV(CellCenter))) {
            warn("zone '" + zone.name + "': solution '" + solution.data() + "' is not read: it " +
                 (of_some ? "holds values of some of the zone's parts alone"
                          : "lies at " + std::string(GridLocationName[location])));
            continue;
        }
        const bool of_step = !by_step.empty() && is_at(by_step[step_], solution.data());
        if (!of_step && std::any_of(by_step.begin(), by_step.end(),
                                    [&](const auto& names) { return is_at(names, solution.data()); })) {
            ++left;
            continue;
        }
        for (int f = 1; f <= fields; ++f) {
            std::array<char, 33> name{};
            CGNS_ENUMT(DataType_t) type{};
            ok(zone, cg_field_info(file_, base_, zone.index, s, f, &type, name.data()), "field");
            const std::string canonical = canonical_name(name.data()).name;
            const auto component = vector_component(canonical);
            if (matches_any(options.arrays, name.data()) || matches_any(options.arrays, canonical) ||
                (component && matches_any(options.arrays, component->vector))) {
                choose(result, {s, f, name.data(), solution.data(), location == CGNS_ENUMV(Vertex), of_step});
            }
        }
    }
    tell_of_unsaid_times(zone, result, !by_step.empty());
    return result;
}

std::vector<PartValues> CgnsFile::solutions(const CgnsZone& zone, const ReadOptions& options, core::Progress& progress,
                                            int& left) {
    std::vector<PartValues> result;
    for (const Choice& choice : choices(zone, options, left)) {
        progress.check();
        const std::array<cgsize_t, 3> low = {1, 1, 1};
        std::array<cgsize_t, 3> high = {1, 1, 1};
        double size = 1;
        for (std::size_t k = 0; k < 3; ++k) {
            high[k] = static_cast<cgsize_t>(choice.nodal ? zone.nodes[k] : zone.cells[k]);
            size *= static_cast<double>(high[k]);
        }
        check_room(zone, size);
        PartValues values{choice.variable, choice.nodal, 1, Buffer<double>(static_cast<std::size_t>(size))};
        ok(zone,
           cg_field_read(file_, base_, zone.index, choice.solution, choice.variable.c_str(), CGNS_ENUMV(RealDouble),
                         low.data(), high.data(), values.values.data()),
           "field");
        const std::string unit = canonical_name(choice.variable).unit;
        const Path array = {{"Zone_t", zone.index}, {"FlowSolution_t", choice.solution}, {"DataArray_t", choice.field}};
        // What the caller states of a variable replaces what the file says of it.
        const core::Conversion convert =
            is_unit_stated(options, choice.variable) ? core::Conversion{} : to_si(array, choice.variable, unit);
        if (!convert.is_identity()) {
            converted_[choice.variable] = core::format_number(convert(1)) + " " + unit;
            std::for_each(values.values.begin(), values.values.end(), [&](double& value) { value = convert(value); });
        }
        result.push_back(std::move(values));
    }
    return result;
}

}  // namespace underbody::postproc
